"""The rock from the slope in the place of the falling rock: it hits the sand cushion of the laboratory on a rigid floor."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import rockshed
from rockshed.core.run import simulate
from rockshed.core.system.reading import system_from
from rockshed.fmus.build import build_if_needed

EXAMPLE = Path(rockshed.__file__).parent / "examples" / "rigid_floor.toml"
SLOPE = {
    "receiver.present": True,
    "receiver.left": -0.15,
    "receiver.right": 0.15,
    "receiver.bottom": -0.5,
    "receiver.top": 0.16,
    "position0.x": 0.0,
    "velocity0.x": 0.0,
    "profile.x": -2.0,
    "profile.y": -0.6,
    "end.x[1]": 2.0,
    "end.y[1]": -0.6,
}
"""The slope is a floor under the cushion; the receiver begins a little above the sand."""


def run(folder, model, end, sizes=None, **parameters):
    """A run of the example with this rock."""
    data = tomllib.loads(EXAMPLE.read_text(encoding="utf-8"))
    data["stop_time"], data["state_interval"] = end, end
    data["components"]["sand"]["fmu"] = str(build_if_needed("SandCushion"))
    data["components"]["rock"]["fmu"] = str(build_if_needed(model, sizes))
    data["components"]["rock"]["parameters"] |= parameters
    return simulate(system_from(data, "example"), folder)


def test_handed_over_from_the_start_it_is_the_falling_rock(tmp_path):
    """But for the error of the falling rock's integration before it touches the sand."""
    from_slope = run(tmp_path / "slope", "SlopeRockfall", 0.01, {"cells": 1}, **SLOPE)
    falling = run(tmp_path / "falling", "FallingRock", 0.01)
    touched = falling.series["sand.rock.force.y"] > 0.0
    assert touched.sum() > 50
    for name in (
        "rock.position.x",
        "rock.velocity.y",
        "rock.angular_velocity",
        "sand.rock.force.y",
        "sand.transmitted_force",
    ):
        largest = np.abs(falling.series[name]).max()
        np.testing.assert_allclose(
            from_slope.series[name], falling.series[name], rtol=0.0, atol=1e-4 * largest
        )


def test_out_of_its_flight_it_hits_the_sand_as_the_falling_rock_does(tmp_path):
    """From 0.3 m, of which the last part lies in the receiver; the bond between rock and sand keeps its energy."""
    start = {"position0.y": 0.3, "velocity0.y": -7.0}
    from_slope = run(tmp_path / "slope", "SlopeRockfall", 0.04, {"cells": 1}, **SLOPE | start)
    falling = run(tmp_path / "falling", "FallingRock", 0.04, **start)
    assert from_slope.series["rock.handovers"][-1] == 1.0
    entered = (0.3 - 0.16) / 7.0
    assert from_slope.series["rock.handover.time"][-1] == pytest.approx(entered, rel=0.02)
    for name in ("sand.transmitted_force", "sand.rock.force.y", "sand.penetration"):
        peak = falling.series[name].max()
        assert peak > 0.0
        assert from_slope.series[name].max() == pytest.approx(peak, rel=0.02)
    assert abs(from_slope.metrics["coupling_sand_rock_energy"].value) < 0.005 * 0.5 * 4.0 * 7.0**2

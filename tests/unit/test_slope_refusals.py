"""What the rock on its slope refuses, with the cell and everything else that is wrong."""

import math

import pytest

from rockshed.components.common.component import ComponentError
from tests.slope_rocks import SLOPE, slope

LEVEL = [(0, 0), (10, 0), (20, 0), (30, 0)]


def problems(points=LEVEL, **values):
    rock = slope(points, start=False, position0__x=5.0, position0__y=5.0)
    for name, value in values.items():
        name = name.replace("__", ".")
        if isinstance(value, tuple):
            rock[f"{name}[{value[0]}]"] = value[1]
        else:
            rock[name] = value
    with pytest.raises(ComponentError) as error:
        rock.initialise()
    return error.value.problems


@pytest.mark.parametrize(
    ("points", "cell", "reason"),
    [
        ([(0, 0), (10, 0), (8, -5), (30, -6)], 2, "folding back"),
        ([(0, 0), (10, 0), (10, -5), (30, -6)], 2, "right node must lie to the right"),
        ([(0, 0), (10, 0), (10, 0), (30, -6)], 2, "remove repeated ones"),
        ([(0, 0), (10, 0), (10.001, -5), (30, -6)], 2, "steeper than 89.9 degrees"),
    ],
)
def test_profiles_that_fold_back_or_are_vertical(points, cell, reason):
    (text,) = problems(points)
    assert text.startswith(f"cell {cell} (end.x[{cell}] = {points[cell][0]:g} m): ")
    assert reason in text


def test_every_bad_cell_is_named_with_its_reason():
    found = problems(
        [(0, 0), (10, 0), (8, -5), (30, -6)],
        friction=(3, 3.0),
        roughness=(3, 0.5),
        roughness__distribution="lognormal",
    )
    assert [text.split(":")[0].split(" (")[0] for text in found] == [
        "cell 1",
        "cell 2",
        "cell 2",
        "cell 3",
    ]
    assert "mu tan(phi) = 1.73205" in found[-1]
    assert "reduce friction, roughness or its deviation" in found[-1]


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"hardening": (2, 1.2)}, "hardening[2] = 1.2: allowed is 0 to 1"),
        ({"hardening": (2, -0.1)}, "hardening[2] = -0.1: allowed is 0 to 1"),
        ({"strength": (1, math.nan)}, "strength[1] = nan: must be a finite number"),
        ({"end__x": (3, math.inf)}, "end.x[3] = inf: must be a finite number"),
        ({"position0__y": math.nan}, "position0.y = nan: must be a finite number"),
        ({"radius": 0.0}, "radius = 0 m"),
        ({"friction": (3, -0.1)}, "friction[3] = -0.1"),
        ({"roughness_deviation": (1, 1.1)}, "roughness[1] = 0, largest 2.156"),
        ({"trial": 0.5}, "trial = 0.5: must be a whole number"),
        (
            {"limit_speed__distribution": "lognormal", "limit_speed__mean": 0.0},
            "limit_speed.mean = 0 m/s",
        ),
        ({"tilt__distribution": "lognormal"}, "only a positive tilt has a lognormal distribution"),
        ({"receiver__present": 1.0}, "the receiver is empty"),
        (
            {"position0__y": 0.3},
            "starts below the surface: its lowest point is at -0.2 m along the normal of cell 1",
        ),
    ],
)
def test_values(values, reason):
    assert any(reason in text for text in problems(**values))


def test_values_out_of_range_are_all_named():
    assert len(problems(hardening=(2, 1.2), strength=(1, math.nan), radius=-1.0)) == 3


def test_a_slope_has_at_least_one_cell():
    with pytest.raises(ComponentError, match="cells = 0: allowed is 1 to"):
        SLOPE.instance(cells=0)


def test_any_number_of_cells_starts_with_the_example_slope():
    for cells in (1, 7, 40):
        rock = SLOPE.instance(cells=cells)
        rock.initialise()
        assert rock["end.x"][-1] == 140.0


def test_the_kernel_itself_names_the_first_bad_cell():
    """As an FMU without Python has to."""
    rock = slope([(0, 0), (10, 0), (8, -5), (30, -6)], start=False)
    status = SLOPE.initialise(rock.w, rock.x, rock.k)
    assert rock.message(status) == problems([(0, 0), (10, 0), (8, -5), (30, -6)])[0]


def test_a_rock_may_start_in_contact():
    rock = slope(
        LEVEL,
        position0__x=5.0,
        position0__y=0.5,
        velocity0__x=1.0,
        angular_velocity0=-2.0,
        friction=0.5,
    )
    assert rock["height"] == 0.0
    assert rock["mode"] == 2.0

"""Steps of 1/60 s, 1/3 s and 44.1 kHz together: exact counts and times, from TOML, Python and SSP."""

from fractions import Fraction

import pytest

from rockshed.core.errors import InputRefused
from rockshed.core.system.planning import make_plan
from rockshed.core.system.reading import system_from
from rockshed.runs.job import Job
from rockshed.runs.simulation import simulate
from rockshed.runs.system import System
from tests.cosim.mocks import Mock, inp, out


def clock():
    """Counts its steps and shows the time that they have reached."""

    def step(v, t, h):
        v["count"] += 1.0
        v["reached"] = t + h

    return Mock([inp("unused"), out("count"), out("reached", "s")], step)


def made(exchange, sound, frame, stop):
    mocks = {"sound": clock(), "frame": clock()}
    data = {
        "name": "clocks",
        "exchange_step": exchange,
        "stop_time": stop,
        "output_interval": stop,
        "components": {
            "sound": {"fmu": "mock", "step": sound},
            "frame": {"fmu": "mock", "step": frame},
        },
    }
    return system_from(data), mocks


@pytest.mark.parametrize(
    ("exchange", "sound", "frame", "stop"),
    [
        ("1/60", "1/44100", "1/3", 1.0),
        ("1/3", "1/44100", "1/60", 2.0),
        (Fraction(1, 60), Fraction(1, 44100), Fraction(1, 60), Fraction(1, 3)),
        ("1/44100", "1/44100", "1/60", "1/3"),
    ],
)
def test_steps_of_two_clocks_are_counted_exactly(exchange, sound, frame, stop):
    spec, mocks = made(exchange, sound, frame, stop)
    found = simulate(System(Job("clocks", spec, mocks, {})))
    length = Fraction(stop)
    assert found.time[-1] == float(length)
    for name, step in (("sound", sound), ("frame", frame)):
        assert found.series[f"{name}.count"][-1] == length / Fraction(step)
        assert found.series[f"{name}.reached"][-1] == pytest.approx(float(length), rel=1e-15)
    assert found.metrics["exchanges"].value == length / Fraction(exchange)


def test_the_times_of_each_step_are_those_of_its_fraction():
    spec, mocks = made("1/60", "1/44100", "1/3", 1.0)
    simulate(System(Job("clocks", spec, mocks, {})))
    times = [call[2] for call in mocks["sound"].calls if call[0] == "step"]
    assert times == [n / 44100 for n in range(44100)]
    lengths = {call[3] for call in mocks["sound"].calls if call[0] == "step"}
    assert lengths == {1 / 44100}


def test_a_step_that_fits_neither_is_refused_with_the_nearest_fractions():
    spec, mocks = made("1/60", "1/44100", "1/7", 1.0)
    with pytest.raises(InputRefused, match="neither divides the exchange step"):
        make_plan(spec, mocks)

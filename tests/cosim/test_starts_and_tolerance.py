"""Start values of outputs and local variables, and the tolerance of solvers: told to an FMU as FMI has them."""

from dataclasses import dataclass

import pytest

from rockshed.core.errors import InputRefused
from rockshed.core.run import simulate
from rockshed.core.system.planning import make_plan
from tests.cosim.mocks import Mock, MockSlave, out, par, wired


@dataclass
class Ball(Mock):
    """An FMU whose output ``h`` begins with a start value; another output is computed."""

    initial: str = "exact"
    proposal: str = ""

    def model_description(self):
        text = super().model_description().decode()
        plain = "causality='output' variability='continuous'><Real "
        text = text.replace(
            plain, plain.replace(">", f" initial='{self.initial}'>") + "start='1'", 1
        )
        experiment = f"<DefaultExperiment {self.proposal}/>" if self.proposal else ""
        return text.replace("<ModelVariables>", experiment + "<ModelVariables>").encode()

    def instantiate(self, name):
        return BallSlave(self, name)


class BallSlave(MockSlave):
    def setup_experiment(self, start, stop, tolerance=None):
        self.mock.calls.append(("tolerance", tolerance))
        return 0


def ball(**options):
    return Ball([out("h", "m"), out("v", "m/s"), par("g", 9.81)], **options)


def system_of(source, parameters=None, tolerance=None, **settings):
    system, sources = wired({"ball": source}, [], **settings)
    spec = system.components["ball"].model_copy(
        update={"parameters": parameters or {}, "tolerance": tolerance}
    )
    return system.model_copy(update={"components": {"ball": spec}}), sources


@pytest.mark.parametrize("initial", ["exact", "approx"])
def test_an_output_that_begins_with_a_start_value_can_be_set(tmp_path, initial):
    system, sources = system_of(ball(initial=initial), {"h": 3.5})
    run = simulate(system, tmp_path / "run", sources=sources)
    assert run.series["ball.h"][0] == 3.5


@pytest.mark.parametrize(("name", "initial"), [("v", "exact"), ("h", "calculated")])
def test_an_output_that_is_computed_cannot_be_set(name, initial):
    system, sources = system_of(ball(initial=initial), {name: 1.0})
    with pytest.raises(InputRefused, match=f"ball.{name}: is of the causality output"):
        make_plan(system, sources)


@pytest.mark.parametrize(
    ("proposal", "whole", "own", "told"),
    [
        ("tolerance='1e-5'", None, None, 1e-5),
        ("tolerance='1e-5'", 1e-7, None, 1e-7),
        ("tolerance='1e-5'", 1e-7, 1e-8, 1e-8),
        ("startTime='0'", None, None, None),
        ("", None, None, None),
    ],
)
def test_the_tolerance_is_the_components_or_the_systems_or_the_fmus(
    tmp_path, proposal, whole, own, told
):
    source = ball(proposal=proposal)
    system, sources = system_of(source, tolerance=own)
    system = system.model_copy(update={"tolerance": whole})
    simulate(system, tmp_path / "run", sources=sources)
    assert ("tolerance", told) in source.calls


def test_a_value_that_does_not_fit_is_refused_without_empty_brackets():
    system, sources = system_of(ball(), {"g": "much"})
    with pytest.raises(InputRefused) as refusal:
        make_plan(system, sources)
    assert "set ball.g to another value" in str(refusal.value)

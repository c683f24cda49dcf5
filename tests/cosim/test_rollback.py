"""Going back to an earlier state: proved for each FMU, and refused by name where it is not so."""

import itertools
import re
from dataclasses import dataclass

import pytest

from rockshed.core.errors import InputRefused
from rockshed.core.fmu.fmu_slave import FmuFile
from rockshed.core.loop.buses import Buses
from rockshed.core.loop.exchange import ExchangeLoop
from rockshed.core.loop.initialisation import free, initialise, instantiate
from rockshed.core.masters.rollback import Rollback, prove_rollback
from rockshed.core.system.planning import make_plan
from rockshed.core.system.reading import system_from
from rockshed.core.system.rollback import rollback_problems
from rockshed.fmus.build import build
from rockshed.fmus.parts import Fmi, Runtime
from tests.cosim.fmi3_fmus import library, pack
from tests.cosim.mocks import Mock, MockSlave, inp, mass, out, spring, wired

PAIR = ["a.position -> b.end1.position", "b.end1.force -> a.force"]


def proved(system, sources):
    """Prove all components; return the slaves, and the values shown before and after."""
    plan = make_plan(system, sources)
    slaves = instantiate(plan, sources)
    buses = Buses(plan)
    initialise(slaves, buses)
    before = buses.outputs.tobytes(), buses.inputs.tobytes()
    states = [slave.state() for slave in slaves.values()]
    try:
        prove_rollback(buses, slaves, ExchangeLoop(buses, slaves), "this test")
        for slave in slaves.values():
            buses.take(slave)
        assert (buses.outputs.tobytes(), buses.inputs.tobytes()) == before
        assert [slave.state() for slave in slaves.values()] == states
        return plan, slaves, buses
    except BaseException:
        free(slaves.values())
        raise


def refusal(broken, connections=PAIR):
    """Return why a pair with a broken mass is refused."""
    with pytest.raises(InputRefused) as refused:
        proved(*wired({"a": broken, "b": spring(1.0)}, connections))
    (problem,) = refused.value.problems
    assert problem.where == "a"
    return problem.what


@dataclass
class Broken(Mock):
    """A mass of which something is not as it was after going back."""

    how: str = ""

    def instantiate(self, name):
        slave = _BrokenSlave(self, name)
        slave.how = self.how
        slave.counter = itertools.count(1)
        return slave


class _BrokenSlave(MockSlave):
    def state(self):
        return b"" if self.how == "silent state" else super().state()

    def step(self, time, step):
        status = super().step(time, step)
        if self.how in ("hidden counter", "silent state"):
            self.values["position"] += 1e-12 * next(self.counter)
        return status

    def mark(self):
        if self.how == "fails":
            raise RuntimeError("a: the state cannot be kept: no memory")
        self.marked = dict(self.values)

    def roll_back(self):
        forgotten = {"inputs": ["force"], "outputs": ["position"]}.get(self.how, [])
        self.values = {
            **self.marked,
            **{name: self.values[name] for name in forgotten},
        }


def broken(how):
    made = mass(2.0, position=1.0)
    return Broken(made.ports, made.step, made.start, how=how)


def test_a_whole_mass_is_proved_and_left_as_it_was():
    proved(*wired({"a": broken(""), "b": spring(1.0)}, PAIR))


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ("hidden counter", "a.position is 0.99.* after the same step again, and was 0.99"),
        ("silent state", "a.position is 0.99.* after the same step again, and was 0.99"),
        ("inputs", "after a step with other inputs was taken back"),
        ("outputs", "a.position is .* after the same step again"),
        ("fails", "no memory"),
    ],
)
def test_what_is_forgotten_is_found_and_told(how, said):
    assert re.search(said, refusal(broken(how)))


def test_a_slave_without_the_calls_is_refused_by_name():
    class Without(Mock):
        def instantiate(self, name):
            class Slave(MockSlave):
                @property
                def mark(self):
                    raise AttributeError

            return Slave(self, name)

    made = mass(2.0)
    assert "cannot go back" in refusal(Without(made.ports, made.step, made.start))


def test_an_fmu_that_says_it_cannot_is_named_before_anything_is_made():
    made = Mock([inp("u"), out("y")], serializes=False)
    plan = make_plan(*wired({"a": made, "b": mass()}, []))
    (problem,) = rollback_problems(plan.descriptions, "the implicit master")
    assert problem.where == "a"
    assert "canGetAndSetFMUstate" in problem.what


def test_what_a_slave_says_in_the_trial_is_not_kept():
    def step(v, _t, _h):
        return 1, "a warning in each step"

    made = Mock([inp("u"), out("y")], step)
    _, slaves, _ = proved(*wired({"a": made, "b": made}, ["a.y -> b.u"]))
    assert all(not slave.messages for slave in slaves.values())


@pytest.mark.parametrize(
    ("runtime", "version"),
    [(Runtime.NATIVE, Fmi.TWO), (Runtime.NATIVE, Fmi.THREE), (Runtime.PYTHON, Fmi.TWO)],
)
def test_own_fmus_of_both_runtimes_come_back_to_the_bit(tmp_path, runtime, version):
    fmu = build("FallingRock", destination=tmp_path, runtime=runtime, fmi=version)
    data = {
        "name": "rock",
        "components": {"rock": {"fmu": str(fmu)}},
        "stop_time": 0.1,
        "exchange_step": 0.01,
        "watch": ["rock.position.*"],
    }
    _, slaves, buses = proved(system_from(data), {"rock": FmuFile(fmu)})
    rollback = Rollback(slaves)
    rollback.mark()
    for _ in range(3):
        slaves["rock"].step(0.0, 0.01)
        buses.take(slaves["rock"])
        rollback.roll_back()
    buses.take(slaves["rock"])
    free(slaves.values())


def test_an_fmu_of_fmi_3_with_events_comes_back_to_the_bit(tmp_path):
    fmu = pack(library(tmp_path), tmp_path / "Thing.fmu")
    data = {
        "name": "things",
        "components": {n: {"fmu": str(fmu), "parameters": {"period": 0.003}} for n in "ab"},
        "connections": ["a.y -> b.u"],
        "stop_time": 0.1,
        "exchange_step": 0.01,
    }
    _, slaves, _ = proved(system_from(data), {n: FmuFile(fmu) for n in "ab"})
    free(slaves.values())

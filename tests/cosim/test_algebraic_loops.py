"""Algebraic loops from declared dependencies: found, told, and what masters make of them."""

from dataclasses import dataclass

import numpy as np
import pytest

from rockshed.core.run import simulate
from rockshed.core.system.planning import make_plan
from tests.cosim.mocks import Mock, inp, out, wired

LINKS = ["a.y -> b.u", "b.y -> a.u"]


@dataclass
class Declared(Mock):
    """A mock that declares what its output y depends on, in the run and at the start."""

    depends: str = ""
    at_start: str = ""

    def model_description(self):
        text = super().model_description().decode()
        outputs, _, initial = text.partition("<InitialUnknowns>")
        plain = "<Unknown index='2'/>"
        outputs = outputs.replace(plain, f"<Unknown index='2' dependencies='{self.depends}'/>")
        initial = initial.replace(plain, f"<Unknown index='2' dependencies='{self.at_start}'/>")
        return f"{outputs}<InitialUnknowns>{initial}".encode()


def gain(factor, depends="1", at_start="1", constant=1.0):
    def step(v, _t=0.0, _h=0.0):
        v["y"] = factor * v["u"] + constant

    return Declared([inp("u"), out("y")], step, step, depends=depends, at_start=at_start)


def test_a_loop_of_declared_dependencies_is_a_chain_of_ports():
    plan = make_plan(*wired({"a": gain(0.5), "b": gain(0.5)}, LINKS))
    (chain,) = plan.loops
    ports = chain.split(" -> ")
    assert ports[0] == ports[-1]
    assert set(ports) == {"a.u", "a.y", "b.u", "b.y"}
    assert plan.loops_at_start
    (warning,) = plan.warnings
    assert "delay of an exchange" in warning
    assert 'master = "implicit"' in warning


def test_a_state_breaks_a_loop_and_so_does_a_description_that_tells_nothing():
    state = make_plan(*wired({"a": gain(0.5), "b": gain(0.5, depends="")}, LINKS))
    assert state.loops == ()
    assert state.loops_at_start
    silent = Mock([inp("u"), out("y")])
    assert make_plan(*wired({"a": gain(0.5), "b": silent}, LINKS)).loops == ()


def test_the_implicit_master_finds_the_values_of_a_loop_and_does_not_warn(tmp_path):
    """y_a = -3 y_b + 1 and y_b = y_a: passed on again and again, it would grow."""
    mocks = {"a": gain(-3.0), "b": gain(1.0, constant=0.0)}
    spec, sources = wired(mocks, LINKS, master="implicit")
    result = simulate(spec, tmp_path / "run", sources=sources)
    assert result.series["a.y"][1:] == pytest.approx(np.full(10, 0.25), rel=1e-5)
    (warning,) = result.provenance["warnings"]
    assert "the loop at the start does not converge: " in warning


def test_several_loops_are_each_told_once():
    mocks = {name: gain(0.1) for name in "abcd"}
    links = [*LINKS, "c.y -> d.u", "d.y -> c.u"]
    plan = make_plan(*wired(mocks, links))
    assert len(plan.loops) == 2


def test_a_long_chain_without_a_loop_has_none():
    mocks = {f"m{i}": gain(0.5) for i in range(200)}
    links = [f"m{i}.y -> m{i + 1}.u" for i in range(199)]
    assert make_plan(*wired(mocks, links)).loops == ()

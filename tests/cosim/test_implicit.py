"""The implicit master: exchanges that are repeated until their values fit together."""

import json
import math

import numpy as np
import pytest

from rockshed.core import continuing
from rockshed.core.continuing import find_stopped
from rockshed.core.errors import InputRefused, RunFailed
from rockshed.core.loop.changes import plan_change
from rockshed.core.results.changes import ValueChange
from rockshed.core.run import simulate, starting_problems
from rockshed.core.system.iteration import Iteration
from rockshed.core.system.planning import make_plan
from rockshed.ssp.documents import as_bytes
from rockshed.ssp.package import MAIN, Package
from rockshed.ssp.reading import read_structure
from rockshed.ssp.writing import description
from tests.cosim.mocks import Mock, inp, mass, out, par, wired

METHODS = ("fixed_point", "anderson", "quasi_newton")
MASSES = (1.0, 3.0)
"""kg; they meet with 4/3 m/s, and their centre of gravity rests."""
RELATIVE = 4.0 / 3.0
REDUCED = 0.75
LINKS = [
    *(f"{s}.{q} -> contact.{s}.{q}" for s in "ab" for q in ("position", "velocity")),
    *(f"contact.{s}.force -> {s}.force" for s in "ab"),
]
MIDDLE = [{"target": "contact.*", "input": "middle"}]
BONDS = {
    f"on_{s}": {"giver": "contact", "force": [f"{s}.force"], "taker": s, "position": ["position"]}
    for s in "ab"
}


def contact(stiffness, damping):
    """A spring and a dashpot between two bodies; the forces are those of the inputs."""

    def step(v, _t=0.0, _h=0.0):
        stretch = v["a.position"] - v["b.position"]
        v["b.force"] = stiffness * stretch + damping * (v["a.velocity"] - v["b.velocity"])
        v["a.force"] = -v["b.force"]

    ports = [par("stiffness", stiffness, "N/m")]
    for side in "ab":
        ports += [inp(f"{side}.position", "m"), inp(f"{side}.velocity", "m/s")]
        ports.append(out(f"{side}.force", "N"))
    return Mock(ports, step, step)


def pair(stiffness=400.0, damping=1.0, step=0.01, stop=0.5, iteration=None, **options):
    """Two masses that meet, and the contact between them."""
    mocks = {
        "a": mass(MASSES[0], 0.0, 1.0),
        "b": mass(MASSES[1], 0.0, -1.0 / 3.0),
        "contact": contact(stiffness, damping),
    }
    table = {"tolerance": 1e-8, "connections": MIDDLE, **(iteration or {})}
    times = {"exchange_step": step, "stop_time": stop, "master": "implicit", "iteration": table}
    return wired(mocks, LINKS, **{**times, **options})


def position(time, stiffness, damping):
    """Way (m) of the lighter mass, in closed form."""
    decay = 0.5 * damping / REDUCED
    omega = math.sqrt(stiffness / REDUCED - decay**2)
    relative = RELATIVE / omega * np.exp(-decay * time) * np.sin(omega * time)
    return relative * MASSES[1] / sum(MASSES)


def run(folder, system, **more):
    spec, sources = system
    return simulate(spec, folder, sources=sources, **more)


def metrics_of(folder):
    return {m["name"]: m["value"] for m in json.loads((folder / "summary.json").read_text())}


def iterations(result):
    return {int(n): count for n, count in result.provenance["iteration"]["iterations"].items()}


# ---------------------------------------------------------------------- stiff contacts


def error_at(folder, step, moment, stiffness=400.0, damping=1.0):
    table = {"connections": [{"target": "contact.*", "input": moment}]}
    result = run(folder / "run", pair(stiffness, damping, step, iteration=table))
    return np.abs(result.series["a.position"] - position(result.time, stiffness, damping)).max()


@pytest.mark.parametrize(("moment", "order", "within"), [("middle", 2.0, 0.1), ("end", 1.0, 0.25)])
def test_the_order_is_two_with_values_of_the_middle_and_one_with_those_of_the_end(
    tmp_path, moment, order, within
):
    errors = [error_at(tmp_path, step, moment) for step in (5e-3, 2.5e-3)]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=within)


LIMIT = 0.08
STIFFNESS = 4.0 * REDUCED / LIMIT**2
"""Longest exchange step (s) at which an explicit master is stable with a contact so stiff (N/m)."""


def test_an_explicit_master_diverges_beyond_its_limit(tmp_path):
    result = run(tmp_path / "run", pair(1.1 * STIFFNESS, 0.0, LIMIT, 4.0, master="sequential"))
    assert np.abs(result.series["a.velocity"]).max() > 1e6


@pytest.mark.parametrize("method", METHODS)
def test_a_contact_twenty_times_beyond_the_explicit_limit_converges(tmp_path, method):
    """The limit falls with the root of the stiffness; amplitudes are those of the closed form."""
    stiffness = STIFFNESS * 20.0**2
    system = pair(stiffness, 0.0, LIMIT, 3.2, {"method": method})
    result = run(tmp_path / "run", system)
    assert max(iterations(result)) <= 5
    omega = math.sqrt(stiffness / REDUCED)
    amplitude = RELATIVE * MASSES[1] / sum(MASSES)
    speeds = result.series["a.velocity"]
    assert np.abs(speeds).max() == pytest.approx(amplitude, rel=1e-6)
    # the trapezoidal rule turns by another angle in each step, and changes no amplitude
    angle = 2.0 * math.atan(0.5 * omega * LIMIT) * np.arange(speeds.size)
    assert speeds == pytest.approx(amplitude * np.cos(angle), abs=1e-5)


def test_values_of_the_middle_make_no_energy(tmp_path):
    result = run(tmp_path / "run", pair(4e4, 0.0, 0.01, 0.5, bonds=BONDS))
    kinetic = sum(
        0.5 * m * result.series[f"{s}.velocity"] ** 2 for m, s in zip(MASSES, "ab", strict=True)
    )
    stretch = result.series["a.position"] - result.series["b.position"]
    total = kinetic + 0.5 * 4e4 * stretch**2
    assert total == pytest.approx(total[0], rel=1e-7)
    assert result.provenance["warnings"] == []


# ---------------------------------------------------------------------- steps


@pytest.mark.parametrize("steps", [{"a": 2.5e-3}, {"a": 0.02}, {"a": 0.02, "b": 0.005}])
def test_components_with_several_rates_converge_to_the_closed_form(tmp_path, steps):
    """Those that divide the exchange, and those that make a step over several exchanges."""
    errors = []
    for part in (1.0, 0.5):
        components = {name: {"step": step * part} for name, step in steps.items()}
        system = pair(step=0.01 * part, components=components)
        result = run(tmp_path / "run", system)
        exact = position(result.time, 400.0, 1.0)
        errors.append(
            np.abs(result.series["contact.b.force"]).max()
            and np.abs((result.series["a.position"] - exact)[:: round(2 / part)]).max()
        )
    assert errors[0] < 2e-2
    assert math.log2(errors[0] / errors[1]) > 0.8


def test_a_window_of_several_exchanges_is_posted_exchange_by_exchange(tmp_path):
    """Rows, ledger and watched values are those of a component that shows something at each."""
    components = {"a": {"step": 0.02}}
    result = run(tmp_path / "run", pair(components=components, bonds=BONDS, watch=["b.position"]))
    assert result.time.size == 51
    assert len(set(result.series["b.position"])) == 51
    assert np.all(result.series["a.position"][1::2] == result.series["a.position"][:-1:2])
    assert metrics_of(tmp_path / "run")["b.position maximum"] == pytest.approx(
        result.series["b.position"].max(), abs=0.0
    )
    assert result.provenance["iteration"]["window"] == 2


def test_a_chain_without_a_loop_takes_one_iteration_and_has_the_bits_of_sequential(tmp_path):
    ramp = Mock([out("y")], lambda v, t, h: v.__setitem__("y", math.sin(t + h)))
    gain = Mock([inp("u"), out("y")], lambda v, t, h: v.__setitem__("y", 3.0 * v["u"] + h))
    for master in ("sequential", "implicit"):
        system = wired({"a": ramp, "b": gain}, ["a.y -> b.u"], master=master)
        result = run(tmp_path / master, system)
    assert iterations(result) == {1: 10}
    other = "timeseries.parquet"
    both = [read(tmp_path / master / other) for master in ("sequential", "implicit")]
    assert np.array_equal(both[0]["b.y"], both[1]["b.y"])


def read(path):
    import pyarrow.parquet as parquet

    return parquet.read_table(path).to_pandas()


# ---------------------------------------------------------------------- linear loops


def linear(matrix, constant):
    """A component whose outputs are linear in its inputs."""
    size = len(constant)

    def step(v, _t, _h):
        given_ = np.array([v[f"u{i}"] for i in range(size)])
        for i, value in enumerate(matrix @ given_ + constant):
            v[f"y{i}"] = float(value)

    return Mock([*(inp(f"u{i}") for i in range(size)), *(out(f"y{i}") for i in range(size))], step)


def loop(matrix, constant, **iteration):
    """A loop of two linear components, of which the second passes on what it gets."""
    size = len(constant)
    mocks = {"a": linear(matrix, constant), "b": linear(np.eye(size), np.zeros(size))}
    links = [f"{x}.y{i} -> {y}.u{i}" for x, y in ("ab", "ba") for i in range(size)]
    times = {"stop_time": 0.1, "exchange_step": 0.1, "master": "implicit"}
    return wired(mocks, links, iteration=iteration, **times)


@pytest.mark.parametrize("method", METHODS)
def test_the_values_of_a_loop_are_the_monolithic_solution(tmp_path, method):
    """With a loop that neither expands nor contracts much, which all methods can solve."""
    matrix = np.array([[0.3, -0.8], [0.5, 0.2]])
    constant = np.array([1.0, -2.0])
    system = loop(matrix, constant, method=method, tolerance=1e-8, most=200)
    result = run(tmp_path / "run", system)
    found = [result.series[f"a.y{i}"][-1] for i in range(2)]
    assert found == pytest.approx(np.linalg.solve(np.eye(2) - matrix, constant), rel=1e-6)


# ---------------------------------------------------------------------- what is told


def test_iterations_are_a_column_a_distribution_and_a_history(tmp_path):
    result = run(tmp_path / "run", pair(output_interval=0.05))
    column = result.series["coupling.iterations"]
    assert column[0] == 0.0
    counts = iterations(result)
    assert sum(counts.values()) == 50
    assert column.max() == max(counts)
    found = metrics_of(tmp_path / "run")
    mean = sum(n * count for n, count in counts.items()) / 50
    assert found["iterations of an exchange, mean"] == pytest.approx(mean)
    assert found["iterations of an exchange, most"] == max(counts)
    assert found["exchanges with 2 iterations"] == counts[2]
    told = result.provenance["iteration"]
    assert {"source": "contact.a.force", "targets": ["a.force"]} in told["connections"]
    last = told["windows"][-1]
    assert last["time"] == pytest.approx(0.49)
    assert len(last["residuals"]) == last["iterations"]
    assert max(last["residuals"][-1]) <= 1.0 < max(last["residuals"][0])


def test_a_loop_that_does_not_converge_ends_the_run_with_connection_time_and_residual(tmp_path):
    system = pair(4e6, 0.0, 0.02, iteration={"most": 2})
    with pytest.raises(RunFailed) as failure:
        run(tmp_path / "run", system)
    said = str(failure.value)
    assert "does not converge: after 2 iterations" in said
    assert "contact" in said
    assert "t = 0 s" in said
    assert "times its tolerance" in said


def test_going_on_without_convergence_is_counted_in_a_warning(tmp_path):
    table = {"most": 1, "unconverged": "continue"}
    result = run(tmp_path / "run", pair(iteration=table, stop=0.1))
    (warning,) = [w for w in result.provenance["warnings"] if "iteration" in w]
    assert "has not converged 10 times within 1 iterations" in warning


def test_a_refused_guess_is_told_as_one(tmp_path):
    """The first guess is taken; what the first iteration makes of it is far too much."""

    def step(v, t, h):
        if abs(v["u"]) > 10.0:
            return 2, "u is out of range"
        v["y"] = -50.0 * v["u"] + 30.0
        return None

    limited = Mock([inp("u"), out("y")], step)
    passing = Mock([inp("u"), out("y")], lambda v, t, h: v.__setitem__("y", v["u"]))
    system = wired(
        {"a": limited, "b": passing},
        ["a.y -> b.u", "b.y -> a.u"],
        master="implicit",
        iteration={"method": "fixed_point"},
    )
    with pytest.raises(RunFailed) as failure:
        run(tmp_path / "run", system)
    assert "refused in iteration 2, with values that are a guess (Discard)" in str(failure.value)
    assert "u is out of range" in str(failure.value)


# ---------------------------------------------------------------------- refusals


def problems(system):
    with pytest.raises(InputRefused) as refused:
        make_plan(*system)
    return [str(problem) for problem in refused.value.problems]


def test_what_cannot_be_iterated_is_refused_before_anything_runs():
    made = Mock([inp("u"), out("y")], serializes=False)
    (said,) = problems(wired({"a": made}, [], master="implicit"))
    assert said.startswith("a: its FMU cannot go back")
    texts = Mock([out("name", kind="String")])
    assert any("is text" in said for said in problems(wired({"a": texts}, [], master="implicit")))
    scenario = {"set": [{"port": "contact.stiffness", "value": 1.0, "at": 0.1}]}
    slow = pair(components={"a": {"step": 0.02}}, scenario=scenario)
    assert any("steps over several exchanges" in said for said in problems(slow))


def test_a_change_within_a_window_is_refused():
    plan = make_plan(*pair(components={"a": {"step": 0.02}}))
    assert plan_change(plan, ValueChange(0.02, {})).exchange == 2
    with pytest.raises(InputRefused) as refused:
        plan_change(plan, ValueChange(0.03, {}))
    assert "lies within a window of 0.02 s" in str(refused.value)


def test_what_does_not_come_back_is_known_before_a_run():
    spec, sources = pair()
    step = sources["a"].step
    count = iter(range(100))

    def hidden(v, t, h):
        step(v, t, h)
        v["velocity"] += 1e-9 * next(count)

    sources["a"].step = hidden
    (problem,) = starting_problems(spec, sources)
    assert problem.where == "a"
    assert "does not come back to an earlier state" in problem.what


def test_an_entry_that_names_no_connection_is_refused():
    table = {"connections": [{"source": "a.positon", "tolerance": 1e-3}]}
    (said,) = problems(pair(iteration=table))
    assert "a.positon -> * is no connection" in said
    assert "did you mean a.position" in said


@pytest.mark.parametrize(
    "table", [{"connections": [{"source": "a.*"}]}, {"method": "guess"}, {"most": 0}, {"tol": 1}]
)
def test_a_table_of_a_wrong_form_is_refused(table):
    with pytest.raises(InputRefused):
        pair(iteration=table)


def test_the_tolerance_of_a_connection_is_kept(tmp_path):
    loose = run(tmp_path / "loose", pair(iteration={"tolerance": 1e-2}))
    table = {
        "tolerance": 1e-2,
        "connections": [*MIDDLE, {"source": "contact.*.force", "tolerance": 1e-12}],
    }
    tight = run(tmp_path / "tight", pair(iteration=table))
    assert sum(n * c for n, c in iterations(tight).items()) > sum(
        n * c for n, c in iterations(loose).items()
    )


# ---------------------------------------------------------------------- checkpoints


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("steps", [{}, {"a": 0.02}])
def test_a_run_that_goes_on_has_the_bits_of_an_unbroken_one(tmp_path, method, steps):
    """Also where the checkpoint lies within a window of two exchanges."""
    components = {name: {"step": step} for name, step in steps.items()}
    options = {"iteration": {"method": method}, "components": components, "bonds": BONDS}

    def breaking(until):
        system, sources = pair(**options)
        step = sources["b"].step
        sources["b"].step = lambda v, t, h: (3, "broken") if t > until else step(v, t, h)
        return system, sources

    run(tmp_path / "whole", breaking(9.0), checkpoint_every=0.05)
    with pytest.raises(RunFailed, match="broken"):
        run(tmp_path / "broken", breaking(0.33), checkpoint_every=0.05)
    continuing.resume(find_stopped(tmp_path / "broken"), breaking(9.0)[1])
    files = [(tmp_path / name / "timeseries.parquet").read_bytes() for name in ("whole", "broken")]
    assert files[0] == files[1]
    told = [
        json.loads((tmp_path / name / "run.json").read_text())["iteration"]
        for name in ("whole", "broken")
    ]
    assert told[0] == told[1]


# ---------------------------------------------------------------------- other forms


def test_an_ssp_keeps_the_choice_of_the_master(tmp_path):
    system, sources = pair(iteration={"method": "anderson", "most": 7})
    files = {name: f"{name}.fmu" for name in sources}
    content = as_bytes(description(make_plan(system, sources), files, "1.0"))
    (tmp_path / MAIN).write_bytes(content)

    def describe(file):
        return sources[file.stem].model_description()

    again = read_structure(Package(tmp_path, tmp_path), {}, describe).system
    assert again.master == "implicit"
    assert again.iteration == system.iteration


@pytest.mark.parametrize("master", ["sequential", "jacobi"])
def test_a_table_that_another_master_does_not_read_is_told(master):
    (told,) = make_plan(*pair(master=master)).warnings
    assert told.startswith(f"[iteration] does nothing with the {master} master")
    spec, sources = pair(master=master)
    assert make_plan(spec.model_copy(update={"iteration": Iteration()}), sources).warnings == ()

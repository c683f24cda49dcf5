"""FMUs in processes of their own: what their code does there is told, and harms nobody else."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path

import pytest

import rockshed
from rockshed.core.errors import ComponentLost, InputRefused, RunFailed
from rockshed.core.results.bits import first_difference
from rockshed.core.results.reading import read_run
from rockshed.core.run import simulate
from rockshed.core.system.reading import load_system, system_from
from tests.cosim.fmi3_fmus import library, pack
from tests.cosim.mocks import Mock, out
from tests.cosim.odd_fmus import SYSTEM, XML, make, program
from tests.cosim.odd_fmus import run as command

pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or not shutil.which("cc"), reason="needs Linux and a C compiler"
)

ISOLATED = SYSTEM.replace("stop_time", "time_limit = 2\nstop_time") + "isolate = true\n"
CRASH = "*(volatile int *)8 = 1"


def run(folder, **code):
    """Run the odd FMU in a process of its own; other code goes to odd_fmus.make."""
    make(folder, system=code.pop("system", ISOLATED), **code)
    return simulate(load_system(folder / "system.toml"), folder / "out")


@pytest.fixture(autouse=True)
def nothing_left(monkeypatch, tmp_path_factory):
    """See that every test ends without processes of isolated instances, and without folders."""
    place = tmp_path_factory.mktemp("temporary")
    monkeypatch.setattr(tempfile, "tempdir", str(place))
    yield
    assert workers() == []
    assert [*place.iterdir()] == []


def workers(parent=None):
    """Processes of isolated instances, of this process or another one."""
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            words = status.read_text().rpartition(")")[2].split()
            line = (status.parent / "cmdline").read_bytes()
        except OSError:
            continue
        if b"rockshed.core.isolation.worker" in line and words[1] == str(parent or os.getpid()):
            found.append(int(status.parent.name))
    return found


@pytest.mark.parametrize(
    ("step", "told"),
    [
        (CRASH, "its code crashed (SIGSEGV)"),
        ("abort()", "its code crashed (SIGABRT)"),
        ("exit(0)", "its code ended the process with exit code 0"),
        ("_exit(7)", "its code ended the process with exit code 7"),
        ("for (;;)", "its code has not returned after 2 s"),
        ("char b[90] = {0}; for (int f = 3; f < 20; f++) write(f, b, 90)", "its code answers nons"),
        ("for (int f = 3; f < 20; f++) close(f)", "its code ended the process with exit code 1"),
    ],
)
def test_code_that_does_not_return_from_a_step_is_told_with_its_time(tmp_path, step, told):
    with pytest.raises(RunFailed) as failure:
        run(tmp_path, IN_STEP=f"if (steps == 4) {{ {step}; }}")
    assert str(failure.value).startswith("m at t = 0.3 s: the step by 0.1 s failed (Fatal): ")
    assert told in str(failure.value)
    assert failure.value.time == pytest.approx(0.3)
    kept = read_run(tmp_path / "out")
    assert (kept.status, kept.provenance["error"]) == ("failed", str(failure.value))
    assert kept.series["m.x"].tolist() == pytest.approx([0.0, 0.1, 0.2, 0.3])


@pytest.mark.parametrize(
    ("start", "told"),
    [
        (CRASH, "m: its code crashed (SIGSEGV) while it was made ready, at t = 0 s"),
        ("exit(0)", "m: its code ended the process with exit code 0 while it was made ready"),
        ("for (;;)", "m: its code has not returned after 2 s while it was made ready"),
    ],
)
def test_code_that_does_not_return_from_the_initialisation_is_told(tmp_path, start, told):
    with pytest.raises(ComponentLost) as lost:
        run(tmp_path, AT_START=start)
    assert told in str(lost.value)
    (problem,) = lost.value.problems
    assert re.fullmatch(r"`rockshed check \S+\.fmu` looks for the reason", problem.remedy)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("where", ["AT_START", "IN_STEP"])
def test_the_command_ends_with_the_code_of_a_failure(tmp_path, where):
    make(tmp_path, **{where: "if (steps == 4 - 4 * (time_reached == 0)) exit(0)"})
    words = ("--isolate", "all", "--time-limit", "1/2", "--output-dir", "out", "--no-figures")
    code, _, said = command(tmp_path, "run", "system.toml", *words)
    assert code == 1
    assert "ended the process with exit code 0" in said
    assert (tmp_path / "out").exists() == (where == "IN_STEP")
    assert [*tmp_path.glob(".*"), *tmp_path.glob("*.running*"), *(tmp_path / "tmp").iterdir()] == []


@pytest.mark.parametrize("where", ["AT_END", "AT_FREE"])
def test_a_crash_after_the_run_costs_nothing_of_it(tmp_path, where):
    done = run(tmp_path, **{where: CRASH})
    assert (done.status, done.time.size) == ("complete", 11)
    said = "m: its code crashed (SIGSEGV) when it was ended, after the run"
    assert done.provenance["warnings"] == [said]


def test_what_code_prints_is_told_with_its_time_and_how_often_it_came(tmp_path, capfd):
    step = r'puts("same"); fprintf(stderr, "\033[1mat %d", steps); if (steps < 3) puts("")'
    done = run(tmp_path, IN_STEP=step, AT_START=r'printf("half a line")')
    warnings = done.provenance["warnings"]
    assert warnings[0] == "m: prints, first at t = 0 s: half a linesame"
    assert "m: prints, first at t = 0.1 s: same (2 times)" in warnings
    assert "m: prints, first at t = 0.1 s: ?[1mat 2" in warnings
    assert capfd.readouterr() == ("", "")


def test_what_was_printed_before_a_crash_is_told(tmp_path):
    with pytest.raises(RunFailed):
        run(tmp_path, IN_STEP=f'if (steps == 4) {{ printf("no ground at %d", steps); {CRASH}; }}')
    warnings = read_run(tmp_path / "out").provenance["warnings"]
    assert warnings[0] == "m: prints, first at t = 0.3 s: no ground at 4"


def test_much_that_is_printed_neither_stops_the_run_nor_fills_its_warnings(tmp_path):
    done = run(tmp_path, IN_STEP=r'for (int k = 0; k < 20000; k++) printf("%d %d\n", steps, k)')
    warnings = done.provenance["warnings"]
    assert len(warnings) == 6
    assert warnings[-1] == "m: and 199995 other messages"


def test_processes_that_the_code_has_started_end_with_it(tmp_path):
    started = 'if (steps == 2 && !fork()) { sleep(60); _exit(0); } if (steps == 2) system("true")'
    note = f'if (steps == 3) {{ FILE *f = fopen("{tmp_path}/pid", "w"); '
    note += 'fprintf(f, "%d", getpgrp()); fclose(f); }'
    run(tmp_path, IN_STEP=f"{started}; {note}")
    group = (tmp_path / "pid").read_text()
    deadline = time.monotonic() + 30.0
    while living(group):
        assert time.monotonic() < deadline
        time.sleep(0.05)


def living(group):
    """Processes of a group that have not ended."""
    found = []
    for file in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):  # it ends meanwhile
            state, _, its_group, *_ = file.read_text().rpartition(")")[2].split()
            found += [state] if its_group == group and state != "Z" else []
    return found


def test_a_run_that_is_killed_leaves_no_process(tmp_path):
    make(tmp_path, system=ISOLATED.replace("= 2", "= 60"), IN_STEP="if (steps == 4) for (;;)")
    process = program(tmp_path, "run", "system.toml", "--output-dir", "out", "--no-figures")
    running: list[int] = []
    deadline = time.monotonic() + 60.0
    while not running and time.monotonic() < deadline:
        children = subprocess.run(
            ["ps", "-o", "pid=", "--ppid", str(process.pid)], capture_output=True, check=False
        ).stdout.split()
        running = [worker for child in children for worker in workers(int(child))]
        time.sleep(0.05)
    assert running
    os.kill(int(children[0]), signal.SIGKILL)  # the process that works; then the one that waits
    process.kill()
    process.communicate()
    while any(Path(f"/proc/{pid}").exists() for pid in running):
        assert time.monotonic() < deadline
        time.sleep(0.05)


# ---------------------------------------------------------------------- the same bits


@pytest.fixture(scope="module")
def thing(tmp_path_factory):
    """An FMU of FMI 3.0 with one of everything."""
    folder = tmp_path_factory.mktemp("thing")
    return pack(library(folder), folder / "Thing.fmu")


def things(thing, **changes):
    """Two instances with arrays, texts and all types between them, that return early."""
    links = ["a.y -> b.u", "a.said -> b.text", "a.chosen -> b.option"]
    links += [f"a.{kind}_out -> b.{kind}_in" for kind in ("Float32", "Int8", "UInt64", "Boolean")]
    a = {"n": 3, "u[1]": 1.5, "u[2]": 0.1, "u[3]": 3.5, "period": 0.03, "text": "grün", "option": 2}
    b = {"n": 3, "period": 0.07, "UInt64_in": 2**53 - 1, "Float32_in": 0.1, "end": 0.96}
    given = {"a": {**a, "UInt64_in": 2**53 - 1, "Float32_in": 0.1, "Int8_in": -128}, "b": b}
    del given["b"]["UInt64_in"], given["b"]["Float32_in"]
    data = {"name": "things", "connections": links, "exchange_step": 0.1, "stop_time": 1.0}
    parts = {name: {"fmu": str(thing), "parameters": given[name]} for name in "ab"}
    return system_from({**data, "components": parts, **changes})


@pytest.mark.parametrize("master", ["sequential", "jacobi"])
def test_all_types_texts_arrays_sizes_and_early_returns_give_the_same_bits(thing, tmp_path, master):
    here = simulate(things(thing, master=master), tmp_path / "here")
    apart = simulate(things(thing, master=master, isolate=["a"]), tmp_path / "apart")
    assert first_difference(here, apart) is None
    assert here.provenance["texts"] == apart.provenance["texts"]
    assert here.provenance["early_returns"] == apart.provenance["early_returns"]
    assert here.time[-1] == 0.96
    assert here.provenance["early_returns"]["a"] > 10


def test_steps_that_return_early_are_iterated_alike_here_and_apart(thing, tmp_path):
    """Two in a loop; only the early returns of the last iteration count."""
    a, b = {"n": 3, "period": 0.03}, {"n": 3, "period": 0.07, "end": 0.96}
    given = {"connections": ["a.y -> b.u", "b.y -> a.u"], "record": ["*.y*"]}
    given["components"] = {
        name: {"fmu": str(thing), "parameters": part} for name, part in {"a": a, "b": b}.items()
    }
    iterated = {**given, "master": "implicit"}
    here = simulate(things(thing, **iterated), tmp_path / "here")
    apart = simulate(things(thing, **iterated, isolate=["a"]), tmp_path / "apart")
    assert first_difference(here, apart) is None
    assert here.provenance["iteration"] == apart.provenance["iteration"]
    assert max(map(int, here.provenance["iteration"]["iterations"])) > 1
    once = simulate(things(thing, **given), tmp_path / "once")
    for other in (apart, once):
        assert here.provenance["early_returns"] == other.provenance["early_returns"]
    assert here.provenance["early_returns"]["a"] > 10


def test_a_run_goes_on_from_a_checkpoint_in_a_new_process_with_the_same_bits(thing, tmp_path):
    system = things(thing, isolate=["all"])
    whole = simulate(things(thing), tmp_path / "whole")
    simulate(system, tmp_path / "run", checkpoint_every=0.3)
    folder = tmp_path / "run"
    facts = json.loads((folder / "run.json").read_text())
    (folder / "run.json").write_text(json.dumps({**facts, "status": "interrupted"}))
    again = rockshed.resume(folder)
    assert again.provenance["resumed"][0]["at"] > 0.0
    assert first_difference(whole, again) is None
    assert bool(rockshed.verify(again))


LIBRARY = "def factor():\n    return {factor}\n"
SCRIPT = """
from pythonfmu import Fmi2Causality, Fmi2Slave, Real
from helper import factor

class Scaled{n}(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.y = 0.0
        self.register_variable(Real("y", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.y = factor()
        return True
"""


def test_two_python_fmus_with_modules_of_one_name_do_not_disturb_each_other(tmp_path):
    parts = {}
    for n in (1, 2):
        folder = tmp_path / str(n)
        folder.mkdir()
        (folder / "helper.py").write_text(LIBRARY.format(factor=float(n)))
        (folder / f"scaled{n}.py").write_text(SCRIPT.format(n=n))
        words = [
            "-m",
            "pythonfmu",
            "build",
            "-f",
            f"scaled{n}.py",
            "-d",
            str(tmp_path),
            "helper.py",
        ]
        subprocess.run([sys.executable, *words], check=True, cwd=folder)
        parts[f"s{n}"] = {"fmu": str(tmp_path / f"Scaled{n}.fmu")}
    data = {"name": "two", "exchange_step": 0.1, "stop_time": 0.2, "components": parts}
    done = simulate(system_from({**data, "isolate": ["all"]}), tmp_path / "out")
    assert (done.series["s1.y"][-1], done.series["s2.y"][-1]) == (1.0, 2.0)


def test_an_fmu_that_can_be_made_once_in_a_process_is_isolated_twice(tmp_path):
    once = XML.replace("'Odd'/>", "'Odd' canBeInstantiatedOnlyOncePerProcess='true'/>")
    two = SYSTEM + '[components.n]\nfmu = "Odd.fmu"\n'
    with pytest.raises(InputRefused, match="isolate them, or export it under two names"):
        run(tmp_path, xml=once, system=two)
    done = run(tmp_path, xml=once, system=two.replace("stop", 'isolate = ["n"]\nstop'))
    assert done.series["n.x"].tolist() == done.series["m.x"].tolist()


# ---------------------------------------------------------------------- refused


def test_what_cannot_be_isolated_is_refused(tmp_path):
    make(tmp_path, system=SYSTEM.replace("stop_time", 'isolate = ["mm", "m"]\nstop_time'))
    system = load_system(tmp_path / "system.toml")
    mock = Mock([out("x")])
    with pytest.raises(InputRefused) as refusal:
        simulate(system, tmp_path / "out", sources={"m": mock})
    assert [problem.where for problem in refusal.value.problems] == ["isolate", "m: isolate"]


def test_a_time_limit_is_positive():
    for time_limit in (0.0, -1.0, float("inf")):
        with pytest.raises(InputRefused, match="time_limit"):
            system_from(
                {
                    "name": "x",
                    "stop_time": 1,
                    "exchange_step": 1,
                    "components": {"m": {"fmu": "x"}},
                    "time_limit": time_limit,
                }
            )

"""What FMUs do that they should not, or may: it reaches the user, and results are kept."""

import json
import re
import shutil
import signal
import sys
import time

import pytest

from rockshed.core.results.reading import read_run
from tests.cosim.odd_fmus import SYSTEM, XML, end, make, program, run

pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or not shutil.which("cc"), reason="needs Linux and a C compiler"
)


def left(folder):
    """Everything that a run must not leave behind."""
    return [*folder.glob(".*"), *folder.glob("*.running*"), *(folder / "tmp").iterdir()]


@pytest.mark.parametrize("call", ["exit(0)", "_exit(0)", "exit(7)"])
def test_an_fmu_that_ends_the_process_is_a_failure_with_component_and_time(tmp_path, call):
    make(tmp_path, IN_STEP=f"if (steps == 4) {call}")
    code, _, said = run(tmp_path)
    assert code == 1
    assert re.search(r"m at t = 0\.3 s: its code ended the process with the exit code \d", said)
    assert read_run(tmp_path / "out").status == "failed"
    assert left(tmp_path) == []


@pytest.mark.parametrize("where", ["AT_END", "AT_FREE"])
def test_a_crash_after_the_run_keeps_its_results_and_names_the_component(tmp_path, where):
    make(tmp_path, **{where: "*(volatile int *)8 = 1"})
    code, shown, said = run(tmp_path)
    assert code == 1
    assert "m: its code crashed (SIGSEGV) when it was ended, after the run" in said
    assert "simulated time" in shown
    kept = read_run(tmp_path / "out")
    assert (kept.status, len(kept.time)) == ("complete", 11)
    assert any("SIGSEGV" in text for text in kept.warnings)
    assert left(tmp_path) == []


def test_what_an_fmu_prints_does_not_reach_the_results_on_stdout(tmp_path):
    make(tmp_path, IN_STEP='puts("hello"); printf("half a line")', AT_START='puts("made")')
    code, shown, said = run(tmp_path, "run", "system.toml", "--json", "--no-figures")
    assert code == 0
    assert json.loads(shown)["status"] == "complete"
    assert said.count("hello") == 10


def test_a_component_may_end_the_run_at_its_last_successful_time(tmp_path):
    step = 'if (steps == 4) { time_reached = t + h / 2; ended = 1; SAY(0, "done"); return 2; }'
    make(tmp_path, IN_STEP=step)
    code, _, said = run(tmp_path)
    assert (code, "m has ended the run at t = 0.35 s" in said) == (0, True)
    kept = read_run(tmp_path / "out")
    assert kept.status == "complete"
    assert kept.time.tolist() == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.35])
    assert list(kept["m.x"]) == pytest.approx(kept.time.tolist())
    assert kept.metrics["simulated_time"].value == pytest.approx(0.35)


def test_a_step_that_is_discarded_without_an_end_is_a_failure(tmp_path):
    make(tmp_path, IN_STEP="if (steps == 4) return 2")
    code, _, said = run(tmp_path)
    assert (code, "m at t = 0.3 s: the step by 0.1 s failed (Discard)" in said) == (1, True)


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ({"STATUS": "1", "IN_STEP": 'SAY(1, "extrapolated")'}, "m: extrapolated (10 times)"),
        ({"IN_STEP": 'SAY(1, "extrapolated")'}, "m: extrapolated (10 times)"),
        ({"STATUS": "1"}, "m: returned Warning without a message (10 times)"),
        ({"AT_END": 'SAY(3, "cannot end"); return 3'}, "m: cannot end"),
        ({"AT_END": "return 3"}, "m: fmi2Terminate returned Error"),
    ],
    ids=["both", "message", "status", "end", "silent end"],
)
def test_what_an_fmu_says_after_the_start_is_told_once_with_a_count(tmp_path, code, told):
    make(tmp_path, **code)
    exit_code, _, said = run(tmp_path)
    assert (exit_code, said.count(told)) == (0, 1)
    assert told in read_run(tmp_path / "out").warnings


def test_many_different_messages_are_told_up_to_a_limit(tmp_path):
    text = 'char text[9]; snprintf(text, 9, "no. %d", steps); SAY(1, text)'
    make(tmp_path, IN_STEP=text)
    assert run(tmp_path)[0] == 0
    warnings = read_run(tmp_path / "out").warnings
    assert warnings == [*(f"m: no. {n}" for n in range(1, 6)), "m: and 5 other messages"]


@pytest.mark.parametrize("status", ["99", "-1", "2147483647"])
def test_a_status_that_fmi_does_not_know_is_a_failure_in_words(tmp_path, status):
    make(tmp_path, STATUS=status)
    code, _, said = run(tmp_path)
    assert code == 1
    assert f"({status}, which is no status of FMI)" in said
    assert "Traceback" not in said


@pytest.mark.parametrize("reference", ["-1", "4294967296", "one", ""])
def test_a_value_reference_that_is_none_is_refused_in_words(tmp_path, reference):
    make(tmp_path, xml=XML.replace("valueReference='1'", f"valueReference='{reference}'"))
    code, _, said = run(tmp_path)
    assert code == 2
    assert "Traceback" not in said
    assert "valueReference" in said
    assert not (tmp_path / "out").exists()


def started(folder):
    """A run whose FMU does not return from its fourth step."""
    make(folder, IN_STEP='if (steps == 4) { puts("loops"); fflush(stdout); for (;;); }')
    process = program(folder, "run", "system.toml", "--output-dir", "out", "--no-figures")
    while process.stderr.readline() != "loops\n":
        assert process.poll() is None
    return process


def test_the_second_ctrl_c_ends_a_loop_in_an_fmu_and_names_it(tmp_path):
    code, _, said = end(started(tmp_path), signal.SIGINT, signal.SIGINT)
    assert code == 130
    assert "m at t = 0.3 s: its code did not return when the run was interrupted" in said
    assert read_run(tmp_path / "out").status == "interrupted"
    assert left(tmp_path) == []


@pytest.mark.slow
def test_who_asks_a_loop_in_an_fmu_to_terminate_gets_its_end(tmp_path):
    process = started(tmp_path)
    began = time.monotonic()
    assert end(process, signal.SIGTERM)[0] == 130
    assert time.monotonic() - began < 15.0
    assert read_run(tmp_path / "out").status == "interrupted"


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP", "SIGXCPU"])
def test_every_request_to_end_keeps_the_results_and_leaves_nothing(tmp_path, name):
    make(tmp_path, IN_STEP="usleep(50000)")
    system = (tmp_path / "system.toml").read_text()
    (tmp_path / "system.toml").write_text(system.replace("stop_time = 1.0", "stop_time = 1000.0"))
    process = program(tmp_path, "run", "system.toml", "--output-dir", "out", "--no-figures")
    deadline = time.monotonic() + 30.0
    while not (tmp_path / "out.running/timeseries.arrows").is_file():
        assert time.monotonic() < deadline
        time.sleep(0.05)
    code, _, said = end(process, getattr(signal, name))
    assert (code, "the results until then are kept" in said) == (130, True), said
    kept = read_run(tmp_path / "out")
    assert kept.status == "interrupted"
    assert len(kept.time) > 0
    assert left(tmp_path) == []


def test_a_later_run_sweeps_what_a_kill_had_to_leave(tmp_path):
    process = started(tmp_path)
    process.kill()
    process.wait()
    assert len(list((tmp_path / "tmp").iterdir())) == 1
    deadline = time.monotonic() + 10.0
    make(tmp_path)
    while True:  # the child is ended by the system, a little later
        code, _, said = run(tmp_path)
        assert code == 0
        if not left(tmp_path) or time.monotonic() > deadline:
            break
    assert "a run that did not end has left" in said or left(tmp_path) == []
    assert read_run(tmp_path / "out").status == "complete"
    assert left(tmp_path) == []


@pytest.mark.parametrize("rate", [30, 60, 44_100])
def test_an_fmu_with_a_fixed_step_that_is_no_decimal_number_gets_that_step(tmp_path, rate):
    now = f"(steps - 1) / {rate}.0"
    status = f"(h == 1.0 / {rate} && t == {now} && callbacks ? 0 : 3)"
    stop = 1.0 if rate < 100 else 0.01
    system = SYSTEM.replace("0.1", f'"1/{rate}"').replace("1.0", str(stop))
    make(tmp_path, system=system, STATUS=status)
    code, _, said = run(tmp_path)
    assert code == 0, said
    count = round(rate * stop)
    assert list(read_run(tmp_path / "out").time) == [n / rate for n in range(count + 1)]


def test_a_step_that_is_a_rounded_fraction_is_told_the_fraction(tmp_path):
    make(tmp_path, system=SYSTEM.replace("0.1", "0.016666666667"))
    code, _, said = run(tmp_path)
    assert code == 2
    assert 'if the step is meant to be a fraction, write "1/60"' in " ".join(said.split())
    code, _, said = run(tmp_path, "run", "system.toml", "--exchange-step", "1/60", "--no-figures")
    assert code == 0, said

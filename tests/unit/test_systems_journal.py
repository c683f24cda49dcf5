"""What was measured of the impact systems is kept turn by turn, and goes on where it was ended."""

import json
import subprocess
import sys
import time
from dataclasses import replace
from threading import Event, Thread, Timer
from typing import ClassVar

import numpy as np
import pytest

from rockshed.core.errors import InputRefused
from rockshed.systems import measuring
from rockshed.systems.catalogue import impact_systems
from rockshed.systems.children import Children, MeasurementEnded
from rockshed.systems.findings import findings
from rockshed.systems.journal import Turn, journal_in
from rockshed.systems.masters.ours import exchanges
from rockshed.systems.masters.table import MASTERS, adaptive
from rockshed.systems.measured import MasterRun, SuiteRuns
from rockshed.systems.measuring import merged, turns_of

FACTS = {"stamps": {"terminals": "a"}}
TURN = Turn("terminals", "fmi2-native", "libcosim", 0)
ROW = MasterRun(*TURN[:1], TURN.master, TURN.variant, 1e-3, 160, "", 0.1, 0.02, 3e-4, 0.0)


def test_a_turn_that_was_kept_is_there_when_the_folder_is_opened_again(tmp_path):
    with journal_in(tmp_path, FACTS) as journal:
        journal.add(TURN, [ROW], 2.0)
    with journal_in(tmp_path, FACTS) as journal:
        assert journal.rows == {TURN: [ROW]}
        assert journal.seconds == 2.0
        journal.remove()
    assert [path.name for path in tmp_path.iterdir()] == [".measured.lock"]


def test_a_line_that_was_cut_by_a_kill_is_measured_again(tmp_path):
    with journal_in(tmp_path, FACTS) as journal:
        journal.add(TURN, [ROW], 2.0)
        journal.add(TURN._replace(round=1), [ROW], 2.0)
    text = journal.file.read_text()
    for length in (len(text) - 1, len(text) - 40):
        journal.file.write_text(text[:length].rstrip("\n")[: length - 1])
        with journal_in(tmp_path, FACTS) as again:
            assert list(again.rows) == [TURN]
            again.add(TURN._replace(round=1), [ROW], 2.0)
            assert again.file.read_text() == text


@pytest.mark.parametrize("before", ["", "no JSON\n", '{"facts": {"stamps": {}}}\n{"turn": 1}\n'])
def test_measurements_of_other_kernels_or_of_somebody_else_are_dropped(tmp_path, before):
    with journal_in(tmp_path, FACTS) as journal:
        place = journal.file
    place.write_text(before)
    with journal_in(tmp_path, FACTS) as journal:
        assert journal.rows == {}
        assert json.loads(place.read_text()) == {"facts": FACTS}
        assert journal.is_other == before.startswith("{")


def test_two_processes_do_not_measure_into_one_folder(tmp_path):
    with (
        journal_in(tmp_path, FACTS),
        pytest.raises(InputRefused, match="another process is measuring"),
        journal_in(tmp_path, FACTS),
    ):
        pass


def test_a_journal_in_a_place_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputRefused), journal_in(tmp_path / "file", FACTS):
        pass


def test_in_each_round_every_master_takes_its_turn_and_the_reference_is_first():
    systems = impact_systems(("terminals",))
    turns = list(turns_of(systems, True, 3, MASTERS))
    names = [turn.master for turn in turns]
    assert [turn.round for turn in turns] == sorted(turn.round for turn in turns)
    assert names[: len(MASTERS)] == names[len(MASTERS) : 2 * len(MASTERS)]
    assert names[0] == "rockshed, jacobi"
    whole = list(turns_of(systems, False, 3, MASTERS))
    assert {turn.round for turn in whole if turn.variant != "fmi2-native"} == {0}


def test_costs_of_rounds_become_their_median_and_values_stay_those_of_the_first():
    rows = [replace(ROW, cost=cost, error=cost) for cost in (3.0, 1.0, 2.0)]
    other = MasterRun("terminals", "ecos", "fmi2-native", 1e-3, 160, "not installed")
    found = merged([rows[:1], [other], rows[1:2], rows[2:], [other]])
    assert found == [replace(ROW, cost=2.0, error=3.0), other]


def test_a_process_of_a_measurement_ends_with_it():
    children = Children()
    begun = time.monotonic()
    Timer(0.5, children.end).start()
    with children.at_work, pytest.raises(MeasurementEnded):
        children.run([sys.executable, "-c", "import time; time.sleep(60)"], 60.0, {})
    assert time.monotonic() - begun < 30.0
    with children.at_work, pytest.raises(MeasurementEnded):
        children.run([sys.executable, "-c", ""], 60.0, {})


def test_a_process_that_takes_too_long_is_killed():
    children = Children()
    with children.at_work:
        with pytest.raises(subprocess.TimeoutExpired):
            children.run([sys.executable, "-c", "import time; time.sleep(60)"], 0.2, {})
        assert children.run([sys.executable, "-c", "print(1)"], 60.0, {}) == (0, "1\n")


def test_while_one_thread_waits_for_a_process_another_one_is_at_work():
    children = Children()
    began = Event()

    def other():
        with children.at_work:
            began.set()

    thread = Thread(target=other)
    with children.at_work:
        thread.start()
        assert not began.wait(0.1)
        code = "import time; time.sleep(0.5)"
        children.run([sys.executable, "-c", code], 60.0, {})
        assert began.is_set()
    thread.join()


class FakeBench:
    """A bench on which masters have a result at once, and that knows who has run."""

    ran: ClassVar[list] = []

    def __init__(self, system, variant, _place, _installed, children):
        self.system, self.variant, self.children = system, variant, children

    def run(self, masters, steps):
        self.ran += [(self.system.name, self.variant.name, master.name) for master in masters]
        kind, stop = self.variant.name, self.system.stop_time
        return {
            m.name: [
                MasterRun(self.system.name, m.name, kind, s, round(stop / s), "", 0.1, 0.0, 1.0)
                for s in steps
            ]
            for m in masters
        }

    def know_reference(self, _steps):
        self.ran.append("reference")


def test_a_measurement_that_was_ended_goes_on_with_the_turns_that_are_left(tmp_path, monkeypatch):
    monkeypatch.setattr(measuring, "Bench", FakeBench)
    monkeypatch.setattr(FakeBench, "ran", [])
    systems = impact_systems(("terminals", "algebraic-loop"))
    facts = {"versions": {}, "platform": "here", "quick": False, "stamps": {}}

    def ends(done, _total):
        if done > 40:
            raise KeyboardInterrupt

    with journal_in(tmp_path, facts) as journal, pytest.raises(KeyboardInterrupt):
        measuring.measure(systems, facts, 3, journal, ends)
    before = len(FakeBench.ran)
    assert before >= 40
    with journal_in(tmp_path, facts) as journal:
        measured = measuring.measure(systems, facts, 3, journal)
    turns = [ran for ran in FakeBench.ran if ran != "reference"]
    assert len(turns) == 2 * (3 + 1 + 1) * len(MASTERS)
    assert len(measured.rows) == sum(len(s.steps) + 2 for s in systems) * len(MASTERS)
    assert measured == measuring.measure(systems, facts, 3, journal)


class Fake:
    """Times of rows, and mean lengths of the exchanges between them."""

    def __init__(self, **series):
        self.series = series


def test_exchanges_of_an_adaptive_step_are_counted_between_the_rows():
    fixed = Fake(time=np.arange(5.0))
    assert exchanges(fixed) == 4
    varied = {"time": np.arange(5.0), "coupling.step": np.array([0.0, 1.0, 0.5, 0.25, 1 / 3])}
    assert exchanges(Fake(**varied)) == 1 + 2 + 4 + 3


def test_tolerances_of_adaptive_steps_go_down_as_errors_do():
    system = impact_systems(("terminals",))[0]
    found = [adaptive("doubling", system, s)["adaptive"].tolerance for s in system.steps]
    assert found == pytest.approx([0.1 * s / system.steps[0] for s in system.steps])
    found = [adaptive("ledger", system, s)["adaptive"].tolerance for s in system.steps]
    assert found == pytest.approx([0.01 * (s / system.steps[0]) ** 2 for s in system.steps])


def test_findings_are_told_from_the_numbers():
    def rows(master, errors, energy=0.0, reason=""):
        steps = impact_systems(("terminals",))[0].steps
        return [
            MasterRun("terminals", master, "fmi2-native", s, round(0.16 / s), reason, e, energy)
            for s, e in zip(steps, errors, strict=True)
        ]

    second = (0.256, 0.064, 0.016, 0.001)
    first = (0.24, 0.12, 0.06, 0.015)
    measured = SuiteRuns(
        [
            *rows("rockshed, jacobi", first, 0.03),
            *rows("libcosim", second, 0.001),
            *rows("ecos", (0.3, 0.3, 0.3, 0.3), -0.02),
            *rows("fmpy, slaves", (None,) * 4, None, "not installed"),
            *rows("CoFmuPy, jacobi", first, 0.001),
        ],
        {},
        "here",
        False,
    )
    found = {each.master: each for each in findings(measured)}
    assert found["rockshed, jacobi"].energy == ("terminals: +3 %",)
    assert found["libcosim"].gained == ("terminals: 2.0, not 1.0",)
    assert found["ecos"].beyond == ("terminals: 0.3 > 0.06",)
    assert found["fmpy, slaves"].cannot == ("terminals",)
    assert found["CoFmuPy, jacobi"].are_none
    assert not found["ecos"].are_none

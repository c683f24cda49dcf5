"""Tables of README and docs: of the present kernels, with the seeds that they tell, and filled."""

import copy
import json
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from docs.tables import convergence, kept, masters, platforms, systems
from docs.tables.filling import BLOCK, PAGES, TABLES, filled
from docs.tables.forms import beside, number
from docs.tables.kept import Kept, NotKeptError, outdated, take
from docs.tables.pictures import PICTURES, STAMPS, stamp
from docs.tables.sonoda1993 import PEAK
from rockshed.components.catalogue import NAMES
from rockshed.papers.reproduction import DATA, PAPERS, studies
from rockshed.papers.sonoda1993 import full_scale, laboratory, mesh, one_law
from rockshed.systems.findings import findings
from rockshed.systems.masters.table import MASTERS

ROOT = Path(__file__).parents[2]


def content(paper):
    return json.loads((ROOT / "docs" / "results" / f"{paper}.json").read_text(encoding="utf-8"))


# ------------------------------------------------------------------ from the present kernels


@pytest.mark.parametrize("paper", PAPERS)
def test_kept_results_come_from_the_present_kernels(paper):
    assert not outdated(paper, content(paper))


def test_a_table_of_an_older_kernel_is_refused_with_the_study_and_the_remedy():
    older = copy.deepcopy(content("mogami1973"))
    chosen = next(study for study in older["studies"] if study["name"] == "fits")
    chosen["stamps"]["rows"] = "0" * 64
    assert outdated("mogami1973", older) == [
        "mogami1973/fits: rows: other than when kept; carry out `rockshed reproduce mogami1973`, "
        "then `python -m docs.tables results/mogami1973`"
    ]
    older["studies"].remove(chosen)
    assert outdated("mogami1973", older)[0].startswith("mogami1973/fits: is not kept")


@pytest.mark.parametrize("picture", PICTURES)
def test_pictures_of_pages_are_drawn_with_the_present_kernels(picture):
    assert json.loads(STAMPS.read_text(encoding="utf-8"))[picture] == stamp(PICTURES[picture])


def test_the_kept_study_of_convergence_comes_from_the_present_kernels():
    """Otherwise: `rockshed converge`, then `python -m docs.tables.convergence FOLDER`."""
    assert convergence.trial()[convergence.STAMP] == convergence.stamp()


def test_the_kept_measurement_of_the_impact_systems_comes_from_the_present_kernels_and_steps():
    """Otherwise: `rockshed bench systems`, then `python -m docs.tables.systems results/systems`."""
    assert systems.outdated(systems.kept()) == []


def test_a_measurement_of_impact_systems_by_an_older_kernel_is_refused_with_the_remedy():
    kept_stamps = systems.kept().stamps
    older = replace(systems.kept(), stamps={**kept_stamps, "terminals": "0" * 64})
    assert systems.outdated(older) == [
        "terminals: other than when measured, by kernels or truth; run `rockshed bench systems`, "
        "then `python -m docs.tables.systems results/systems`"
    ]


def test_something_was_found_about_every_master_of_the_impact_systems():
    found = findings(systems.kept())
    assert len(found) == len(MASTERS)
    assert [each.master for each in found if each.are_none] == []


def test_fmus_of_all_components_were_run_on_every_other_platform_with_the_present_kernels():
    """Otherwise: see `docs/tables/platforms.py`."""
    assert platforms.outdated(platforms.kept()["rows"]) == []


def test_runs_on_other_platforms_by_an_older_kernel_are_refused_with_the_remedy():
    rows = copy.deepcopy(platforms.kept()["rows"])
    chosen = [("SandCushion", "2.0", "win64"), (platforms.IMPACT, "2.0", "")]
    for row in rows:
        if (row["name"], row["fmi"], row["platform"]) in chosen:
            row["stamp"] = "0" * 64
    found = platforms.outdated(rows)
    assert [line.partition(": ")[0] for line in found] == [
        "SandCushion, FMI 2.0, win64",
        f"{platforms.IMPACT}, FMI 2.0, system",
    ]
    assert all("other than when it was run, by kernels; run `pytest" in line for line in found)


def junit(folder, stamp):
    """Results of the tests of other platforms, without wine."""
    told = '<properties><property name="stamp" value="{}"/></properties>'
    cases = [
        f'<testcase classname="{module}" name="test_x[{name}-{platform}]">'
        f"{'<skipped message=no wine/>' if platform == 'win64' else told.format(stamp(name))}"
        "</testcase>"
        for module in platforms.TESTS
        for name in NAMES
        for platform in platforms.RUNNERS
    ]
    text = "".join(cases).replace("message=no wine", 'message="no wine"')
    (folder / "results.xml").write_text(f"<testsuites>{text}</testsuites>")
    return [folder / "results.xml"]


def test_runs_on_other_platforms_are_kept_from_the_results_of_the_tests(tmp_path, monkeypatch):
    monkeypatch.setattr(platforms, "DATA", tmp_path / "platforms.json")
    monkeypatch.setattr(platforms, "kept", cache(platforms.kept.__wrapped__))
    platforms.take(junit(tmp_path, platforms.stamp))
    assert "| FallingRock | 2.0 | native | not run: no wine | equal bits |" in platforms.platforms()
    with pytest.raises(NotKeptError, match=r"aarch64-linux: other than when it was run"):
        platforms.take(junit(tmp_path, lambda name: platforms.stamp(name)[::-1]))
    (tmp_path / "results.xml").write_text("<testsuites/>")
    with pytest.raises(NotKeptError, match="FallingRock, FMI 3"):
        platforms.take([tmp_path / "results.xml"])


def test_the_measurement_of_masters_on_a_shed_comes_from_the_present_kernels():
    """Otherwise: `python -m docs.implicit_shed`, then `python -m docs.tables`."""
    assert masters.outdated(masters.kept()) == []


def test_a_measurement_of_masters_by_an_older_kernel_or_of_other_runs_is_refused():
    older = {**masters.kept(), "stamp": "0" * 64, "rows": masters.kept()["rows"][1:]}
    remedy = "run `python -m docs.implicit_shed`, then `python -m docs.tables`"
    assert masters.outdated(older) == [
        f"has other runs than are measured; {remedy}",
        f"other than when measured, by kernels; {remedy}",
    ]


def test_every_picture_of_a_run_of_the_sand_has_a_stamp():
    shown = re.findall(r"\(docs/([\w-]+\.png)\)", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert set(shown) - {"rockfall.png"} == set(PICTURES)  # of a campaign, without sand


@pytest.mark.parametrize("paper", PAPERS)
def test_kept_results_are_whole(paper):
    found = content(paper)
    assert found["quick"] is False
    assert [study["name"] for study in found["studies"]] == [s.name for s in studies(paper)]
    assert all(
        row["computed"] is not None or row["verdict"] or row["note"]
        for study in found["studies"]
        for row in study["rows"]
    )


def test_kept_rows_have_the_seeds_of_their_studies():
    found = Kept(content("sonoda1993"))
    energy = "girders of 8 m: energy / rock's by eq. (7)"
    for study, quantity, model, seeds in (
        ("table2", f"{PEAK}, test 4", "one-law", laboratory.SEEDS),
        ("figs17-18", "peak beam energy, eq. (7), test 10", "one-law", laboratory.SEEDS),
        ("table5", f"{PEAK}, E_bar 20, h 0.1", "calibrated", laboratory.SEEDS),
        ("girders", "settled ratio transmitted / rock, span 8 m", "one-law", full_scale.SEEDS),
        ("one-law", energy, "one-law", one_law.SEEDS),
        ("one-law", energy, "E_bar 50", one_law.VARIED_SEEDS),
        ("mesh", f"{PEAK}, discs of radius 2.5 mm", "one-law", mesh.SEEDS),
    ):
        row = found.row(study, quantity, model)
        assert row["seeds"] == list(seeds), (study, quantity)
        assert row["spread"] is not None


# ------------------------------------------------------------------ pages


@pytest.mark.parametrize("page", PAGES)
def test_filling_a_page_changes_no_byte(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    assert filled(text) == text


def test_every_table_stands_on_a_page():
    shown = {
        found[:2]
        for page in PAGES
        for found in BLOCK.findall((ROOT / page).read_text(encoding="utf-8"))
    }
    assert shown == {(paper, name) for paper, names in TABLES.items() for name in names}


def test_the_number_of_seeds_in_the_text_is_that_of_the_rows():
    for page in ("README.md", "docs/sonoda1993.md"):
        text = (ROOT / page).read_text(encoding="utf-8")
        told = re.findall(r"seeds \((\d+) in the laboratory, (\d+) at full scale\)", text)
        assert told == [(str(len(laboratory.SEEDS)), str(len(full_scale.SEEDS)))]


def results_of(page):
    """The part of a page that tells results of papers."""
    text = (ROOT / page).read_text(encoding="utf-8")
    if page != "README.md":
        return text
    return re.search(r"^## Results against the papers\n(.*?)^## ", text, re.M | re.S)[1]


MEASURED = re.compile(r"\d (?:±|\+-) \d|(?<![+-])[+-]\d+(?:\.\d+)? %")
"""Form of computed numbers: with a spread, or with a deviation."""


@pytest.mark.parametrize("page", [*PAGES, "components/sand_cushion/README.md"])
def test_computed_numbers_of_a_paper_stand_between_marks_only(page):
    assert MEASURED.findall(BLOCK.sub("", results_of(page))) == []


def test_the_pages_have_such_numbers_between_their_marks():
    assert len(MEASURED.findall(results_of("docs/sonoda1993.md"))) > 100


def test_a_block_that_nobody_writes_is_refused():
    with pytest.raises(NotKeptError, match="sonoda1993/table7: there is no such table"):
        filled("<!-- table: sonoda1993/table7 -->\n<!-- end -->\n")


# ------------------------------------------------------------------ what is kept


def reproduction(folder, **changes):
    """The file of a reproduction of Ushiro, with something changed in it."""
    made = {**content("ushiro"), "runs": [], **changes}
    for study in made["studies"]:
        for row in study["rows"]:
            row |= {"model_options": {}, "fmus": {}, "runs": []}
    folder.mkdir(exist_ok=True)
    (folder / DATA).write_text(json.dumps(made))
    return folder


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"quick": True}, "quick reproduction"),
        ({"runs": [{"status": "interrupted", "wall_time": 0.0}]}, "was interrupted"),
        ({"studies": []}, "lacks figure7"),
    ],
)
def test_results_that_are_not_whole_are_not_kept(tmp_path, monkeypatch, changes, reason):
    monkeypatch.setattr(kept, "FOLDER", tmp_path)
    with pytest.raises(NotKeptError, match=reason):
        take(reproduction(tmp_path / "out", **changes))
    assert not (tmp_path / "ushiro.json").exists()


def test_what_is_kept_is_what_was_found(tmp_path, monkeypatch):
    before = content("ushiro")
    monkeypatch.setattr(kept, "FOLDER", tmp_path)
    after = json.loads(take(reproduction(tmp_path / "out")).read_text())
    assert after["studies"] == before["studies"]
    assert after["runs"] == 0


def test_a_row_that_is_missing_or_of_several_models_is_refused():
    row = {"quantity": "P", "model": "a", "computed": 1.0}
    found = Kept({"studies": [{"name": "s", "rows": [row, {**row, "model": "b"}]}]})
    assert found.value("s", "P", "b") == 1.0
    for model in ("", "c"):
        with pytest.raises(NotKeptError, match="s: there is no row 'P'"):
            found.row("s", "P", model)


def test_numbers_are_written_with_spread_and_deviation():
    row = {"computed": 538.2, "spread": 51.4, "experiment": 519.1}
    assert beside(row, "experiment") == "538 ± 51 (+4 %)"
    assert number(-0.04, 1) == "0.0"

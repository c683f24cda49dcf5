"""Files as people have them, names as people give them, screens as people have them."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import rockshed as package
from rockshed.analyses.calibration.curve_file import read_curve
from rockshed.commands.app import app
from rockshed.commands.screen import Screen
from rockshed.core.errors import InputRefused
from rockshed.core.form_faults import sentence
from rockshed.core.system.reading import system_from
from rockshed.papers.reproduction import PAPERS
from rockshed.pictures.style import literal
from rockshed.sites.rockfall.preparation import prepare
from rockshed.sites.rockfall.profile_files import UNITS
from rockshed.tables import Table

EXAMPLES = Path(package.__file__).parent / "examples"
SITE = """\
name = "NAME"
trials = 3
rock = { radius = 0.5, density = 2600 }
start = { x = 1 }
limit_speed = { mean = 12, deviation = 2 }
profile = { file = "FILE" }
ground = [{ material = "soil" }]
line = [{ name = "road", x = 50 }]
"""
PROFILE = "x,y\n0,60\n20,40.5\n40,30\n70,5\n100,0\n"


@pytest.fixture
def rockshed(tmp_path, monkeypatch):
    """Run a command in an empty folder, on a screen of 300 columns."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "300")
    return lambda *arguments: CliRunner().invoke(app, [str(a) for a in arguments])


@pytest.fixture
def site(tmp_path):
    """Write a site with this name and profile."""

    def written(name="site", profile=PROFILE, file="profile.csv", site="site.toml"):
        place = tmp_path / file
        place.write_bytes(profile.encode() if isinstance(profile, str) else profile)
        text = SITE.replace("NAME", name).replace("FILE", file)
        (tmp_path / site).write_text(text, encoding="utf-8")
        return tmp_path / site

    return written


# ------------------------------------------------------------------ names


@pytest.mark.parametrize(
    "name",
    [
        "../above", "/etc/x", "a/b", "a\\\\b", ".", "..", ".x", "x" * 300, "a\\u0000b", "a\\nb", " ",
        "é" * 100, "x.running", "nul",
    ],
)  # fmt: skip
@pytest.mark.parametrize("command", ["rockfall", "pile"])
def test_a_name_that_leads_out_of_results_is_refused_before_anything_is_computed(
    rockshed, site, tmp_path, command, name
):
    if command == "rockfall":
        site(name)
    else:
        text = (EXAMPLES / "spt.toml").read_text().replace('name = "spt"', "")
        (tmp_path / "site.toml").write_text(f'name = "{name}"\n{text}')
    before = sorted(tmp_path.rglob("*"))
    result = rockshed(command, "site.toml", "--no-figures")
    assert result.exit_code == 2, result.output
    assert "--output-dir" in result.stderr
    assert "site.toml, line 1, column 1" in result.stderr
    assert sorted(tmp_path.rglob("*")) == before
    assert not list(tmp_path.parent.glob("above*"))


def test_a_name_is_text_where_the_folder_is_named(rockshed, site):
    site("../above")
    assert rockshed("rockfall", "site.toml", "--no-figures", "--output-dir", "o").exit_code == 0
    assert json.loads(Path("o/run.json").read_text())["name"] == "../above"


def test_names_with_marks_of_formulas_markup_and_emoji_are_text(rockshed, site, tmp_path):
    name = "_a $x$ [b] [front] :rock: ü 道"
    file = site(name)
    file.write_text(file.read_text().replace("road", "[bold]$road_1^$ :rock:"), encoding="utf-8")
    result = rockshed("rockfall", "site.toml")
    assert result.exit_code == 0, result.output
    assert "[bold]$road_1^$ :rock:  " in result.stdout
    assert (tmp_path / "results" / name / "figures" / "ends.png").is_file()
    assert literal(name) == r" _a \$x\$ [b] [front] :rock: ü 道"
    assert literal("a\nb\x1b" + "x" * 300) == "a b " + "x" * 76 + "..."


def test_two_lines_that_are_one_name_in_the_results_are_refused(site):
    file = site()
    text = file.read_text().replace(
        '[{ name = "road", x = 50 }]', '[{ name = "a b", x = 50 }, { name = "a-b", x = 60 }]'
    )
    file.write_text(text)
    with pytest.raises(InputRefused, match="are one name in the results"):
        prepare(file)
    file.write_text(text.replace("a b", "橋").replace("a-b", "道"), encoding="utf-8")
    prepare(file)
    file.write_text(text.replace("a b", "largest"), encoding="utf-8")
    with pytest.raises(InputRefused, match="name of columns"):
        prepare(file)


def test_results_of_another_site_of_the_same_name_stay(rockshed, site, tmp_path):
    site("same")
    assert rockshed("rockfall", "site.toml", "--no-figures").exit_code == 0
    (tmp_path / "b").mkdir()
    for file in ("site.toml", "profile.csv"):
        shutil.copy(tmp_path / file, tmp_path / "b" / file)
    first = Path("results/same/run.json").read_bytes()
    result = rockshed("rockfall", "b/site.toml", "--no-figures")
    assert result.exit_code == 0
    assert "results/same holds other results, which stay" in " ".join(result.stderr.split())
    assert Path("results/same/run.json").read_bytes() == first
    assert json.loads(Path("results/same-2/run.json").read_text())["site_file"] == "b/site.toml"
    for folder, file in (("same", "site.toml"), ("same-2", "b/site.toml")):  # the same ones again
        assert rockshed("rockfall", file, "--trials", 4, "--no-figures").exit_code == 0
        found = json.loads((tmp_path / "results" / folder / "summary.json").read_text())
        assert found[0]["value"] == 4
    assert not Path("results/same-3").exists()


# ------------------------------------------------------------------ files


@pytest.mark.parametrize(
    "profile",
    [
        "\ufeff" + PROFILE,
        PROFILE.replace("\n", "\r\n"),
        PROFILE.replace("\n", "\r"),
        '"x","y"\n' + PROFILE.partition("\n")[2],
        PROFILE.replace(",", ";").replace(".", ","),
        PROFILE.replace(",", "\t"),
        "sep=;\r\n" + PROFILE.replace(",", ";").replace(".", ",").replace("\n", "\r\n"),
        PROFILE.replace("20,40.5", '"20","40,5"'),
        "# a survey\n\n" + PROFILE.replace("x,y\n", '"x","y","material"\n').replace("0\n", '0,"soil"\n'),
    ],
)  # fmt: skip
def test_a_profile_is_read_as_programs_of_surveys_and_spreadsheets_write_it(site, profile):
    nodes = prepare(site(profile=profile)).nodes
    assert [(n.x, n.y) for n in nodes] == [(0, 60), (20, 40.5), (40, 30), (70, 5), (100, 0)]


@pytest.mark.parametrize(
    "text",
    [
        '\ufeff"penetration (cm)";"load (kgf)"\r\n0,5;20\r\n1;41,5\r\n"2";"80"\r\n',
        '"penetration (cm)","load (kgf)"\n"0.5","20"\n"1","41.5"\n"2","80"\n',
        "penetration (cm)\tload (kgf)\n0.5\t20\n1\t41.5\n2\t80\n",
    ],
)
def test_a_curve_is_read_by_the_same_rules(tmp_path, text):
    (tmp_path / "curve.csv").write_bytes(text.encode())
    found = read_curve(tmp_path / "curve.csv")
    np.testing.assert_allclose(found.depth, [0.005, 0.01, 0.02])
    np.testing.assert_allclose(found.load / 9.80665, [20, 41.5, 80])


def test_a_quoted_field_may_have_separators_quotes_and_line_ends(site):
    with pytest.raises(InputRefused) as refusal:
        prepare(site(profile='x,y,material\n0,60,"so""i,l\nx"\n20,40,soil\n100,zero,\n'))
    told = [str(problem) for problem in refusal.value.problems]
    assert any("line 5, column 5: 'zero' is no finite number" in text for text in told), told
    assert any("there is no material" in text for text in told)


def test_thousands_are_not_taken_for_decimals(site):
    with pytest.raises(InputRefused, match="'1,000' is no finite number"):
        prepare(site(profile='x,y\n0,60\n"1,000",40\n'))


@pytest.mark.parametrize("name", ["slope.toml", "pile.toml", "rigid_floor.toml"])
def test_a_byte_order_mark_is_no_part_of_a_file(rockshed, tmp_path, name):
    content = (EXAMPLES / name).read_bytes()
    (tmp_path / name).write_bytes(b"\xef\xbb\xbf" + content)
    from rockshed.core.system.reading import load_system
    from rockshed.sites.pile.preparation import prepare as prepare_pile

    {"slope.toml": prepare, "pile.toml": prepare_pile, "rigid_floor.toml": load_system}[name](
        tmp_path / name
    )


def drawing(file, code, scale, upright=False):
    """Write a drawing of the profile, in a unit of this length (m)."""
    tags = (
        "0 SECTION 2 HEADER 9 $ACADVER 1 AC1009 9 $INSUNITS 70 CODE 0 ENDSEC 0 SECTION 2 ENTITIES "
    )
    tags += "0 POLYLINE 8 0 66 1 70 8 10 0 20 0 30 0"
    lines = tags.replace("CODE", str(code)).split(" ")
    for x, y in ((0, 60), (20, 40), (70, 5), (100, 0)):
        place = (x, 0, y) if upright else (x, y, 0)
        lines += ["0", "VERTEX", "8", "0", "70", "32"]
        for number, value in zip((10, 20, 30), place):
            lines += [str(number), repr(value / scale)]
    file.write_text(
        "\n".join([*lines, *["0", "SEQEND", "8", "0", "0", "ENDSEC", "0", "EOF"]]) + "\n"
    )


@pytest.mark.parametrize(
    ("code", "metres"),
    [
        (1, 0.0254), (2, 0.3048), (4, 1e-3), (6, 1.0), (8, 2.54e-8), (9, 2.54e-5), (10, 0.9144),
        (21, 1200 / 3937), (22, 100 / 3937), (23, 3600 / 3937), (24, 1200 / 3937 * 5280),
    ],
)  # fmt: skip
def test_a_drawing_is_read_in_every_unit_that_dxf_has(site, tmp_path, code, metres):
    pytest.importorskip("ezdxf")
    file = site(file="profile.dxf")
    drawing(tmp_path / "profile.dxf", code, metres)
    found = [(node.x, node.y) for node in prepare(file).nodes]
    np.testing.assert_allclose(found, [(0, 60), (20, 40), (70, 5), (100, 0)], atol=1e-9)
    assert UNITS[code] == pytest.approx(metres, rel=1e-12)


@pytest.mark.parametrize("code", [25, 99, -1, "x", "1e9"])
def test_a_drawing_in_a_unit_that_there_is_not_is_refused(rockshed, site, tmp_path, code):
    pytest.importorskip("ezdxf")
    site(file="profile.dxf")
    drawing(tmp_path / "profile.dxf", code, 1.0)
    result = rockshed("rockfall", "site.toml", "--no-figures")
    assert result.exit_code == 2, result.output
    assert "profile.dxf" in result.stderr
    assert "→" in result.stderr


def test_a_section_that_is_drawn_upright_in_space_has_its_heights_in_z(site, tmp_path):
    pytest.importorskip("ezdxf")
    file = site(file="profile.dxf")
    drawing(tmp_path / "profile.dxf", 6, 1.0, upright=True)
    assert [node.y for node in prepare(file).nodes] == [60, 40, 5, 0]


# ------------------------------------------------------------------ messages


@pytest.mark.parametrize(
    ("arguments", "place"),
    [
        (["--seed", 2**31], "--seed: must be less than or equal to 2147483647"),
        (["--trials", 10**10], "--trials: must be less than or equal to 2147483647"),
        (["--trials", 10**8], "--trials: the records of"),
    ],
)
def test_the_message_points_at_the_option_that_is_wrong(rockshed, site, arguments, place):
    site()
    result = rockshed("rockfall", "site.toml", *arguments)
    assert result.exit_code == 2
    assert place in result.stderr
    assert "site.toml" not in result.stderr


def test_options_of_blows_and_runs_are_pointed_at_too(rockshed):
    result = rockshed("pile", EXAMPLES / "spt.toml", "--blows", 10**6)
    assert "--blows: must be less than or equal to 1000" in result.stderr
    result = rockshed("run", EXAMPLES / "rigid_floor.toml", "--stop-time", "-1")
    assert "--stop-time: -1 s is not after start_time" in result.stderr
    result = rockshed("run", EXAMPLES / "rigid_floor.toml", "--stop-time", "nan")
    assert "'--stop-time': must be a finite number" in result.stderr


def test_a_profile_that_folds_back_is_told_without_what_follows_from_it(site):
    with pytest.raises(InputRefused) as refusal:
        prepare(site(profile="x,y\n0,60\n60,40\n15,30\n20,5\n"))
    (problem,) = refusal.value.problems
    assert problem.where.endswith("profile.csv, line 4, column 1")
    assert "folds back from x = 60 m to 15 m" in problem.what


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("start = { x = 1, velocity = [1, 2, 3] }", "start.velocity: has too many entries: 2 at most (given: [1, 2, 3])"),
        ("start = { x = 1, velocity = 3 }", "start.velocity: must be a list (given: 3)"),
        ('start = { x = "a" }', "start.x: must be a number, with a unit or in m (given: 'a')"),
        ("start = 1979-05-27", "start: must be a table (given: 1979-05-27)"),
        ("start = { x = true }", "start.x: must be a number (given: true)"),
    ],
)  # fmt: skip
def test_faults_of_the_form_are_told_in_our_words(site, line, words):
    file = site()
    file.write_text(file.read_text().replace("start = { x = 1 }", line))
    with pytest.raises(InputRefused) as refusal:
        prepare(file)
    assert words in [problem.what for problem in refusal.value.problems]


def test_no_fault_of_the_form_is_told_in_pydantics_words():
    from pydantic_core._pydantic_core import list_all_errors

    for error in list_all_errors():
        told = sentence(
            {"type": error["type"], "input": 1, "ctx": error.get("example_context", {})}
        )
        assert "nput should" not in told
        assert error["example_message_python"] != told
    with pytest.raises(InputRefused) as refusal:
        system_from({"name": 3, "components": [], "stop_time": "x", "exchange_step": -1, "a": 1})
    assert not any("nput should" in problem.what for problem in refusal.value.problems)


# ------------------------------------------------------------------ screens and pictures


@pytest.mark.parametrize("columns", [40, 60, 80, 100, 115, 160])
def test_no_digit_and_no_name_is_lost_on_a_narrow_screen(rockshed, monkeypatch, columns):
    whole = rockshed("rockfall", EXAMPLES / "slope.toml", "--trials", 50, "--no-figures").stdout
    monkeypatch.setenv("COLUMNS", str(columns))
    narrow = rockshed("rockfall", EXAMPLES / "slope.toml", "--trials", 50, "--no-figures").stdout
    assert "…" not in narrow
    cells = [cell for line in whole.splitlines() for cell in line.split("  ") if cell.strip()]
    tables = [cell.strip() for cell in cells if "trials in" not in cell]
    assert [cell for cell in tables if cell not in narrow] == []


def test_a_table_with_a_long_name_is_turned(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    name = "a.pos[front] " + "x" * 300 + "\x1b[2J\n"
    Screen().table(Table(("name", "unit", "value"), [(name, "m", "1.25")], right=("value",)))
    shown = capsys.readouterr().out
    assert "a.pos[front] " + "x" * 300 + r"\x1b[2J\n" in shown
    assert "unit m" in shown
    assert "value 1.25" in shown


@pytest.mark.parametrize("columns", [60, 80])
def test_names_are_broken_between_words_before_a_table_is_turned(capsys, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", str(columns))
    name = "peak deflection at midspan of the girder (mm)"
    table = Table(("figure", "step (s)", "value", "error"), right=("step (s)", "value", "error"))
    table.add(name, "0.00001", "0.007853123", "-0.0067 %")
    table.add("", "0.000005", "0.007853124", "+0.0067 %")
    Screen().table(table)
    shown = capsys.readouterr().out.splitlines()
    assert max(map(len, shown)) <= columns
    figures = " ".join(line.split("  ")[0] for line in shown[1:-1])
    assert " ".join(figures.split()) == name
    assert shown[1].split()[-4:] == ["0.00001", "0.007853123", "-0.0067", "%"]
    assert shown[-1].split() == ["0.000005", "0.007853124", "+0.0067", "%"]


def test_the_tables_of_a_study_of_exchange_steps_have_whole_names_on_80_columns(
    rockshed, monkeypatch
):
    monkeypatch.setenv("COLUMNS", "80")
    words = ("--levels", 3, "--stop-time", "0.5ms", "--no-figures", "-q", "--output-dir", "o")
    done = rockshed("converge", "lab-impact", *words)
    assert done.exit_code == 0, done.output
    assert "…" not in done.stdout
    shown = [line for line in done.stdout.splitlines() if ": " not in line]
    figures = [line for line in shown if line.startswith("peak midspan")]
    assert len(figures) == 2
    assert max(map(len, figures)) <= 80


def test_no_warning_of_a_library_is_on_the_screen(rockshed, site, tmp_path):
    """Neither for a level profile, nor for letters that the font of the pictures does not have."""
    file = site("平", profile="x,y\n0,0\n60,0\n")
    file.write_text(file.read_text().replace("road", "道"), encoding="utf-8")
    command = [sys.executable, "-m", "rockshed", "rockfall", "site.toml", "-q"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, encoding="utf-8")
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert (tmp_path / "results/平/figures/ends.png").is_file()


@pytest.mark.slow
def test_plot_draws_a_campaign_and_a_pile_as_they_were_drawn(rockshed, tmp_path):
    arguments = ("--trials", 300, "--output-dir", "o")
    assert rockshed("rockfall", EXAMPLES / "slope.toml", *arguments).exit_code == 0
    drawn = {file.name: file.read_bytes() for file in Path("o/figures").iterdir()}
    shutil.rmtree("o/figures")
    result = rockshed("plot", "o")
    assert result.exit_code == 0, result.output
    assert {file.name: file.read_bytes() for file in Path("o/figures").iterdir()} == drawn
    assert "o/figures/envelopes.png" in result.stdout
    assert (
        rockshed("pile", EXAMPLES / "pile.toml", "--no-figures", "--output-dir", "p").exit_code == 0
    )
    assert rockshed("plot", "p", "--output-dir", "q/r").exit_code == 0
    assert {file.name for file in Path("q/r").iterdir()} >= {"traces.png", "envelopes.png"}


def test_plot_of_a_damaged_campaign_says_what_is_damaged(rockshed):
    arguments = ("--trials", 20, "--no-figures", "--output-dir", "o")
    assert rockshed("rockfall", EXAMPLES / "slope.toml", *arguments).exit_code == 0
    for name in ("trials.parquet", "envelopes.parquet", "run.json"):
        content = Path("o", name).read_bytes()
        Path("o", name).write_bytes(content[: len(content) // 2])
        result = rockshed("plot", "o")
        assert result.exit_code == 2
        assert name in result.stderr
        Path("o", name).write_bytes(content)


def test_help_of_reproduce_names_every_paper(rockshed):
    text = rockshed("reproduce", "--help").stdout
    assert "uto1974" in text
    assert all(paper in text for paper in PAPERS)

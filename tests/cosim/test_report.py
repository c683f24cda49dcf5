"""Reports: what stands in them, of whatever has ended however, and that nobody's text is code."""

import base64
import gzip
import json
import re
import shutil
from html import unescape

import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.commands.app import app
from rockshed.commands.report import repeating
from rockshed.reports import step_halving
from rockshed.reports.of_run import report_of_run, status_of
from rockshed.reports.page import page

HOSTILE = "</script><script>document.title='owned'</script><img src=x onerror=alert(1)> & \"'"


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A short run in this process, with some states of its sand."""
    system = rockshed.case("lab-impact", in_process=True, stop_time=0.004)
    return rockshed.simulate(system, tmp_path_factory.mktemp("report") / "run")


@pytest.fixture(scope="module")
def text(run):
    """The page of the run."""
    return page(report_of_run(run, None))


@pytest.fixture
def copy(run, tmp_path):
    """A copy of the run that a test may spoil."""
    shutil.copytree(run.folder, tmp_path / "copy")
    return tmp_path / "copy"


def change(folder, **facts):
    """Write other facts into the provenance of a run."""
    file = folder / "run.json"
    file.write_text(json.dumps({**json.loads(file.read_text()), **facts}))


def data_of(text):
    """Return the data that the script of a page reads."""
    packed = re.search(r'<script type="text/plain" id="data">([^<]*)</script>', text)[1]
    return json.loads(gzip.decompress(base64.b64decode(packed)))


def test_a_page_has_results_inputs_assumptions_origin_and_the_way_to_repeat_it(run, text):
    shown = unescape(text)
    titles = re.findall(r"<(?:h2|summary)>([^<]*)<", text)
    expected = [
        "Results",
        "Formulas of practice",
        "Figures",
        "System",
        "Inputs",
        "All parameters",
        "Assumptions",
        "What the rows mean",
    ]
    assert [t for t in titles if t != "Warnings"] == [
        *expected,
        "Check by halved steps",
        "Origin",
        "How to repeat it",
    ]
    assert "peak transmitted force" in shown
    assert "energy residual / E0" in shown
    assert "calibrated sand: rotation locked" in shown
    assert "fictitious modulus of the sand" in shown or "fictitious modulus" in shown
    assert run.provenance["versions"]["numba"] in shown
    assert "sand.seed" in shown
    assert "rockshed.case('lab-impact', in_process=True, stop_time=0.004)" in shown


def test_a_page_loads_nothing(text):
    """Scripts are allowed by their digests alone; no address is loaded or linked to but its own."""
    policy = unescape(re.search(r'Security-Policy" content="([^"]*)"', text)[1])
    assert policy.startswith("default-src 'none'")
    assert "unsafe-eval" not in policy
    assert re.search(r"script-src( 'sha256-[\w+/=]{44}'){2};", policy)
    assert not re.search(r"<(link|iframe|object|embed|base)\b|@import|url\(", text)
    addresses = re.findall(r'\b(?:src|href)="([^"]*)"', text)
    assert addresses
    assert all(
        a.startswith(("#", "data:image/png;base64,", "data:image/svg+xml;base64,"))
        for a in addresses
    )


def test_charts_and_states_of_a_page_are_those_of_the_run(run, text):
    data = data_of(text)
    labels = [chart["layout"]["yaxis"]["title"]["text"] for chart in data["charts"]]
    assert {"force (kN)", "penetration (cm)", "energy (J)"} <= set(labels)
    assert "bending moment (kN m)" in labels
    assert "deflection (mm)" in labels
    forces = data["charts"][labels.index("force (kN)")]["data"]
    (film,) = data["films"]
    assert film["frames"] == len(list(run.states("sand")))
    assert film["discs"] == 370
    assert film["beam"] == 24
    assert forces[0]["meta"] == "transmitted to the base"


def test_names_and_texts_of_a_result_are_text(copy):
    change(copy, name=HOSTILE, warnings=[HOSTILE], differences={HOSTILE: HOSTILE})
    change(
        copy,
        status="failed",
        error=HOSTILE,
        platform=HOSTILE,
        project={"content": HOSTILE, "file": HOSTILE},
    )
    text = page(report_of_run(rockshed.read_run(copy), None, HOSTILE, HOSTILE))
    assert text.count("<script") == 3
    assert "<img src=x" not in text
    assert "document.title=&#39;owned&#39;" in text


def test_a_curve_that_is_named_like_code_is_escaped_in_the_data_too(copy):
    facts = json.loads((copy / "run.json").read_text())
    for picture in facts["components"]["beam"]["pictures"]:
        for panel in picture["panels"]:
            panel["label"] = HOSTILE
    change(copy, components=facts["components"])
    data = data_of(page(report_of_run(rockshed.read_run(copy), None)))
    labels = [chart["layout"]["yaxis"]["title"]["text"] for chart in data["charts"]]
    assert any("&lt;img" in label for label in labels)
    assert not any("<" in label for label in labels)


@pytest.mark.parametrize(
    ("status", "said"),
    [("failed", "This run failed"), ("interrupted", "interrupted"), ("running", "or was killed")],
)
def test_a_run_that_is_not_complete_is_said_not_to_be(copy, status, said):
    change(copy, status=status, error="sand at t = 0.004 s: broken")
    assert said in status_of(rockshed.read_run(copy))


def test_a_page_of_a_run_that_failed_says_so_first(copy):
    change(copy, status="failed", error="sand at t = 0.004 s: broken")
    (file,) = rockshed.report(copy)
    shown = file.read_text()
    assert re.search(r'<p class="status" role="alert">This run failed[^<]*: broken', shown)
    assert shown.index('role="alert"') < shown.index("<nav>")
    assert "The run is not complete, and was not made again" in shown


def test_warnings_stand_before_results(copy):
    change(copy, warnings=["the sand was not at rest"])
    shown = page(report_of_run(rockshed.read_run(copy), None))
    assert shown.index("the sand was not at rest") < shown.index("<h2>Results</h2>")


def test_formulas_design_and_project_of_a_run_are_shown(copy):
    estimate = {"name": "handbook", "quantity": "peak force on the rock", "value": 1.945e6}
    estimate |= {"unit": "N", "source": "Japan Road Association", "verified": False}
    change(
        copy,
        formulas=[{**estimate, "within_range": True, "remark": ""}],
        project={
            "file": "my.toml",
            "content": {"rock": {"mass": "2.5 t"}},
            "derived": {"n": {"m": 3}},
        },
        design={
            "rock": {"mass": 2500.0, "drop_height": 25.0},
            "cushion": {"thickness": 1.2, "effective_width": 2.4, "rule": "spread"},
            "roof": {"section": "H-400x400x13x21"},
            "criteria": [{"name": "stress", "limit": 235e6, "unit": "Pa"}],
        },
    )
    shown = unescape(page(report_of_run(rockshed.read_run(copy), None)))
    assert "lab-impact: 2.5 t from 25 m on 1.2 m of sand over H-400x400x13x21" in shown
    assert ">1945<" in shown
    assert "source not verified" in shown
    assert 'mass = "2.5 t"' in shown
    assert "2.4 m, by the rule spread" in shown
    assert ">n: m<" in shown


def test_a_report_is_a_file_of_the_run_and_spares_files_of_the_user(copy):
    first = rockshed.report(copy, check=False)
    assert rockshed.report(copy, check=False) == first == [copy / "report.html"]
    assert "report.html" in json.loads((copy / "run.json").read_text())["rockshed_files"]
    mine = copy.parent / "mine.html"
    mine.write_text("<p>mine</p>")
    with pytest.raises(rockshed.InputRefused, match="is no report of this program"):
        rockshed.report(copy, mine, check=False)
    with pytest.raises(rockshed.InputRefused, match="neither a page nor a PDF"):
        rockshed.report(copy, copy / "report.docx", check=False)


def test_the_check_by_halved_steps_is_kept_with_the_run(run):
    """Half of the steps gives nearly the same forces; the second report does not compute again."""
    made = step_halving.step_halving(run)
    assert made.steps == {"exchange": 5e-6, "sand": 5e-6, "rock": 5e-6, "beam": 5e-7}
    assert 0.0 < made.largest < 0.2
    assert step_halving.kept(run) == made
    assert "peak transmitted force" in [row["quantity"] for row in made.table]


def test_a_run_of_no_request_is_not_made_again(copy):
    change(copy, request=None)
    (copy / "step_halving.json").unlink(missing_ok=True)
    (file,) = rockshed.report(copy)
    assert "made of no case and no file" in file.read_text()
    with pytest.raises(rockshed.InputRefused, match="made of no case and no file"):
        rockshed.report(copy, check=True)


def test_the_command_repeats_what_was_asked_for():
    request = {
        "target": "girders-10",
        "model": "one-law",
        "values": {"sand.seed": 2},
        "options": {"stop_time": 0.1},
        "in_process": True,
    }
    assert repeating(request) == (
        "rockshed run girders-10 --model one-law --set sand.seed=2 --stop-time 0.1 --in-process"
    )


@pytest.mark.slow
def test_a_pdf_is_written_beside_the_page(copy):
    done = CliRunner().invoke(app, ["report", str(copy), "--pdf", "--no-check"])
    assert done.exit_code == 0, done.output
    content = (copy / "report.pdf").read_bytes()
    assert content.startswith(b"%PDF")
    assert (copy / "report.html").is_file()
    assert CliRunner().invoke(app, ["report", str(copy), "--pdf", "--no-check"]).exit_code == 0


@pytest.mark.slow
def test_campaigns_and_piles_have_reports_too(tmp_path):
    site = rockshed.__path__[0] + "/examples/pile.toml"
    folder = rockshed.pile(site).save(tmp_path / "pile")
    files = rockshed.report(folder, pdf=True)
    assert [file.name for file in files] == ["report.html", "report.pdf"]
    shown = files[0].read_text()
    assert shown.count("<img") >= 1
    assert "<h2>Results</h2>" in shown

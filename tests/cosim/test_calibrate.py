"""``rockshed calibrate`` through the FMUs, in processes of their own: a spring constant that the default sand has."""

import json

import pytest
from typer.testing import CliRunner

from components.units import cm, kgf
from orchestrator.cli import app


def test_test_4_has_its_modulus(tmp_path):
    """k / E_bar of the default sand is 1.53 (study `static`, mean over seeds): 39.1 kgf/cm at E_bar = 25.6 kgf/cm2."""
    folder = tmp_path / "out"
    result = CliRunner().invoke(app, ["calibrate", "--stiffness", "39.1 kgf/cm", "--seeds", "2", "--workers", "2", "--json",
                                      "--output-dir", str(folder)])
    assert result.exit_code == 0, result.output
    content = json.loads(result.stdout)
    found = content["calibrations"][0]["results"][0]
    assert found["e_bar"] / kgf * cm**2 == pytest.approx(39.1 / 1.53, rel=0.1)
    assert found["uncertainty"] < 0.12 * found["e_bar"]
    assert found["exponent"] == pytest.approx(1.0, abs=0.35)
    assert {file.name for file in folder.iterdir()} == {"calibration.json", "calibration.csv", "calibration.png"}
    assert (folder / "calibration.png").read_bytes().startswith(b"\x89PNG")

"""``rockshed calibrate`` through the FMUs, in processes of their own."""

import json

import pytest
from typer.testing import CliRunner

from rockshed.commands.app import app
from rockshed.components.common.units import cm, kgf
from rockshed.core.results.reading import read_run
from rockshed.metrics.load_curve import load_curve


def rockshed(*arguments):
    result = CliRunner().invoke(app, [str(argument) for argument in arguments])
    assert result.exit_code == 0, result.output
    return result


def test_a_curve_of_the_sand_itself_gives_its_modulus_back(tmp_path):
    """Another sample of the sand, pushed 1 cm deep with E_bar = 45 kgf/cm2, is measured; until then samples hardly differ."""
    rockshed(
        "run",
        "static-test",
        "--set",
        f"sand.modulus={45 * kgf / cm**2}",
        "--set",
        "sand.lattice_shift=0.001",
        "--set",
        "sand.seed=99",
        "--stop-time",
        "1.1",
        "--no-figures",
        "--output-dir",
        tmp_path / "run",
    )
    curve = load_curve(read_run(tmp_path / "run").series, "sand")
    rows = [
        f"{1000 * depth:.4f},{float(curve.at(depth)) / 1000:.6f}"
        for depth in (0.002, 0.004, 0.006, 0.008, 0.01)
    ]
    (tmp_path / "measured.csv").write_text("\n".join(["penetration (mm),load (kN)", *rows]))
    out = tmp_path / "out"
    content = json.loads(
        rockshed(
            "calibrate",
            tmp_path / "measured.csv",
            "--seeds",
            "2",
            "--workers",
            "1",
            "--json",
            "--output-dir",
            out,
        ).stdout
    )
    found = content["calibrations"][0]["results"][0]
    assert found["e_bar"] / kgf * cm**2 == pytest.approx(45.0, rel=0.05)
    assert abs(found["e_bar"] / kgf * cm**2 - 45.0) < 4.0 * found["uncertainty"] / kgf * cm**2 + 0.5
    assert found["exponent"] == pytest.approx(1.0, abs=0.2)
    assert found["error_of_the_curve"] < 0.1
    assert {file.name for file in out.iterdir()} == {
        "calibration.json",
        "calibration.csv",
        "curve.csv",
        "calibration.png",
    }
    assert (out / "calibration.png").read_bytes().startswith(b"\x89PNG")

"""The package works with its lowest declared versions, with the newest Python, and without rights."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import pytest

from tests.house.sources import ROOT, copied_sources

SMOKE = """
import sys, tempfile
from pathlib import Path
import rockshed
from rockshed.commands.app import app
from typer.testing import CliRunner

with tempfile.TemporaryDirectory() as folder:
    fmu = rockshed.build_fmu("FallingRock", folder=folder)
    fall = rockshed.System.new("fall", exchange_step=1e-3, stop_time=0.1)
    run = rockshed.simulate(fall.add("rock", fmu, {"velocity0.y": -1.0}))
    assert round(float(run["rock.velocity.y"][-1]), 6) == -1.980665
    run.plot("rock.velocity.y").savefig(f"{folder}/plot.png")
    assert Path(f"{folder}/plot.png").stat().st_size > 1000
    slope = Path(rockshed.__file__).parent / "examples" / "slope.toml"
    assert len(rockshed.rockfall(slope, trials=20).records.outcomes) == 20
    for words in (["list"], ["info", str(fmu)], ["doctor"], ["run", "--help"]):
        done = CliRunner().invoke(app, words)
        assert done.exit_code == 0, done.output
print("works with Python", sys.version.split()[0])
"""
LIMIT = 900
"""Time (s) that an environment and its program may take."""


def lowest():
    """Return the lowest declared versions as constraints."""
    with (ROOT / "pyproject.toml").open("rb") as file:
        declared = tomllib.load(file)["project"]["dependencies"]
    bounds = [re.match(r"([\w-]+)>=([\w.]+)", text) for text in declared]
    return [f"{found[1]}=={found[2]}" for found in bounds if found]


def newest_python():
    """Return an interpreter newer than this one, the newest there is."""
    places = [*map(Path, os.environ.get("PATH", "").split(os.pathsep))]
    places += (Path.home() / ".pyenv" / "versions").glob("*/bin")
    for minor in range(14, sys.version_info.minor, -1):
        for place in places:
            python = place / f"python3.{minor}"
            works = python.is_file() and "shims" not in place.parts
            if works and not subprocess.run([python, "-c", ""], check=False).returncode:
                return str(python)
    return pytest.skip("there is no Python newer than this one")


def environment(python, folder, constraints=()):
    """Make an environment with the package and what it depends on."""
    subprocess.run([python, "-m", "venv", folder / "venv"], check=True, timeout=LIMIT)
    (folder / "constraints.txt").write_text("\n".join(constraints))
    pip = [folder / "venv" / "bin" / "pip", "install", "-q", "--prefer-binary"]
    (folder / "sources").mkdir()
    words = ["-c", folder / "constraints.txt", str(copied_sources(folder / "sources"))]
    done = subprocess.run([*pip, *words], capture_output=True, text=True, timeout=LIMIT)
    if "connection broken" in done.stderr.lower() or "no matching distribution" in done.stderr:
        pytest.skip(f"packages cannot be had: {done.stderr.strip().splitlines()[-1]}")
    assert done.returncode == 0, done.stderr
    return folder / "venv" / "bin" / "python"


def smoke(command, folder, **variables):
    """Run the program in an empty folder, with caches of its own."""
    own = {name: str(folder / name) for name in ("XDG_CACHE_HOME", "XDG_DATA_HOME")}
    env = os.environ | {"MPLBACKEND": "agg", "TMPDIR": str(folder)} | own | variables
    program = [*map(str, command), "-c", SMOKE]
    done = subprocess.run(
        program, cwd=folder, env=env, capture_output=True, text=True, timeout=LIMIT
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="knows environments of POSIX systems")
def test_the_lowest_declared_versions_work(tmp_path):
    python = environment(sys.executable, tmp_path, lowest())
    shown = subprocess.run([python, "-m", "pip", "freeze"], capture_output=True, text=True).stdout
    installed = {line.lower().replace("_", "-") for line in shown.splitlines()}
    for bound in lowest():
        name, version = bound.lower().replace("_", "-").split("==")
        assert any(re.fullmatch(rf"{name}=={version}(\.0)*", line) for line in installed), bound
    assert "works with Python" in smoke([python], tmp_path)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="knows environments of POSIX systems")
def test_the_newest_python_works(tmp_path):
    newest = newest_python()
    shown = smoke([environment(newest, tmp_path)], tmp_path)
    assert f"works with Python 3.{newest.rpartition('.')[2]}" in shown


@pytest.mark.slow
@pytest.mark.skipif(
    not shutil.which("setpriv") or getattr(os, "geteuid", lambda: 1)() != 0,
    reason="only root can run it as somebody else (setpriv)",
)
def test_somebody_without_rights_and_without_a_home_can_work(tmp_path):
    place = Path(tempfile.mkdtemp(prefix="nobody-", dir="/tmp"))  # one that others can enter
    try:
        os.chown(place, 65534, 65534)
        as_nobody = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]
        readable = subprocess.run(
            [*as_nobody, sys.executable, "-c", "import rockshed"], cwd=place, capture_output=True
        )
        if readable.returncode:
            pytest.skip("another user cannot read this Python or this checkout")
        assert "works" in smoke([*as_nobody, sys.executable], place, HOME="/nonexistent")
    finally:
        shutil.rmtree(place)

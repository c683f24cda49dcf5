"""The wheel in an environment of its own: what it installs, and that nothing is written there."""

import os
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path
from zipfile import ZipFile

import pytest

from tests.house.sources import FOLDERS, ROOT, copied_sources

SCRIPT = ROOT / "docs" / "examples" / "sweep.py"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """Return the wheel, built from a copy of the sources."""
    sources = copied_sources(tmp_path_factory.mktemp("sources"))
    place = tmp_path_factory.mktemp("wheel")
    pip("wheel", "--no-deps", "--no-build-isolation", "-w", str(place), str(sources))
    (built,) = place.glob("rockshed-*.whl")
    return built


@pytest.fixture(scope="module")
def environment(wheel, tmp_path_factory):
    """Return an environment with the wheel alone; its dependencies are those of this Python."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder, with_pip=False)
    packages = site_packages(folder)
    pip(f"--python={folder}", "install", "--no-deps", "--no-index", str(wheel))
    dependencies = [place for place in sys.path if place.endswith("site-packages")]
    (packages / "dependencies.pth").write_text("\n".join(dependencies) + "\n")
    yield folder
    make_writable(packages / "rockshed", True)


def pip(*arguments):
    """Run pip without a look at the network."""
    subprocess.run([sys.executable, "-m", "pip", "-q", *arguments], check=True)


def site_packages(environment):
    """Return the folder of the packages of an environment."""
    return Path(sysconfig.get_path("purelib", "venv", vars={"base": str(environment)}))


def python(environment):
    """Return the interpreter of an environment."""
    return next((environment / "bin").glob("python"), environment / "Scripts" / "python.exe")


def make_writable(folder, writable):
    """Let a folder and all below be written, or not."""
    for path in (folder, *folder.rglob("*")):
        mode = 0o755 if path.is_dir() else 0o644
        path.chmod(mode if writable else mode & 0o555)


def contents(folder):
    """Return time of change and size of every file and folder below a folder."""
    return {
        path: (path.stat().st_mtime_ns, path.stat().st_size)
        for path in (folder, *folder.rglob("*"))
    }


@pytest.mark.parametrize("folder", FOLDERS)
def test_the_wheel_has_every_file_of_the_repository_that_is_no_picture_of_the_documentation(
    wheel, folder
):
    package = "rockshed" if folder == "orchestrator" else f"rockshed/{folder}"
    tracked = subprocess.run(
        ["git", "ls-files", folder], cwd=ROOT, capture_output=True, text=True, check=True
    )
    if not tracked.stdout:
        pytest.skip("no checkout")
    wanted = {
        package + name.removeprefix(folder)
        for name in tracked.stdout.split()
        if (ROOT / name).is_file()
    }
    with ZipFile(wheel) as file:
        assert wanted <= set(file.namelist())


def test_site_packages_contains_rockshed_and_nothing_else_of_ours(environment):
    names = {path.name for path in site_packages(environment).iterdir()}
    assert "rockshed" in names
    ours = {name for name in names if not name.endswith((".dist-info", ".pth"))}
    assert ours == {"rockshed"}
    assert (site_packages(environment) / "rockshed" / "py.typed").is_file()


@pytest.mark.slow
def test_the_script_of_the_documentation_runs_and_writes_nothing_beside_the_code(
    environment, tmp_path
):
    make_writable(site_packages(environment) / "rockshed", False)
    before = contents(site_packages(environment))
    home = {"XDG_DATA_HOME": str(tmp_path / "data"), "MPLBACKEND": "agg"}
    lines = SCRIPT.read_text().splitlines()
    done = subprocess.run(
        [python(environment), str(SCRIPT)],
        cwd=tmp_path,
        env={**os.environ, **home},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert len(lines) <= 15
    assert (tmp_path / "sweep.png").stat().st_size > 10_000
    after = contents(site_packages(environment))
    assert {path: after[path] for path in after if after[path] != before.get(path)} == {}
    assert after.keys() == before.keys()

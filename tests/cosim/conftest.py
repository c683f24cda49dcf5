"""FMUs for the tests of the co-simulation core."""

import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def own_fmus(tmp_path_factory):
    """A folder of FMUs that no other process of the tests changes.

    Native FMUs that another one builds meanwhile would be taken from then on, and what was kept of
    Python's ones is not theirs.
    """
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv("ROCKSHED_FMU_DIR", str(tmp_path_factory.mktemp("fmus")))
        yield


@pytest.fixture(scope="session")
def foreign(tmp_path_factory):
    """A stranger's FMU: plain pythonfmu, built in a process of its own."""
    folder = tmp_path_factory.mktemp("foreign")
    subprocess.run(
        [
            sys.executable,
            "-m",
            "pythonfmu",
            "build",
            "-f",
            str(HERE / "stranger.py"),
            "-d",
            str(folder),
            "--handle-state",
            "--serialize-state",
        ],
        check=True,
        cwd=HERE,
    )
    return folder / "Stranger.fmu"


@pytest.fixture(scope="session")
def rock_fmu(tmp_path_factory):
    """The FMU of the falling rock."""
    from rockshed.fmus.build import build

    return build("FallingRock", destination=tmp_path_factory.mktemp("rock"))

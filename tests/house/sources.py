"""A copy of the sources, from which packages are built.

A build writes metadata beside the sources, where other tests would find them half written.
"""

from pathlib import Path
from shutil import copytree, ignore_patterns

ROOT = Path(__file__).parents[2]
_FILES = ("pyproject.toml", "setup.py", "README.md", "LICENSE")
FOLDERS = ("orchestrator", "components", "fmus")
_LEFT_OUT = ignore_patterns("dist", "__pycache__", "*.egg-info")


def copied_sources(folder):
    """Copy what a package is built from into a folder, and return the folder."""
    for name in _FILES:
        (folder / name).write_bytes((ROOT / name).read_bytes())
    for name in FOLDERS:
        copytree(ROOT / name, folder / name, ignore=_LEFT_OUT)
    return folder

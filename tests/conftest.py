"""Folders of the tests: FMUs that they build do not mix with those of the user."""

import os
from pathlib import Path

BUILT = Path(__file__).parents[1] / "build" / "fmus"

os.environ.setdefault("ROCKSHED_FMU_DIR", str(BUILT))

"""What holds for all tests: where FMUs are built, and which examples properties are tried with."""

import os
from pathlib import Path

from hypothesis import settings

BUILT = Path(__file__).parents[1] / "build" / "fmus"
"""FMUs that the tests build do not mix with those of the user."""

os.environ.setdefault("ROCKSHED_FMU_DIR", str(BUILT))

# The same examples in every run, so that a change is judged by what it changes;
# --hypothesis-profile search draws others
settings.register_profile("same", derandomize=True)
settings.register_profile("search", derandomize=False, print_blob=True)
settings.load_profile("same")

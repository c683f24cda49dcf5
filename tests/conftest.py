"""What holds for all tests: where FMUs are built, and which examples properties are tried with."""

import os
import signal
from pathlib import Path

from hypothesis import HealthCheck, settings

BUILT = Path(__file__).parents[1] / "build" / "fmus"
"""FMUs that the tests build do not mix with those of the user."""

os.environ.setdefault("ROCKSHED_FMU_DIR", str(BUILT))

# A shell lets what it starts in the background ignore Ctrl-C, and with it the commands that tests interrupt
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# The same examples in every run, so that a change is judged by what it changes;
# --hypothesis-profile search draws others. How fast the machine is decides nothing
UNTIMED = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("same", derandomize=True, **UNTIMED)
settings.register_profile("search", print_blob=True, **UNTIMED)
settings.load_profile("same")

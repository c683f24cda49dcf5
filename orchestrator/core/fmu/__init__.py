"""FMUs as the master takes them."""

import contextlib
import io

with contextlib.redirect_stdout(io.StringIO()):
    # prints where it has no logger proxy, on ARM under Linux; logger.py has one
    import fmpy.fmi1  # noqa: F401

"""The command ``rockshed doctor``: kept code, compilers, leftovers, and what is slow."""

from typing import Annotated

import typer

from ..runs import health
from ..temporary import sweep
from .options import RESULTS
from .screen import opened

_Clean = Annotated[
    bool,
    typer.Option(
        "--clean",
        help="Remove kept code, which is compiled anew when it is needed, and temporary folders of "
        "killed runs. Results stay, unfinished ones too.",
    ),
]


def command(clean: _Clean = False) -> None:
    """Look at kept code, compilers, leftovers of killed runs, and what is slow."""
    with opened() as screen:
        if clean:
            freed = health.clean(health.kept_files())
            swept = len(sweep())
            folders = "folder" if swept == 1 else "folders"
            screen.say(f"{freed / 1e6:.1f} MB of kept code and {swept} temporary {folders} removed")
            return
        left = health.leftover_table(RESULTS)
        for table in (health.place_table(), health.cache_table(), health.tool_table(), left):
            if len(table):
                screen.show(table, "")
        reasons = health.slow_reasons()
        for reason in reasons:
            screen.say(f"slow: {reason}")
        if not reasons:
            screen.say("nothing makes it slow")

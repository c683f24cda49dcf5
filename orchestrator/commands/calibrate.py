"""Find parameters from measurements, of a sand by default.

`rockshed calibrate CURVE.csv` is `rockshed calibrate sand CURVE.csv`.
"""

from typing import Any

from .lazy import LazyCommands

DEFAULT = "sand"
"""Subject of a call that names none."""
SUBJECTS = {
    "sand": "Find E_bar of a sand from a spring constant or a load-penetration curve.",
    "rockfall": "Infer the ground of a slope from where rocks came to rest; forecast another.",
    "pile": "Find the soil of a pile from force and velocity at its head.",
}
"""Subjects by name, each a module ``calibrate_NAME``, with the first line of its help."""


class Subjects(LazyCommands):
    """Commands for all subjects, those of :data:`SUBJECTS`."""

    known = SUBJECTS
    prefix = "calibrate_"

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put the default subject before words that begin with none."""
        begins = args and args[0] in {*SUBJECTS, *ctx.help_option_names}
        return super().parse_args(ctx, args if begins else [DEFAULT, *args])

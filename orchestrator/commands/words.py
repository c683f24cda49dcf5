"""Words of the command line for those of the library: options for arguments."""

import re

OPTIONS = {
    "values": "--set",
    "sizes": "--size",
    "folder": "--output-dir",
    "file": "--output",
    "metrics": "--metric",
    "probes": "--probe",
    "platforms": "--platform",
    "certificates": "--tls-ca, --tls-cert and --tls-key",
}
"""Options by the argument of the library, where the two have different names."""
SAME = frozenset(
    {
        "check",
        "checkpoint_every",
        "design",
        "fit",
        "fmi",
        "in_process",
        "output",
        "output_interval",
        "runtime",
        "samples",
        "scheduler",
        "seeds",
        "ssp",
        "state_interval",
        "stop_time",
    }
)
"""Arguments in messages of the library whose options have the same name, with hyphens."""
_ASSIGNED = re.compile(
    r"(?<![\w.'\"/=-])(\w+)=(?:\"([^\"]*)\"|(True|\.\.\.)|([\d.]+(?:e[+-]?\d+)?))"
)
"""An argument with its value, as the library writes them: ``runtime="native"``, ``folder=...``."""


def option(argument: str) -> str:
    """Return the option of an argument of the library.

    Examples
    --------
    >>> option("stop_time"), option("values")
    ('--stop-time', '--set')
    """
    return OPTIONS.get(argument, f"--{argument.replace('_', '-')}")


def in_options(text: str) -> str:
    """Write the arguments in a text of the library as options.

    Parameters
    ----------
    text : str
        With arguments as Python writes them: ``runtime="native"``, ``folder=...``.

    Returns
    -------
    str
        ``--runtime native``, ``--output-dir``; arguments that no command has stay.

    Examples
    --------
    >>> in_options('build it anew with sizes=..., or choose runtime="native"')
    'build it anew with --size, or choose --runtime native'
    """

    def written(found: re.Match[str]) -> str:
        argument, word, _, number = found.groups()
        if argument not in OPTIONS and argument not in SAME:
            return found[0]
        return " ".join(filter(None, (option(argument), word or number)))

    return _ASSIGNED.sub(written, text)

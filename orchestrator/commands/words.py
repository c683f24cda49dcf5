"""Words of the command line for those of the library: options for arguments."""

import re
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

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
        "at",
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
OF_RUN = frozenset(
    {
        "--checkpoint-every",
        "--in-process",
        "--output-interval",
        "--runtime",
        "--size",
        "--state-interval",
    }
)
"""Options of ``rockshed run`` that are named with it where the command itself has none of them."""
_HERE: ContextVar[Collection[str] | None] = ContextVar("options of the command", default=None)
_COMMAND_BEFORE = re.compile(r"`rockshed [^`]*`[^`]*$")
"""A text in which the command is named, before an argument."""
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


@contextmanager
def options_here(options: Collection[str]) -> Iterator[None]:
    """Tell the options of the command that is carried out.

    Parameters
    ----------
    options : collection of str
        ``--size`` and others.
    """
    before = _HERE.set(options)
    try:
        yield
    finally:
        _HERE.reset(before)


def in_options(text: str) -> str:
    """Write the arguments in a text of the library as options.

    One that the present command does not have is named with the command that has it.

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
        told = " ".join(filter(None, (option(argument), word or number)))
        here = _HERE.get()
        is_here = here is None or option(argument) in here
        if (
            is_here
            or option(argument) not in OF_RUN
            or _COMMAND_BEFORE.search(text[: found.start()])
        ):
            return told
        return f"`rockshed run {told}`"

    return _ASSIGNED.sub(written, text)

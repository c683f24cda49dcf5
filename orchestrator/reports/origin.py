"""Where a result comes from: FMUs, versions, seeds, machine, times, and how to repeat it."""

from collections.abc import Mapping
from typing import Any

from ..core.results.reading import StoredRun
from ..tables import Table
from .inputs import value_text


def fmus(run: StoredRun) -> Table:
    """Return component, model and SHA-256 of every FMU of a run.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    made = Table(("component", "model", "made by", "SHA-256 of the FMU"))
    for name, facts in run.provenance["components"].items():
        digest = str(facts.get("sha256", "none: it ran in the process, without an FMU"))
        made.add(name, str(facts.get("model", "")), str(facts.get("generation_tool", "")), digest)
    return made


def circumstances(run: StoredRun) -> Table:
    """Return versions, seeds, machine and times of a run.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    facts = run.provenance
    made = Table(("what", "value"))
    versions = facts.get("versions", {})
    for name, version in versions.items():
        made.add(str(name), str(version))
    for name, seed in seeds(facts).items():
        made.add(name, value_text(seed))
    for title, key in (("machine", "platform"), ("started", "started"), ("ended", "ended")):
        if facts.get(key):
            made.add(title, str(facts[key]))
    if "runtime" in facts:
        made.add("FMUs", f"{facts['runtime']} ({facts.get('runtime_reason', '')})")
    spent = facts.get("wall_time", {})
    for name, seconds in spent.items() if isinstance(spent, Mapping) else ():
        made.add(f"{name} took", f"{float(seconds):.3g} s")
    return made


def seeds(facts: Mapping[str, Any]) -> dict[str, Any]:
    """Return the seeds from which everything random in a run follows.

    Parameters
    ----------
    facts : mapping
        Provenance of the run.
    """
    return {
        f"{component}.{name}": entry["value"]
        for component, told in facts.get("components", {}).items()
        for name, entry in told.get("parameters", {}).items()
        if name.rpartition(".")[2] == "seed"
    }


def in_python(request: Mapping[str, Any]) -> str:
    """Return lines of Python that repeat a run.

    Parameters
    ----------
    request : mapping
        That of the run's provenance.
    """
    target = str(request.get("target", ""))
    is_file = target.lower().endswith(".toml")
    keys = ("values",) if is_file else ("values", "sizes", "model", "coupling", "load_cell")
    given = {key: request.get(key) for key in (*keys, "in_process") if request.get(key)}
    options = {**given, **dict(request.get("options") or {})}
    words = "".join(f", {name}={value!r}" for name, value in options.items())
    made = f"rockshed.case({target!r}{words})"
    if is_file:
        values = dict(options.pop("values", {}))
        made = f"rockshed.System.load({target!r})"
        made += f".with_values({values!r})" if values else ""
        changed = ", ".join(f"{name}={value!r}" for name, value in options.items())
        made += f".with_options({changed})" if changed else ""
    return f"import rockshed\n\nrun = rockshed.simulate({made})\n"

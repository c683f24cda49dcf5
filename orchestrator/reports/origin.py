"""Where a result comes from: FMUs, versions, seeds, machine, times, and how to repeat it."""

from collections.abc import Mapping
from typing import Any

from ..core.results.facts import number_of, table_of
from ..core.results.reading import StoredRun
from ..tables import Table, digits
from .inputs import value_text


def fmus(run: StoredRun) -> Table:
    """Return component, model and SHA-256 of every FMU of a run.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    made = Table(("component", "model", "SHA-256 of the FMU"))
    for name, facts in run.provenance["components"].items():
        digest = str(facts.get("sha256", "none: it ran in the process, without an FMU"))
        made.add(name, str(facts.get("model", "")), digest)
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
    for name, version in table_of(facts, "versions").items():
        made.add(str(name), str(version))
    for name, seed in seeds(facts).items():
        made.add(name, value_text(seed))
    for title, key in (("machine", "platform"), ("started", "started"), ("ended", "ended")):
        if facts.get(key):
            made.add(title, str(facts[key]))
    tools = [told.get("generation_tool") for told in facts["components"].values()]
    for tool in dict.fromkeys(filter(None, tools)):
        made.add("FMUs made by", str(tool))
    if "runtime" in facts:
        made.add("FMUs", f"{facts['runtime']} ({facts.get('runtime_reason', '')})")
    spent = table_of(facts, "wall_time")
    for name in spent:
        made.add(f"{name} took", f"{digits(number_of(spent, name) or 0.0)} s")
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


def in_python(request: Mapping[str, Any], is_project: bool = False) -> str:
    """Return lines of Python that repeat a run.

    Parameters
    ----------
    request : mapping
        That of the run's provenance.
    is_project : bool
        Whether it was made of a project.
    """
    target = request.get("project") or str(request.get("target", ""))
    keys = ("values", "sizes", "model", "coupling", "load_cell", "in_process")
    given = {key: request[key] for key in keys if request.get(key)}
    options = table_of(request, "options")
    if is_project:
        made = _call("rockshed.shed", target, {**given, **_named("options", options)})
    elif str(target).lower().endswith(".toml"):
        made = _call("rockshed.System.load", target, {})
        if given.get("values"):
            made += f".with_values({given['values']!r})"
        made += f".with_options(**{options!r})" if options else ""
    else:
        made = _call("rockshed.case", target, {**given, **options})
    return f"import rockshed\n\nrun = rockshed.simulate({made})\n"


def _named(name: str, entries: Mapping[str, Any]) -> dict[str, Any]:
    return {name: entries} if entries else {}


def _call(function: str, target: object, arguments: Mapping[str, Any]) -> str:
    words = "".join(f", {name}={value!r}" for name, value in arguments.items())
    return f"{function}({target!r}{words})"

"""The interface of FMI-LS-WASM for co-simulation, in WIT, the language of the component model.

It follows the draft at https://github.com/modelica/fmi-ls-wasm, commit ``c1aac17`` of 8 July 2026,
in what a host sees: names, types and their order. ``wasm-tools`` compares the module with it when a
component is made.
"""

from collections.abc import Iterator, Mapping

_VALUES = {
    "float32": "f32", "float64": "f64",
    "int8": "s8", "int16": "s16", "int32": "s32", "int64": "s64",
    "uint8": "u8", "uint16": "u16", "uint32": "u32", "uint64": "u64",
    "boolean": "bool", "string": "string", "binary": "list<u8>", "clock": "bool",
}  # fmt: skip
"""Types of WIT by those of FMI."""
_VARIABLES = {"value-references": "list<value-reference>"}
_DERIVATIVE = {
    "unknowns": "list<value-reference>",
    "knowns": "list<value-reference>",
    "seed": "list<f64>",
}
_REQUESTS = {"requests": "list<tuple<value-reference, u32>>"}

_TYPES = """\
interface types {
  type value-reference = u32;
  enum status { ok, warning, discard, error, fatal }
  enum interval-qualifier { interval-not-yet-known, interval-unchanged, interval-changed }
  enum dependency-kind { dependent, constant, fixed, tunable, discrete }
  type fmu-state = list<u8>;
  record interval-fraction { counter: u64, resolution: u64 }
  record variable-dependency {
    dependent-value-reference: value-reference,
    element-index-of-dependent: u32,
    independent-value-reference: value-reference,
    element-index-of-independent: u32,
    kind: dependency-kind,
  }
  record discrete-states-info {
    new-discrete-states-needed: bool,
    terminate-simulation: bool,
    nominals-of-continuous-states-changed: bool,
    values-of-continuous-states-changed: bool,
    next-event-time-defined: bool,
    next-event-time: f64,
  }
}
"""
_CALLBACKS = """\
interface callbacks {
  use types.{status};
  log-message: func(instance-name: string, status: status, category: string, message: string);
  clock-update: func();
  lock-preemption: func();
  unlock-preemption: func();
}

interface intermediate-update-callbacks {
  use types.{status};
  intermediate-update: func(
    intermediate-update-time: f64,
    intermediate-variable-set-requested: bool,
    intermediate-variable-get-allowed: bool,
    intermediate-step-finished: bool,
    can-return-early: bool,
  ) -> tuple<bool, f64>;
}

interface common {
  get-version: func() -> string;
}
"""
_STEP_RESULT = """\
  record do-step-result {
    last-successful-time: f64,
    event-handling-needed: bool,
    terminate-simulation: bool,
    early-return: bool,
  }
"""
_USED = (
    "value-reference", "status", "fmu-state", "interval-qualifier", "interval-fraction",
    "variable-dependency", "discrete-states-info",
)  # fmt: skip
_WORLD = """\
world co-simulation-fmu {
  import callbacks;
  import intermediate-update-callbacks;
  export common;
  export co-simulation;
}
"""
WORLD = "co-simulation-fmu"
"""Name of what a component for co-simulation is."""
PACKAGE = "fmi:fmi3@3.0.0"
"""Name and version of the interface."""

_INSTANCE = "co-simulation-instance"
_INSTANTIATION: Mapping[str, str] = {
    "instance-name": "string",
    "instantiation-token": "string",
    "resource-path": "string",
    "visible": "bool",
    "logging-on": "bool",
    "event-mode-used": "bool",
    "early-return-allowed": "bool",
    "required-intermediate-variables": "list<value-reference>",
}
_START = {"tolerance": "option<f64>", "start-time": "f64", "stop-time": "option<f64>"}
_STEP = {
    "current-communication-point": "f64",
    "communication-step-size": "f64",
    "no-set-fmu-state-prior-to-current-point": "bool",
}


def _methods() -> Iterator[tuple[str, Mapping[str, str], str]]:
    """Yield name, parameters and result of every method of an instance."""
    yield "set-debug-logging", {"logging-on": "bool", "categories": "list<string>"}, "status"
    yield "enter-initialization-mode", _START, "status"
    yield "exit-initialization-mode", {}, "status"
    yield "enter-event-mode", {}, "status"
    yield "update-discrete-states", {}, "result<discrete-states-info, status>"
    yield "terminate", {}, "status"
    yield "reset", {}, "status"
    yield "enter-configuration-mode", {}, "status"
    yield "exit-configuration-mode", {}, "status"
    for name, kind in _VALUES.items():
        yield f"get-{name}", _VARIABLES, f"result<list<{kind}>, status>"
    for name, kind in _VALUES.items():
        yield f"set-{name}", _VARIABLES | {"values": f"list<{kind}>"}, "status"
    yield "get-number-of-variable-dependencies", {"vr": "value-reference"}, "result<u64, status>"
    dependencies = "result<list<variable-dependency>, status>"
    yield "get-variable-dependencies", {"dependent": "value-reference"}, dependencies
    yield "get-fmu-state", {}, "result<fmu-state, status>"
    yield "set-fmu-state", {"state": "fmu-state"}, "status"
    yield "get-directional-derivative", _DERIVATIVE, "result<list<f64>, status>"
    yield "get-adjoint-derivative", _DERIVATIVE, "result<list<f64>, status>"
    yield from _clock_methods()
    yield "evaluate-discrete-states", {}, "status"
    yield "set-input-derivatives", _REQUESTS | {"values": "list<f64>"}, "status"
    yield "get-output-derivatives", _REQUESTS, "result<list<f64>, status>"
    yield "do-step", _STEP, "result<do-step-result, status>"
    yield "enter-step-mode", {}, "status"


def _clock_methods() -> Iterator[tuple[str, Mapping[str, str], str]]:
    forms = {"decimal": "f64", "fraction": "interval-fraction"}
    for form, kind in forms.items():
        known = f"tuple<{kind}, interval-qualifier>"
        yield f"get-interval-{form}", _VARIABLES, f"result<list<{known}>, status>"
    for form, kind in forms.items():
        yield f"get-shift-{form}", _VARIABLES, f"result<list<{kind}>, status>"
    for name in ("interval", "shift"):
        for form, kind in forms.items():
            yield f"set-{name}-{form}", _VARIABLES | {f"{name}s": f"list<{kind}>"}, "status"


def _function(parameters: Mapping[str, str], result: str, prefix: str = "") -> str:
    listed = ", ".join(f"{name}: {kind}" for name, kind in parameters.items())
    return f"{prefix}func({listed}) -> {result};"


def wit() -> str:
    """Return the interface in WIT: the world ``co-simulation-fmu`` and all that it names.

    Returns
    -------
    str
        Content of a file ``.wit``.
    """
    factory = _function(_INSTANTIATION, f"option<{_INSTANCE}>", "static ")
    methods = [f"{name}: {_function(given, result)}" for name, given, result in _methods()]
    body = "\n".join(f"    {line}" for line in (f"instantiate-co-simulation: {factory}", *methods))
    interface = (
        f"interface co-simulation {{\n  use types.{{{', '.join(_USED)}}};\n{_STEP_RESULT}"
        f"  resource {_INSTANCE} {{\n{body}\n  }}\n}}\n"
    )
    return "\n".join((f"package {PACKAGE};\n", _TYPES, _CALLBACKS, interface, _WORLD))

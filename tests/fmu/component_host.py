"""A host of FMI-LS-WASM on wasmtime, for tests: as host3.py, with the component for WebAssembly in the FMU."""

import re
import zipfile
from functools import cache
from pathlib import Path

from .host import ERROR, OK
from .host3 import Host3

INTERFACE = "fmi:fmi3/co-simulation@3.0.0"
STATUS = ("ok", "warning", "discard", "error", "fatal")


@cache
def compiled(content):
    import wasmtime
    from wasmtime import component

    engine = wasmtime.Engine()
    return engine, component.Component(engine, content)


class Instance:
    """An instance in a component, with the names and arguments of an instance of fmpy."""

    def __init__(self, content, log, memory=None):
        import wasmtime
        from wasmtime import component

        engine, self.component = compiled(content)
        self.store = wasmtime.Store(engine)
        if memory:
            self.store.set_limits(memory_size=memory)
        linker = component.Linker(engine)
        with linker.root() as root, root.add_instance("fmi:fmi3/callbacks@3.0.0") as callbacks:
            callbacks.add_func("log-message", log)
        with linker.root() as root:
            root.add_instance("fmi:fmi3/types@3.0.0").close()
        self._exports = linker.instantiate(self.store, self.component)
        self.status = OK

    def function(self, name, interface=INTERFACE):
        """Return a function of an interface."""
        place = self._exports.get_export_index(self.store, interface)
        found = self._exports.get_export_index(self.store, name, place)
        return self._exports.get_func(self.store, found)

    def instantiate(self, name, token, logging, early_return, **options):
        make = self.function("[static]co-simulation-instance.instantiate-co-simulation")
        events = options.get("eventModeUsed", False)
        intermediate = options.get("requiredIntermediateVariables", [])
        arguments = (name, token, "", False, logging, events, early_return, intermediate)
        self.handle = make(self.store, *arguments)
        make.post_return(self.store)
        return self.handle is not None

    def call(self, name, *arguments):
        """Return what a method gives, None where that is a status of an error; it is kept."""
        method = self.function(f"[method]co-simulation-instance.{name}")
        given = method(self.store, self.handle, *arguments)
        method.post_return(self.store)
        is_status = isinstance(given, str) and given in STATUS
        self.status = STATUS.index(given) if is_status else OK
        return None if self.status >= ERROR else given

    def __getattr__(self, name):
        """Return a method under its name in fmpy: getFloat64, enterEventMode."""
        if name.startswith("_"):
            raise AttributeError(name)
        words = re.sub(r"([A-Z]+)", r"-\1", name.replace("UI", "Ui").replace("FMUS", "FmuS"))
        return lambda *arguments: self.call(words.lower(), *arguments)

    def enterInitializationMode(self, startTime=0.0, stopTime=None, tolerance=None):
        return self.call("enter-initialization-mode", tolerance, startTime, stopTime)

    def getBoolean(self, references, count):
        return self.call("get-boolean", references)

    def setBoolean(self, references, values):
        return self.call("set-boolean", references, list(map(bool, values)))

    def getFloat64(self, references, count):
        return self.call("get-float64", references)

    def setFloat64(self, references, values):
        return self.call("set-float64", references, list(map(float, values)))

    def getInt32(self, references, count):
        return self.call("get-int32", references)

    def getInt64(self, references, count):
        return self.call("get-int64", references)

    def doStep(self, time, step):
        told = self.call("do-step", time, step, True)
        if told is None:
            return False, False, False, None
        return (
            getattr(told, "event-handling-needed"),
            getattr(told, "terminate-simulation"),
            getattr(told, "early-return"),
            getattr(told, "last-successful-time"),
        )

    def freeInstance(self):
        if self.handle is not None:
            self.handle.drop(self.store)


class ComponentHost(Host3):
    """An instance of the component for WebAssembly in an FMU of FMI 3.0."""

    def __init__(self, path, name="probe", token=None, logging=True, early_return=False, **options):
        from fmpy.model_description import read_model_description

        self.description = read_model_description(str(path))
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages, self.names, self.folder = [], set(), Path(path)
        Host3.last = self
        identifier = self.description.coSimulation.modelIdentifier
        with zipfile.ZipFile(path) as archive:
            content = archive.read(f"binaries/wasm32-wasip2/{identifier}.wasm")
        self.fmu = Instance(content, self._tell, options.pop("memory", None))
        token = token or self.description.guid
        self.made = self.fmu.instantiate(name, token, logging, early_return, **options)

    def _tell(self, _store, name, status, category, text):
        self.names.add(name)
        self.messages.append((STATUS.index(status), category, text))

    def __exit__(self, *_):
        self.fmu.freeInstance()

    def state(self):
        return bytes(self.fmu.call("get-fmu-state"))

    def restore(self, content):
        self.fmu.call("set-fmu-state", content)

"""A small FMI 2.0 host on fmpy, for tests: instances whose variables are reached by name and whose messages are kept."""

import shutil
import tempfile
from functools import wraps
from pathlib import Path

import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    calloc,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    free,
)
from fmpy.model_description import read_model_description

OK, WARNING, DISCARD, ERROR, FATAL = range(5)


class Tolerant:
    """A slave of fmpy of which no call raises an exception: the last bad status is kept in ``status``."""

    def __init__(self, slave):
        self.slave, self.status = slave, OK

    def __getattr__(self, name):
        found = getattr(self.slave, name)
        if not callable(found):
            return found

        @wraps(found)
        def call(*arguments, **options):
            try:
                return found(*arguments, **options)
            except FMICallException as error:
                self.status = error.status
                return None

        return call


class Host:
    """An instance of an FMU. ``messages``: (status, category, text). ``refusal``: status of a step that is refused."""

    def __init__(self, path, name="probe", folder=None, guid=None, logging=True):
        self.folder = Path(folder or tempfile.mkdtemp(prefix="host "))  # with a space
        if not (self.folder / "modelDescription.xml").exists():
            fmpy.extract(path, str(self.folder))
        self.description = read_model_description(str(self.folder))
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages = []
        Host.last = self  # reached also when the instance cannot be made
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = fmi2CallbackLoggerTYPE(
            lambda env, name, status, category, text: self.messages.append(
                (status, (category or b"").decode(), text.decode())
            )
        )
        self._callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        self._callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        slave = FMU2Slave(
            guid=guid or self.description.guid,
            unzipDirectory=str(self.folder),
            instanceName=name,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
        )
        slave.instantiate(callbacks=self._callbacks, loggingOn=logging)
        self.fmu = Tolerant(slave)
        self.is_native = not self.description.coSimulation.needsExecutionTool
        self.refusal = (
            ERROR if self.is_native else DISCARD
        )  # pythonfmu's binary cannot return an error

    def close(self, keep_folder=False):
        self.fmu.freeInstance()
        if not keep_folder:
            shutil.rmtree(self.folder, ignore_errors=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def start(self, time=0.0, stop=None, **values):
        """Through the initialization mode, with start values."""
        for name, value in values.items():
            self[name] = value
        self.fmu.setupExperiment(startTime=time, stopTime=stop)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def _calls(self, name, verb):
        kind = {"Enumeration": "Integer"}.get(self.variables[name].type, self.variables[name].type)
        return getattr(self.fmu, verb + kind), [self.variables[name].valueReference]

    def __getitem__(self, name):
        call, reference = self._calls(name, "get")
        return call(reference)[0]

    def __setitem__(self, name, value):
        call, reference = self._calls(name, "set")
        call(reference, [value])

    def step(self, time, step):
        """Status of fmi2DoStep."""
        return self.fmu.dll.fmi2DoStep(
            self.fmu.component, fmpy.fmi2.fmi2Real(time), fmpy.fmi2.fmi2Real(step), 1
        )

    def steps(self, count, step, first=0):
        """Make steps that must succeed."""
        for i in range(first, first + count):
            assert self.step(i * step, step) == OK, self.messages

    def outputs(self):
        """Names and exact values of everything that can be read."""
        return {name: self[name] for name in self.variables}

    def errors(self):
        return [text for status, _, text in self.messages if status >= ERROR]

    def state(self):
        """The complete state, serialized."""
        state = self.fmu.getFMUstate()
        content = bytes(self.fmu.serializeFMUstate(state))
        self.fmu.freeFMUstate(state)
        return content

    def restore(self, content):
        state = self.fmu.deSerializeFMUstate(content)
        if state is not None:
            self.fmu.setFMUstate(state)
            self.fmu.freeFMUstate(state)

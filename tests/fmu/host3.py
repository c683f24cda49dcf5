"""A small FMI 3.0 host on fmpy, for tests: as host.py, with variables under their names in FMI 2.0, or whole arrays."""

import contextlib
import ctypes
import shutil
import tempfile

import fmpy
import numpy as np
from fmpy.fmi3 import FMU3Slave, fmi3FMUState
from fmpy.model_description import read_model_description

from .host import ERROR, OK, Tolerant

CALLS = {"Float64": "Float64", "Int32": "Int32", "Boolean": "Boolean", "Enumeration": "Int64"}


class Host3:
    """An instance of an FMU of FMI 3.0. ``messages``: (status, category, text)."""

    def __init__(self, path, name="probe", token=None, logging=True, early_return=False, **options):
        self.folder = tempfile.mkdtemp(prefix="host ")
        fmpy.extract(path, self.folder)
        self.description = read_model_description(self.folder)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages = []
        Host3.last = self  # reached also when the instance cannot be made
        slave = FMU3Slave(
            guid=token or self.description.guid,
            unzipDirectory=self.folder,
            instanceName=name,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
        )
        slave.instantiate(
            loggingOn=logging, earlyReturnAllowed=early_return, logMessage=self._keep, **options
        )
        self.fmu = Tolerant(slave)

    def _keep(self, _environment, status, category, text):
        self.messages.append((status, (category or b"").decode(), text.decode()))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.fmu.freeInstance()
        with contextlib.suppress(OSError):
            shutil.rmtree(self.folder)

    def start(self, time=0.0, stop=None, **values):
        """Through the initialization mode, with start values."""
        for name, value in values.items():
            self[name] = value
        self.fmu.enterInitializationMode(startTime=time, stopTime=stop)
        self.fmu.exitInitializationMode()
        return self

    def length(self, name):
        """Number of elements of a variable."""
        return int(
            np.prod(
                [int(dimension.start) for dimension in self.variables[name].dimensions], initial=1
            )
        )

    def array(self, name):
        """All elements of a variable."""
        variable = self.variables[name]
        return getattr(self.fmu, f"get{CALLS[variable.type]}")(
            [variable.valueReference], self.length(name)
        )

    def set_array(self, name, values):
        """Set all elements of a variable."""
        variable = self.variables[name]
        getattr(self.fmu, f"set{CALLS[variable.type]}")([variable.valueReference], list(values))

    def __getitem__(self, name):
        """Value of a scalar, or of the element of an array that is written as in FMI 2.0."""
        whole, _, element = name.partition("[")
        return self.array(whole)[int(element.rstrip("]")) - 1 if element else 0]

    def __setitem__(self, name, value):
        whole, _, element = name.partition("[")
        values = self.array(whole)
        values[int(element.rstrip("]")) - 1 if element else 0] = value
        self.set_array(whole, values)

    def step(self, time, step):
        """Status of fmi3DoStep; what else it tells is in ``told``: event, end, early return, time."""
        self.fmu.status, self.told = OK, None
        self.told = self.fmu.doStep(time, step)
        return self.fmu.status

    def steps(self, count, step, first=0):
        """Make steps that must succeed."""
        for i in range(first, first + count):
            assert self.step(i * step, step) == OK, self.messages

    def outputs(self):
        """Exact values of everything that can be read but the time, by the names of FMI 2.0."""
        found = {}
        for name in self.variables:
            if name != "time":
                values = self.array(name)
                is_array = self.variables[name].dimensions
                found |= {
                    f"{name}[{i + 1}]" if is_array else name: value
                    for i, value in enumerate(values)
                }
        return found

    def errors(self):
        return [text for status, _, text in self.messages if status >= ERROR]

    def state(self):
        """The complete state, serialized."""
        state = self.fmu.getFMUState()
        content = bytes(self.fmu.serializeFMUState(state))
        self.fmu.freeFMUState(state)
        return content

    def restore(self, content):
        state = fmi3FMUState()
        if self.fmu.deserializeFMUState(content, state) is not None:
            self.fmu.setFMUState(state)
            self.fmu.freeFMUState(state)

    def call(self, name, *arguments):
        """Status of a function of the library, called with this instance past fmpy."""
        return getattr(self.fmu.dll, name)(ctypes.c_void_p(self.fmu.component), *arguments)

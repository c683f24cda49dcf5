"""What the slave stands on. When it is frozen into an FMU, these imports become relative: it then brings its own copies."""

from pythonfmu.enums import Fmi2Status
from pythonfmu.fmi2slave import Fmi2Slave

from components.component import OK, Component, ComponentError, Instance, value_problems
from components.ports import Causality, Kind, Variable

__all__ = ["OK", "Causality", "Component", "ComponentError", "Fmi2Slave", "Fmi2Status", "Instance", "Kind", "Variable",
           "value_problems"]

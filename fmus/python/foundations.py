"""Modules of others that the slave is made from. An FMU brings its own copies of them."""

from pythonfmu.enums import Fmi2Status
from pythonfmu.fmi2slave import Fmi2Slave

from rockshed.components.common.component import (
    IMPOSSIBLE_STATE,
    OK,
    Component,
    ComponentError,
    DeferredError,
    Instance,
    value_problems,
)
from rockshed.components.common.ports import Causality, Kind, Variable

__all__ = [
    "IMPOSSIBLE_STATE",
    "OK",
    "Causality",
    "Component",
    "ComponentError",
    "DeferredError",
    "Fmi2Slave",
    "Fmi2Status",
    "Instance",
    "Kind",
    "Variable",
    "value_problems",
]

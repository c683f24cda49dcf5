"""What the slave stands on. When it is frozen into an FMU, these imports become relative: it then brings its own copies.

PackageCache is imported for its module, which is needed later and may be gone then with the folder that an FMU was unpacked to.
"""

from pythonfmu.enums import Fmi2Status
from pythonfmu.fmi2slave import Fmi2Slave

from rockshed.components.common.component import (
    OK,
    Component,
    ComponentError,
    Instance,
    value_problems,
)
from rockshed.components.common.numba_bridge import PackageCache
from rockshed.components.common.ports import Causality, Kind, Variable

__all__ = [
    "OK",
    "Causality",
    "Component",
    "ComponentError",
    "Fmi2Slave",
    "Fmi2Status",
    "Instance",
    "Kind",
    "PackageCache",
    "Variable",
    "value_problems",
]

"""The script that pythonfmu's binary runs inside an FMU.

It finds the slave class, and mends what the binary leaves behind.
"""

from string import Template

SCRIPT = Template('''\
"""FMI slave $name. Generated: change the component it was frozen from, not this file.

pythonfmu's binary runs this text when it imports it, and once more for every instance, then with
another dictionary of locals. Each time it has put the resources folder first in sys.path, and it
gives back a reference to the globals that it does not own.
"""

import sys
from os.path import isfile, join

if locals() is globals():
    try:
        from $library.isolation import ForeignFoldersHidden, require_libraries
        require_libraries("$name")
        with ForeignFoldersHidden():
            import ctypes
            from importlib import import_module

            from $library.components.$package import COMPONENT
            from $library.slave import ComponentSlave

            import_module(COMPONENT.kernels)  # now: this folder may be gone when they are needed
    finally:
        sys.path[:] = [folder for folder in sys.path if not isfile(join(folder, __name__ + ".py"))]

    class $name(ComponentSlave):
        component = COMPONENT
        sizes = $sizes
else:
    sys.path[:] = [folder for folder in sys.path if not isfile(join(folder, __name__ + ".py"))]
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))
    $name = globals()["$name"]
''')

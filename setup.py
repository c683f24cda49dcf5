"""One package from three folders: ``rockshed`` is orchestrator/, with components/ and fmus/ as rooms of it."""

from setuptools import find_packages, setup

ROOMS = {"rockshed": "orchestrator", "rockshed.components": "components", "rockshed.fmus": "fmus"}

setup(
    package_dir=ROOMS,
    packages=[
        f"{room}{'.' if name else ''}{name}"
        for room, folder in ROOMS.items()
        for name in ("", *find_packages(folder))
    ],
)

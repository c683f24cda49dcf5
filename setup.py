"""Build one package from three folders of the repository.

``rockshed`` is the folder orchestrator/; components/ and fmus/ are subpackages of it.
"""

from setuptools import find_packages, setup

FOLDERS = {"rockshed": "orchestrator", "rockshed.components": "components", "rockshed.fmus": "fmus"}

setup(
    package_dir=FOLDERS,
    packages=[
        ".".join(filter(None, (package, name)))
        for package, folder in FOLDERS.items()
        for name in ("", *find_packages(folder))
    ],
)

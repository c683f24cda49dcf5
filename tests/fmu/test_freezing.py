"""Imports of sources on their way into an FMU with Python."""

import dataclasses
import shutil

import pytest

from rockshed.fmus.build import BuildError, build_component
from rockshed.fmus.python.freezing import foreign_imports, with_imports_moved


@pytest.mark.parametrize(
    ("before", "path", "after"),
    [
        (
            "from rockshed.components.common.ports import out",
            "components/buffer/declarations.py",
            "from ...components.common.ports import out",
        ),
        (
            "def f():\n    import math; from rockshed.components.common import units  # m",
            "components/buffer/deep/law.py",
            "def f():\n    import math; from ....components.common import units  # m",
        ),
        ("from pythonfmu.enums import A", "foundations.py", "from .pythonfmu.enums import A"),
        ("from .kernel import step", "components/buffer/x.py", "from .kernel import step"),
        ("from pythonfmus import A", "foundations.py", "from pythonfmus import A"),
        ("x = 'from pythonfmu import A'", "foundations.py", "x = 'from pythonfmu import A'"),
    ],
)
def test_imports_of_what_an_fmu_holds_become_relative(before, path, after):
    assert with_imports_moved(before.encode(), path) == after.encode()


@pytest.mark.parametrize(
    "line",
    [
        "import rockshed.components.common.ports",
        "from rockshed.metrics import names",
        "from rockshed.components.falling_rock import COMPONENT",
        "from ..falling_rock import COMPONENT",
        "from ... import slave",
    ],
)
def test_other_imports_of_this_library_are_foreign(line):
    assert [found.line for found in foreign_imports(line.encode(), "components/buffer/x.py")] == [1]


@pytest.mark.parametrize(
    "line",
    [
        "from rockshed.components.common.ports import out",
        "from ..common.ports import out",
        "from . import kernel",
        "from .deep.law import f",
        "import numpy as np",
    ],
)
def test_shared_modules_the_own_folder_and_libraries_are_not(line):
    assert foreign_imports(line.encode(), "components/buffer/x.py") == []


def test_a_foreign_import_is_refused_with_its_line(probe, tmp_path):
    folder = tmp_path / "probe"
    shutil.copytree(probe.folder, folder)
    (folder / "extra.py").write_text("import math\nfrom rockshed.metrics import names\n")
    with pytest.raises(BuildError, match=r"probe/extra.py, line 2, imports rockshed.metrics"):
        build_component(dataclasses.replace(probe, folder=folder), destination=tmp_path / "dist")
    assert not (tmp_path / "dist").exists()

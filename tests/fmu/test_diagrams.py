"""Diagrams inside FMUs show the ports as they are declared."""

from io import BytesIO

import pytest
from PIL import Image

from docs.diagrams import TEXT, draw, written
from rockshed.components.catalogue import NAMES, component
from rockshed.components.common.ports import Causality
from rockshed.fmus.build import fmu_files
from rockshed.fmus.description.documentation import DIAGRAM


@pytest.mark.parametrize("name", NAMES)
def test_the_diagram_in_an_fmu_says_what_is_declared(name):
    """Where it does not, ``python docs/diagrams.py`` draws it anew."""
    made = component(name)
    files = fmu_files(made, made.with_sizes())
    with Image.open(BytesIO(files[DIAGRAM])) as picture:
        assert picture.format == "PNG"
        assert picture.text[TEXT] == written(made)
    assert b'<img src="diagram.png"' in files["documentation/index.html"]
    inputs = [v for v in made.layout.variables if v.causality is Causality.INPUT]
    assert all(v.name in written(made) and v.unit in written(made) for v in inputs)


def test_the_same_declarations_give_the_same_diagram(tmp_path):
    made = component("FallingRock")
    for file in ("one.png", "other.png"):
        draw(made, tmp_path / file)
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "other.png").read_bytes()

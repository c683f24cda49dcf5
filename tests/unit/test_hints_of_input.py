"""Slips in a file are answered with the line as it should be."""

from pathlib import Path

import pytest

from rockshed.core.errors import InputRefused
from rockshed.core.input_text import toml_content
from rockshed.core.system.names import nearest


@pytest.mark.parametrize(
    ("line", "remedy"),
    [
        ("mass = 1,8 t", 'mass = "1.8 t"'),
        ("mass = 1.8 t  # heavy", 'mass = "1.8 t"'),
        ("angle = 15°", 'angle = "15 °"'),
        ("height = 1,8", "a number has a decimal point and no comma: height = 1.8"),
        ("height 1.8", "correct the file"),
    ],
)
def test_a_bare_value_that_is_no_toml_is_shown_as_it_is_written(line, remedy):
    with pytest.raises(InputRefused) as refused:
        toml_content(Path("shed.toml"), f"[rock]\n{line}\n")
    assert remedy in refused.value.problems[0].remedy


def test_of_many_names_the_nearest_are_offered_where_none_is_near():
    names = [f"beam.moment[{i}]" for i in range(100)] + ["sand.transmitted_force"]
    said = nearest("transmission", names)
    assert said.startswith("the nearest of 101 are sand.transmitted_force")


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        ("step = 1.0\nstep = 2.0", "step stands twice: keep one of them"),
        ("[a]\nx = 1\n[a]\ny = 2\n", "[a] stands twice: keep one of them"),
        ("a = {x = 1, x = 2}", "x stands twice: keep one of them"),
        ("mass = 1.2.3", "correct the file"),
    ],
)
def test_a_key_that_stands_twice_is_no_number_with_a_comma(text, remedy):
    with pytest.raises(InputRefused) as refused:
        toml_content(Path("shed.toml"), text)
    assert refused.value.problems[0].remedy == remedy

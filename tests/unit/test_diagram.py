"""The diagram of a system, measured with a font that this program does not ask for its widths."""

from functools import cache
from itertools import combinations
from xml.etree import ElementTree

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

from rockshed.cases.sonoda1993 import lab_system
from rockshed.cases.sonoda1993 import tests as laboratory_tests
from rockshed.core.system.reading import system_from
from rockshed.pictures.diagram import condensed, system_diagram

SVG = "{http://www.w3.org/2000/svg}"


def chain(number, name="part_{}", port="force.{}"):
    """Components that push their neighbours, and the last one the first; every third has a step of its own."""
    names = [name.format(i) for i in range(number)]
    return system_from(
        {
            "name": "chain",
            "components": {
                each: {"fmu": f"x/{each}.fmu", **({"step": 1e-4} if i % 3 == 0 else {})}
                for i, each in enumerate(names)
            },
            "connections": [
                f"{names[i]}.{port.format(axis)}[{k}] -> {names[(i + d) % number]}.u{axis}[{k}]"
                for i in range(number)
                for d in (1, number - 1)
                for axis in "xy"
                for k in (1, 2, 3)
            ],
            "bonds": {
                f"bond_{i}": {
                    "giver": names[i],
                    "force": ["f"],
                    "taker": names[i + 1],
                    "position": ["p"],
                }
                for i in range(number - 1)
            },
            "exchange_step": 1e-3,
            "stop_time": 1.0,
        }
    )


def laboratory():
    files = {name: f"{name}.fmu" for name in ("sand", "rock", "beam")}
    return lab_system(files, laboratory_tests()[4])


@cache
def letters(weight):
    """Advance of a letter of DejaVu Sans Mono, and how far letters reach below and above their line, in sizes."""
    font = FontProperties(family="DejaVu Sans Mono", weight=weight)
    one, two = (TextPath((0, 0), text, 100.0, prop=font).get_extents() for text in ("H", "HH"))
    tall = TextPath((0, 0), "Hgjpqy_[]|×…", 100.0, prop=font).get_extents()
    return (two.width - one.width) / 100.0, tall.y0 / 100.0, tall.y1 / 100.0


def extents(text):
    """Left, top, right and bottom of a text as DejaVu Sans Mono draws it."""
    size = float(text.get("font-size"))
    advance, lowest, highest = (size * n for n in letters(text.get("font-weight", "normal")))
    width = advance * len(text.text)
    x, y = float(text.get("x")), float(text.get("y"))
    left = x - 0.5 * width if text.get("text-anchor") == "middle" else x
    return left, y - highest, left + width, y - lowest


def overlap(one, other):
    return min(one[2], other[2]) > max(one[0], other[0]) and min(one[3], other[3]) > max(
        one[1], other[1]
    )


def rectangle(element):
    x, y, width, height = (float(element.get(key)) for key in ("x", "y", "width", "height"))
    return x, y, x + width, y + height


def inside(inner, outer):
    return (
        inner[0] >= outer[0]
        and inner[1] >= outer[1]
        and inner[2] <= outer[2]
        and inner[3] <= outer[3]
    )


def assert_legible(system, loops=()):
    root = ElementTree.fromstring(system_diagram(system, loops))
    whole = 0.0, 0.0, float(root.get("width")), float(root.get("height"))
    boxes = [
        (rectangle(group.find(f"{SVG}rect")), list(map(extents, group.findall(f"{SVG}text"))))
        for group in root.iter(f"{SVG}g")
    ]
    for frame, texts in boxes:
        assert inside(frame, whole)
        assert all(inside(text, frame) for text in texts)
    frames = [frame for frame, _ in boxes]
    assert not any(overlap(*pair) for pair in combinations(frames, 2))
    texts = [extents(text) for text in root.iter(f"{SVG}text")]
    assert all(inside(text, whole) for text in texts)
    free = [extents(text) for text in root.findall(f"{SVG}text")]
    assert not any(overlap(*pair) for pair in combinations([*frames, *free], 2))
    inner = [texts for _, texts in boxes]
    assert not any(overlap(*pair) for group in inner for pair in combinations(group, 2))
    return root, boxes


@pytest.mark.parametrize("system", [laboratory(), chain(12), chain(2)], ids=["3", "12", "2"])
def test_no_text_lies_on_another_one_or_leaves_its_box(system):
    root, boxes = assert_legible(system)
    assert len(boxes) > len(system.components)
    assert float(root.get("width")) < 130.0 * len(system.components) + 200.0


@settings(max_examples=10)
@given(st.integers(2, 8), st.integers(1, 60), st.integers(1, 60))
def test_however_long_names_are_they_stay_in_their_boxes(number, length, port):
    assert_legible(chain(number, "n" * length + "_{}", "p" * port + ".{}"))


def test_it_tells_turns_steps_bonds_and_what_goes_where():
    root, _ = assert_legible(laboratory())
    told = [text.text for text in root.iter(f"{SVG}text")]
    for expected in ("1 sand", "2 rock", "3 beam", "step 0.01 ms", "sand_rock", "rock.force.x .y"):
        assert expected in told
    titles = [title.text for title in root.iter(f"{SVG}title")]
    assert any("sand.rock.force.x -> rock.force.x" in title for title in titles)
    arrows = [path for path in root.iter(f"{SVG}path") if path.get("fill") != "none"]
    assert len(arrows) == 4  # to the sand from both, and back
    of_chain = ElementTree.fromstring(system_diagram(chain(12)))
    assert "10 an exchange" in [text.text for text in of_chain.iter(f"{SVG}text")]


LOOP = "part_0.force.x[1] -> part_1.ux[1] -> part_1.force.x[1] -> part_0.ux[1] -> part_0.force.x[1]"


@pytest.mark.parametrize(
    ("master", "told"), [("sequential", "a delay of an exchange"), ("implicit", "are iterated")]
)
def test_components_and_connections_of_an_algebraic_loop_are_dashed_and_in_the_legend(master, told):
    """Two components, and what each gives the other."""
    system = chain(4).model_copy(update={"master": master})
    root, _ = assert_legible(system, [LOOP])
    dashed = [r for r in root.iter(f"{SVG}rect") if r.get("stroke-dasharray")]
    assert len(dashed) == 4
    assert len([p for p in root.iter(f"{SVG}path") if p.get("stroke-dasharray")]) == 2
    legend = " ".join(text.text for text in root.findall(f"{SVG}text"))
    assert "algebraic loop" in legend
    assert told in legend
    plain, _ = assert_legible(system)
    assert not any(element.get("stroke-dasharray") for element in plain.iter())
    assert "algebraic loop" not in " ".join(text.text for text in plain.findall(f"{SVG}text"))


def test_names_of_ports_are_put_together():
    names = ["force.x", "force.y", *(f"angle[{i}]" for i in range(1, 25)), "level"]
    assert condensed((name, "") for name in names) == ["force.x .y", "angle[1..24], level"]
    assert condensed([("a.x", " ×2"), ("a.y", "")]) == ["a.x ×2", "a.y"]

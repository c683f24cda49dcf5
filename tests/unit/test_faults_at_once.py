"""Files of slopes and piles with a fault of every kind: all are told, in the order of the file."""

import pytest

from rockshed.core.errors import InputRefused
from rockshed.sites.pile.preparation import prepare as prepare_pile
from rockshed.sites.rockfall.preparation import prepare as prepare_slope

SLOPE = """
trials = -5
limit_speed = { mean = 10.0 }
[profile]
points = [[0.0, 50.0, "forst"], [10.0], [60.0, 0.0, "talus"]]
[rock]
radius = "0.5 kg"
mass = "500 kg"
density = 2600.0
[start]
x = 0.0
velocity = [1.0, 0.0]
[material.talus]
like = "talus slop"
[model]
gravty = 9.81
[[barrier]]
name = "fence"
x = 40.0
height = "3 kN"
[[line]]
name = "road"
"""
SLOPE_TOLD = {
    2: "trials: must be greater than",
    5: "there is no material 'forst'",
    7: "rock.radius",
    14: "there is no material 'talus slop'",
    16: "model.gravty: there is no such key",
    20: "barrier[1].height: must be a length",
    21: "a search line has two points, or an x",
}
PILE = """
blows = 2
gauge = 40.0
time = "5 kg"
[hammer]
mass = "4 t"
drop = -1.2
[[rod]]
length = 24.0
area = 0.016
modulus = "206 GPaa"
density = 7850.0
[[shaft]]
from = 14.0
to = 4.0
resistance = "250 kN"
[[shaft]]
from = 14.0
to = 44.0
resistance = "450 kN"
quke = 2.5e-3
[toe]
resistance = "800 mm"
"""
PILE_TOLD = {
    3: "the gauge at 40 m is below the toe",
    4: "time: must be a time, in s",
    7: "hammer.drop: must be greater than 0",
    11: "rod[1].modulus",
    13: "the layer goes from 14 m to 4 m",
    19: "44 m is below the toe, at 24 m",
    21: "shaft[2].quke: there is no such key",
    23: "toe.resistance: must be a force",
}


@pytest.mark.parametrize(
    ("prepare", "content", "expected"),
    [(prepare_slope, SLOPE, SLOPE_TOLD), (prepare_pile, PILE, PILE_TOLD)],
    ids=["slope", "pile"],
)
def test_a_fault_of_the_form_hides_no_other(tmp_path, prepare, content, expected):
    file = tmp_path / "site.toml"
    file.write_text(content, encoding="utf-8")
    with pytest.raises(InputRefused) as refused:
        prepare(file)
    told = [str(problem) for problem in refused.value.problems]
    places = [int(text.partition(", line ")[2].partition(",")[0]) for text in told]
    assert places == sorted(places)
    for line, words in expected.items():
        assert any(
            text.startswith(f"{file}, line {line}, column ") and words in text for text in told
        ), (words, told)

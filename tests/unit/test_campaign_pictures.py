"""Pictures and numbers of a campaign can be read: scale, legends, digits."""

from pathlib import Path

import pytest
from matplotlib.figure import Figure

import rockshed
from rockshed.analyses.rockfall import pictures
from rockshed.tables import digits

SLOPE = Path(rockshed.__file__).parent / "examples" / "slope.toml"


@pytest.fixture(scope="module")
def campaign():
    return rockshed.rockfall(SLOPE, trials=40)


@pytest.mark.parametrize("name", ["envelopes", "ends"])
def test_a_profile_is_to_scale_or_says_by_how_much_its_heights_are_larger(campaign, name):
    made: Figure = pictures.drawings(campaign)[name]()
    profile = made.axes[0]
    box = profile.get_window_extent()
    (left, right), (bottom, top) = profile.get_xlim(), profile.get_ylim()
    ratio = box.height / (top - bottom) * (right - left) / box.width
    texts = [text.get_text() for text in profile.texts]
    (said,) = [text for text in texts if text == "to scale" or "heights" in text]
    if said == "to scale":
        assert ratio == pytest.approx(1.0, rel=0.02)
    else:
        assert name == "ends"  # the envelopes of such a slope are to scale
        assert float(said.removeprefix("heights × ")) == pytest.approx(ratio, rel=0.06)


@pytest.mark.parametrize("name", ["envelopes", "ends"])
def test_legends_of_a_campaign_hide_neither_curves_nor_labels(campaign, name):
    made: Figure = pictures.drawings(campaign)[name]()
    made.draw_without_rendering()
    legends = [axes.get_legend() for axes in made.axes if axes.get_legend()]
    assert len(legends) == 2
    for legend in legends:
        box = legend.get_window_extent()
        assert not any(box.overlaps(axes.get_window_extent().padded(-1.0)) for axes in made.axes)
        assert box.x0 >= 0.0
        assert box.y1 <= made.bbox.height


def test_numbers_of_a_campaign_have_one_form(campaign):
    cells = [cell for table in campaign.tables() for row in table.rows for cell in row]
    assert len(cells) > 20
    assert not [cell for cell in cells if "e+" in cell]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1043.7, "1044"),
        (-1043.7, "-1044"),
        (123456.0, "123456"),
        (99.96, "100"),
        (12.345, "12.3"),
        (0.8, "0.8"),
        (0.012345, "0.0123"),
        (0.0, "0"),
        (-0.0, "0"),
        (1.5e-7, "1.5e-07"),
        (2e12, "2e+12"),
    ],
)
def test_a_number_is_written_with_three_digits_and_without_an_exponent(value, text):
    assert digits(value) == text

"""Smith's soil has two forms, for a node that takes steps and for a toe that moves piece by piece."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rockshed.components.common.smith_soil import (
    Soil,
    Spring,
    mean_resistance,
    mean_static,
    press,
    static,
    stored,
    stretched,
)

QUAKE, ULTIMATE = 2.5e-3, 20e3


@given(st.lists(st.integers(-3000, 3000), min_size=1, max_size=12))
def test_both_forms_have_the_same_resistance_and_work(ways):
    node = Soil(0.0, QUAKE, ULTIMATE, 0.0, False)
    toe = Spring(0.0, 0.0, ULTIMATE / QUAKE, ULTIMATE)
    for way in (1e-3 * QUAKE * way for way in ways):
        means = mean_static(node, way), mean_resistance(way, toe)
        assert means[0] == pytest.approx(means[1], abs=1e-9 * ULTIMATE)
        before = stored(node, node.stretch, node.stretch)
        resistance, slack, slid, area = press(way, toe)
        assert area == pytest.approx(means[0] * way, abs=1e-9 * ULTIMATE * QUAKE)
        node = node._replace(stretch=stretched(node, way))
        toe = toe._replace(resistance=resistance, slack=slack)
        assert static(node, node.stretch) == pytest.approx(resistance, abs=1e-9 * ULTIMATE)
        assert max(0.0, -node.stretch) == pytest.approx(slack, abs=1e-9 * QUAKE)
        gained = stored(node, node.stretch, node.stretch) - before
        assert area - gained == pytest.approx(ULTIMATE * slid, abs=1e-9 * ULTIMATE * QUAKE)

"""Section 2: what the paper says of its experiments, checked against its own tables 1 and 2. Nothing is computed by the FMUs."""

from collections.abc import Callable, Sequence

from ...cases import sonoda1993
from ...cases.sonoda1993 import Sand, Test
from ..statistics import exponent_error, power_law
from ..study import Outcomes, Row, Study, verdict

HARDLY = 10.0
"""Percent below which a difference counts as hardly any."""
ABOUT = 0.25
"""Part by which a mean may differ from a figure given with "about"."""
RISE = {"A": 7.0, "B": 19.0}
"""Percent by which compaction raises the peak force, as the text has it."""
STIFFEST = {"A": 4, "B": 10}
"""Tests with the largest k, as the text has it."""
POWER_LAW_ERRORS = 2.0
"""Standard errors by which an exponent has to differ from a value to count as different."""

Quantity = Callable[[Test], float]


def _k(test: Test) -> float:
    return test.static_stiffness


def _p(test: Test) -> float:
    return test.peak_force


def _chosen(sand: str = "AB", box: int = 1, compacted: bool | None = None) -> list[Test]:
    return [
        t
        for t in sonoda1993.tests().values()
        if t.sand in sand and t.box == box and compacted in (None, t.compaction > 0.0)
    ]


def rises(quantity: Quantity, sand: str, box: int = 1) -> dict[str, float]:
    """Percent by which compaction raises a quantity, for each pair of tests of one sand and water content."""
    pairs = [
        (loose, dense)
        for loose in _chosen(sand, box, False)
        for dense in _chosen(sand, box, True)
        if loose.water_content == dense.water_content
    ]
    return {
        f"{loose.number} to {dense.number}": _change(quantity, loose, dense)
        for loose, dense in pairs
    }


def _change(quantity: Quantity, before: Test, after: Test) -> float:
    return 100.0 * (quantity(after) / quantity(before) - 1.0)


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


def _listed(changes: dict[str, float]) -> str:
    return "tests " + ", ".join(f"{pair}: {value:+.1f} %" for pair, value in changes.items())


def _claim(
    text: str,
    holds: bool,
    note: str,
    unit: str = "",
    paper: float | None = None,
    experiment: float | None = None,
) -> Row:
    return Row(text, unit, paper, experiment, model="claim", verdict=verdict(holds), note=note)


def rows(found: Outcomes) -> list[Row]:
    """The claims in the order of the text."""
    return [*_sands(), *_compaction(), *_water(), *_box(), *_force_against_stiffness()]


def _sands() -> list[Row]:
    """Table 1: the printed coefficients follow from the diameters, and B has the wider grading."""
    sands = sonoda1993.sands()
    worst = max(
        abs(printed / value - 1.0) for s in sands.values() for printed, value in _coefficients(s)
    )
    a, b = sands["A"], sands["B"]
    return [
        _claim(
            "table 1: coefficients of uniformity and curvature follow from D10, D30, D60",
            100.0 * worst < 1.0,
            f"largest difference {100.0 * worst:.2f} %",
        ),
        _claim(
            "sand B has the wider grading",
            b.uniformity > a.uniformity,
            f"coefficient of uniformity {b.uniformity:.2f} against {a.uniformity:.2f}",
        ),
    ]


def _coefficients(sand: Sand) -> list[tuple[float, float]]:
    """Printed and from the diameters: D60 / D10 and D30^2 / (D10 D60)."""
    return [
        (sand.uniformity, sand.d60 / sand.d10),
        (sand.curvature, sand.d30**2 / (sand.d10 * sand.d60)),
    ]


def _compaction() -> list[Row]:
    k, p = {s: rises(_k, s) for s in "AB"}, {s: rises(_p, s) for s in "AB"}
    mean_k, mean_p = ({s: _mean(list(c[s].values())) for s in "AB"} for c in (k, p))
    everywhere = {
        pair: value
        for sand, box in (("A", 1), ("B", 1), ("A", 2))
        for pair, value in rises(_k, sand, box).items()
    }
    in_p = {
        pair: value
        for sand, box in (("A", 1), ("B", 1), ("A", 2))
        for pair, value in rises(_p, sand, box).items()
    }
    found = [
        _claim(
            "compaction raises k in every pair of tests",
            min(everywhere.values()) > 0.0,
            _listed(everywhere),
        ),
        _claim(
            "compaction raises k more in sand B than in A",
            mean_k["B"] > mean_k["A"],
            f"means {mean_k['A']:+.0f} % and {mean_k['B']:+.0f} %; A: {_listed(k['A'])}; B: {_listed(k['B'])}",
        ),
        _claim(
            "compaction raises P in every pair of tests", min(in_p.values()) > 0.0, _listed(in_p)
        ),
        _claim(
            "compaction raises P more in sand B than in A",
            mean_p["B"] > mean_p["A"],
            f"means {mean_p['A']:+.1f} % and {mean_p['B']:+.1f} %",
        ),
    ]
    for sand, given in RISE.items():
        found.append(
            _claim(
                f"compaction raises P by about {given:.0f} % in sand {sand} (box 1)",
                abs(mean_p[sand] / given - 1.0) < ABOUT,
                f"mean of {_listed(p[sand])}; 'about': within a quarter",
                "%",
                given,
                mean_p[sand],
            )
        )
    loose = {s: _mean([_p(t) for t in _chosen(s, compacted=False)]) for s in "AB"}
    found.append(
        _claim(
            "uncompacted, sand A transmits more than B",
            loose["A"] > loose["B"],
            f"mean P of A {100.0 * (loose['A'] / loose['B'] - 1.0):+.1f} % against B",
        )
    )
    return found


def _water() -> list[Row]:
    """Largest k and largest P over the water contents, the tests of box 1."""
    found = []
    for sand, number in STIFFEST.items():
        stated = sonoda1993.tests()[number]
        for name, quantity in (("k", _k), ("P", _p)):
            for compacted in (True, False):
                tests = _chosen(sand, compacted=compacted)
                largest = max(tests, key=quantity)
                state = "compacted" if compacted else "as poured"
                found.append(
                    _claim(
                        f"{name} of sand {sand}, {state}, is largest at w = {stated.water_content:g} %",
                        largest.water_content == stated.water_content,
                        f"largest at w = {largest.water_content:g} % (test {largest.number}); "
                        + _said(name, sand, compacted),
                    )
                )
    return found


def _said(name: str, sand: str, compacted: bool) -> str:
    """Where the claim of :func:`_water` comes from."""
    if compacted and (name, sand) != ("P", "A"):
        return "said in the text"
    return (
        "follows from the text, which expects the largest force near the optimum water content"
        if name == "P"
        else "not said"
    )


def _box() -> list[Row]:
    """Tests of box 2 beside those of box 1 with the same sand and compaction and the nearest water content."""
    found = []
    for name, quantity in (("k", _k), ("P", _p)):
        changes = {
            f"{near.number} to {test.number}": _change(quantity, near, test)
            for test, near in _twins()
        }
        worst = max(changes.values(), key=abs)
        found.append(
            _claim(
                f"the size of the box hardly matters for {name}",
                abs(worst) < HARDLY,
                f"{_listed(changes)}; 'hardly': within {HARDLY:g} %; water contents 7.1 and 8.0 % against 7.0 %",
            )
        )
    return found


def _twins() -> list[tuple[Test, Test]]:
    """Each test of box 2 and its neighbour in box 1."""
    return [
        (
            test,
            min(
                _chosen(test.sand, 1, test.compaction > 0.0),
                key=lambda t: abs(t.water_content - test.water_content),
            ),
        )
        for test in _chosen(box=2)
    ]


def _force_against_stiffness() -> list[Row]:
    """Fig. 9, twelve tests of box 1."""
    k, p = [_k(t) for t in _chosen()], [_p(t) for t in _chosen()]
    exponent, error = power_law(k, p)[1], exponent_error(k, p)
    fitted = f"P ~ k^({exponent:.2f} +- {error:.2f}), one standard error, {len(k)} tests"
    return [
        _claim("P grows with k", exponent > POWER_LAW_ERRORS * error, fitted, "1", None, exponent),
        _claim(
            "P is proportional to k",
            abs(exponent - 1.0) < POWER_LAW_ERRORS * error,
            fitted,
            "1",
            1.0,
            exponent,
        ),
    ]


STUDY = Study(
    "section2",
    "Section 2: claims about the experiments, checked against tables 1 and 2",
    2.0,
    rows,
    notes=(
        "k: secant spring constant of the static test at 4 cm; P: peak transmitted force; w: water content. No computation.",
    ),
)

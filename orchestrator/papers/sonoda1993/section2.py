"""Section 2: claims of the paper about its experiments, against its own tables 1 and 2.

No FMU is run.
"""

from collections.abc import Callable, Sequence

from ...cases import sonoda1993
from ...cases.sonoda1993 import Sand, Test
from ..statistics import exponent_error, power_law
from ..study import Outcomes, Row, Study, verdict

HARDLY = 10.0
"""Difference (%) below which one counts as hardly any."""
ABOUT = 0.25
"""Part by which a mean may differ from a figure given with "about"."""
RISE = {"A": 7.0, "B": 19.0}
"""Rise (%) of the peak force by compaction, as the text has it."""
STIFFEST = {"A": 4, "B": 10}
"""Tests with the largest k, as the text has it."""
POWER_LAW_ERRORS = 2.0
"""Standard errors by which an exponent has to differ from a value to count as different."""

Of = Callable[[Test], float]
"""Function of a test: its k or its P."""


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


def rises(quantity: Of, sand: str, box: int = 1) -> dict[str, float]:
    """Return the rise (%) of k or P by compaction, for each pair of tests alike but for it.

    Parameters
    ----------
    quantity : callable
        k or P of a test.
    sand : str
        Letter of the sand.
    box : int
        Number of the box.

    Returns
    -------
    dict of str to float
        By the numbers of both tests.
    """
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


def _change(quantity: Of, before: Test, after: Test) -> float:
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


def rows(outcomes: Outcomes) -> list[Row]:
    """Return the claims in the order of the text."""
    return [*_sands(), *_compaction(), *_water(), *_box(), *_force_against_stiffness()]


def _sands() -> list[Row]:
    """Return whether table 1 agrees with itself, and whether B has the wider grading."""
    sands = sonoda1993.sands()
    worst = max(
        abs(printed / value - 1.0) for s in sands.values() for printed, value in _coefficients(s)
    )
    a = sands["A"]
    b = sands["B"]
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
    """Return D60 / D10 and D30^2 / (D10 D60), each as printed and from the diameters."""
    return [
        (sand.uniformity, sand.d60 / sand.d10),
        (sand.curvature, sand.d30**2 / (sand.d10 * sand.d60)),
    ]


def _compaction() -> list[Row]:
    """Return the claims about compaction."""
    return [*_compaction_of_k(), *_compaction_of_p(), *_stated_rises(), _loose()]


def _everywhere(quantity: Of) -> dict[str, float]:
    """Return the rise (%) by compaction in both sands, and of A in box 2 too."""
    boxes = (("A", 1), ("B", 1), ("A", 2))
    return {pair: v for sand, box in boxes for pair, v in rises(quantity, sand, box).items()}


def _mean_rise(quantity: Of, sand: str) -> float:
    """Return the mean rise (%) by compaction in box 1."""
    return _mean(list(rises(quantity, sand).values()))


def _compaction_of_k() -> list[Row]:
    of_a = _mean_rise(_k, "A")
    of_b = _mean_rise(_k, "B")
    everywhere = _everywhere(_k)
    return [
        _claim(
            "compaction raises k in every pair of tests",
            min(everywhere.values()) > 0.0,
            _listed(everywhere),
        ),
        _claim(
            "compaction raises k more in sand B than in A",
            of_b > of_a,
            f"means {of_a:+.0f} % and {of_b:+.0f} %; A: {_listed(rises(_k, 'A'))}; B: "
            f"{_listed(rises(_k, 'B'))}",
        ),
    ]


def _compaction_of_p() -> list[Row]:
    of_a = _mean_rise(_p, "A")
    of_b = _mean_rise(_p, "B")
    everywhere = _everywhere(_p)
    return [
        _claim(
            "compaction raises P in every pair of tests",
            min(everywhere.values()) > 0.0,
            _listed(everywhere),
        ),
        _claim(
            "compaction raises P more in sand B than in A",
            of_b > of_a,
            f"means {of_a:+.1f} % and {of_b:+.1f} %",
        ),
    ]


def _stated_rises() -> list[Row]:
    """Return whether the mean rises of P are the stated ones."""
    return [
        _claim(
            f"compaction raises P by about {stated:.0f} % in sand {sand} (box 1)",
            abs(_mean_rise(_p, sand) / stated - 1.0) < ABOUT,
            f"mean of {_listed(rises(_p, sand))}; 'about': within a quarter",
            "%",
            stated,
            _mean_rise(_p, sand),
        )
        for sand, stated in RISE.items()
    ]


def _loose() -> Row:
    of_a = _mean([_p(test) for test in _chosen("A", compacted=False)])
    of_b = _mean([_p(test) for test in _chosen("B", compacted=False)])
    return _claim(
        "uncompacted, sand A transmits more than B",
        of_a > of_b,
        f"mean P of A {100.0 * (of_a / of_b - 1.0):+.1f} % against B",
    )


def _water() -> list[Row]:
    """Return the claims about the largest k and P over the water contents, tests of box 1."""
    made = []
    for sand, number in STIFFEST.items():
        stated = sonoda1993.tests()[number]
        for name, quantity in (("k", _k), ("P", _p)):
            for compacted in (True, False):
                tests = _chosen(sand, compacted=compacted)
                largest = max(tests, key=quantity)
                state = "compacted" if compacted else "as poured"
                made.append(
                    _claim(
                        f"{name} of sand {sand}, {state}, is largest at w = "
                        f"{stated.water_content:g} %",
                        largest.water_content == stated.water_content,
                        f"largest at w = {largest.water_content:g} % (test {largest.number}); "
                        + _said(name, sand, compacted),
                    )
                )
    return made


def _said(name: str, sand: str, compacted: bool) -> str:
    """Return in words where a claim of :func:`_water` is made."""
    if compacted and (name, sand) != ("P", "A"):
        return "said in the text"
    if name == "P":
        return (
            "follows from the text, which expects the largest force near the optimum water content"
        )
    return "not said"


def _box() -> list[Row]:
    """Return the claims about the size of the box.

    A test of box 2 stands beside that of box 1 with the same sand and compaction and the nearest
    water content.
    """
    made = []
    for name, quantity in (("k", _k), ("P", _p)):
        changes = {
            f"{near.number} to {test.number}": _change(quantity, near, test)
            for test, near in _twins()
        }
        worst = max(changes.values(), key=abs)
        made.append(
            _claim(
                f"the size of the box hardly matters for {name}",
                abs(worst) < HARDLY,
                f"{_listed(changes)}; 'hardly': within {HARDLY:g} %; water contents 7.1 and 8.0 % "
                "against 7.0 %",
            )
        )
    return made


def _twins() -> list[tuple[Test, Test]]:
    """Return each test of box 2 and its neighbour in box 1."""
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
    """Return the claims about P over k: fig. 9, twelve tests of box 1."""
    k = [_k(test) for test in _chosen()]
    p = [_p(test) for test in _chosen()]
    exponent = power_law(k, p)[1]
    error = exponent_error(k, p)
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
        "k: secant spring constant of the static test at 4 cm; P: peak transmitted force; w: water "
        "content. No computation.",
    ),
)

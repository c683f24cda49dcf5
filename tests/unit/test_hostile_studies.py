"""Studies, samples and designs that are damaged, or made to do harm: accepted, or refused in words."""

import tomllib
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from rockshed.analyses.back_analysis.endpoints import read_endpoints
from rockshed.analyses.back_analysis.parameters import GroundOfValues, given_parameters, values_at
from rockshed.analyses.pile_matching.model import WaveModel
from rockshed.analyses.pile_matching.run import _read
from rockshed.analyses.study.designs import design_problems, points
from rockshed.analyses.study.run import _factors, _shares
from rockshed.campaigns.campaign import campaign_of
from rockshed.commands.assignments import values_of
from rockshed.commands.calibrate_rockfall import _ranges
from rockshed.commands.vary import percentiles_of, varied_of
from rockshed.core.errors import InputRefused
from rockshed.runs.job import prepare as prepare_job
from rockshed.runs.parameters import SystemValues
from rockshed.runs.request import Request
from rockshed.sites.pile.preparation import prepare as prepare_pile
from rockshed.sites.rockfall.preparation import prepare as prepare_slope
from rockshed.sites.shed.preparation import prepare as prepare_shed
from tests.unit.test_hostile_inputs import EXAMPLES, example, fuzz

SHED = EXAMPLES / "trial-shed.toml"
VARY = """\
cushion.thickness=0.6m..1.5m:4
roof.section=H-400x400x13x21,HE 300 B
rock.angle=-10deg,10deg
numerics.seed=1,2,3
"""
RANDOM = """\
rock.mass=lognormal(2.5 t, 0.3)
rock.drop_height=triangular(15m,25m,30m)
sand.friction_angle=0.1..0.6
roof.span=normal(9, 0.2)
rock.velocity0.y=uniform(-9, -8)
"""
SET = """\
rock.mass=3 t
cushion.thickness=90 cm
numerics.seed=3
material.compacted sand.modulus=3 MPa
criteria.deflection=span/200
"""
FIT = """\
soil.strength=1e5..1e7
rock.roughness.mean=0.02..0.8
soil.undulation=0..0.5
limit_speed.mean=5..20
"""
BOULDERS = """\
mass (kg),length1 (m),length2 (m),length3 (cm)
820,0.9,0.8,60
1500,1.2,1.0,80
90,0.4,0.4,30
"""
RADII = "id;mass_t;radius_cm;elongation\n1;0,8;45;1,2\n2;1,5;60;1\n"
WITH_BOULDERS = """\
rock = { file = "FILE", shape = "ellipse" }
start = { along = [1.0, 9.0] }
limit_speed = { mean = 12, deviation = 2 }
profile = { points = [[0, 60, "rock"], [20, 40, "soil"], [70, 5, "soil"], [100, 0]] }
barrier = [{ name = "fence", x = 50.0, height = "3 m", capacity = "500 kJ" }]
"""
ENDS = """\
x (m),A.speed (m/s),A.height (m),A.energy (kJ)
41,12,1.5,200
44,13,,
45,11,0.5,150
47,,,90
52,9,2,
60,8,1,50
"""
SLOPE = """\
rock = { radius = 0.5, density = 2600 }
start = { x = 1 }
limit_speed = { mean = 12, deviation = 2 }
profile = { points = [[0, 60, "rock"], [20, 40, "soil"], [70, 5, "soil"], [100, 0]] }
line = [{ name = "A", x = 40 }]
"""
BELOW_GAUGE = """\
segments = 12
time = 0.04
hammer = { mass = 4000.0, drop = 1.2 }
cushion = { stiffness = 8e8 }
rod = [{ length = 18.0, width = 0.4, modulus = 3.6e10, density = 2450.0 }]
shaft = [{ from = 4.0, to = 18.0, resistance = 900e3 }]
toe = { resistance = 900e3 }
"""
DIESEL = """\
blows = 2
[hammer]
kind = "diesel"
mass = "2.2 t"
drop = "2.4 m"
ports = "0.4 m"
efficiency = 0.8
rate = "45 1/min"
anvil = { mass = "500 kg", stiffness = 1e10, restitution = 0.9 }
gas = { force = "600 kN", hold = "10 ms", end = 0.0125 }
[cushion]
stiffness = "1e6 kN/m"
restitution = 0.8
[helmet]
mass = "900 kg"
[pile_cushion]
modulus = "300 MPa"
thickness = "15 cm"
area = "0.16 m2"
restitution = 0.5
[[rod]]
length = "12 m"
diameter = "40 cm"
wall = "9 mm"
modulus = "210 GPa"
density = 7850.0
[[rod]]
length = 6.0
area = "0.02 m2"
perimeter = 1.2
modulus = "210 GPa"
density = 7850.0
[[shaft]]
from = 4.0
to = 18.0
resistance = "600 kN"
quake = "3 mm"
damping = 0.25
[toe]
resistance = "900 kN"
quake = 4e-3
damping = 0.6
[bearing]
resistances = ["500 kN", "1000 kN", 2e6]
refusal = 800.0
last_blow = false
[limits]
compression = "200 MPa"
"""
SPREADS = """\
trials = 100
[rock]
mass = { distribution = "lognormal", mean = "0.8 t", deviation = "0.35 t", to = "2 t" }
density = { distribution = "normal", mean = 2500, deviation = 100, from = 2000.0 }
shape = "ellipse"
elongation = { distribution = "triangular", from = 1.0, mode = 1.2, to = 2.0 }
[start]
along = [0.0, 9.0]
velocity = [{ distribution = "uniform", from = 0.0, to = 1.0 }, 0.0]
angular_velocity = { distribution = "normal", mean = 0.0, deviation = 1.0 }
angle = "30 deg"
[limit_speed]
mean = 12.0
deviation = 2.0
[profile]
points = [[0, 40, "rock"], [10, 30, "hard-bedrock"], [10, 20, "floor"], [60, 19]]
[material.floor]
like = "soil"
undulation = 0.1
roughness = { mean = 0.2, deviation = 0.05 }
[material.own]
normal_restitution = 0.3
tangential_restitution = 0.8
scaling_speed = 9.0
friction = 0.5
resistance = 0.0
tilt = { mean = 0.0, deviation = 0.1 }
roughness = { mean = 0.1 }
[[ground]]
material = "own"
from = 20.0
to = 40.0
[[barrier]]
name = "fence"
x = 50.0
height = "3 m"
capacity = "500 kJ"
free_border = "30 cm"
"""
ZONE = """\
rock = { radius = { distribution = "uniform", from = "30 cm", to = "60 cm" }, mass = { distribution = "triangular", from = "300 kg", mode = "800 kg", to = "1.2 t" } }
start = { line = [[0.0, 42.0], [6.0, 44.0]] }
limit_speed = { mean = 12.0, deviation = 2.0 }
profile = { points = [[0, 40, "rock"], [10, 30, "talus"], [12, 20, "soil"], [60, 19]] }
distribution = { roughness = "lognormal", tilt = "triangular" }
barrier = [{ name = "fence", x = 50.0, height = 3.0, capacity = 5e5 }]
"""
GIRDERS = """\
name = "girders"
[rock]
size = "1.2 m"
density = 2600
velocity = "22 m/s"
angle = "15 deg"
spin = 2.0
place = "4.5 m"
shape = "block"
[cushion]
layers = [{ material = "sand a", thickness = "60 cm" }, { material = "sand a", thickness = 0.3 }]
width = "6 m"
effective_width = "3 m"
[material."sand a"]
like = "compacted sand"
modulus = "39 kgf/cm2"
density = "18 kN/m3"
friction_angle = "35 deg"
cohesion = "2 kPa"
[roof]
span = "7 m"
area = "149 cm2"
second_moment = "25170 cm4"
section_modulus = "1680 cm3"
plastic_modulus = "1869 cm3"
height = "30 cm"
mass = "117 kg/m"
yield_stress = "345 MPa"
elastic_modulus = "210 GPa"
spacing = "1 m"
number = 8
slab = { thickness = "12 cm", density = 2500.0 }
[supports]
kind = "elastic"
stiffness = "200 kN/mm"
[criteria]
deflection = "span/300"
stress = "345 MPa"
penetration = "0.5 m"
[numerics]
disc_radius = "66 mm"
elements = 35
stop_time = "0.4 s"
seed = 3
clearance = "1 cm"
exchange_step = "0.01 ms"
output_interval = 1e-4
"""
CONCRETE = """\
rock = { mass = "1.8 t", drop_height = "18 m" }
cushion = { thickness = "90 cm" }
supports = { kind = "fixed" }
criteria = { plastic_moment = "2000 kN.m", deflection = "20 mm" }
[roof]
span = "7 m"
bending = "yielding"
[roof.concrete]
thickness = "70 cm"
cover = "6 cm"
bar_diameter = "25 mm"
bar_spacing = "15 cm"
top_bar_diameter = "19 mm"
top_bar_spacing = "15 cm"
top_cover = "5 cm"
concrete_strength = "24 MPa"
bar_yield_stress = "345 MPa"
"""
ON_PILES = f"""\
rock = {{ mass = "1.8 t", drop_height = "18 m" }}
cushion = {{ thickness = "90 cm" }}
roof = {{ section = "H-400x400x13x21", spacing = "1.5 m", span = "9 m" }}
supports = {{ kind = "piles", file = "{EXAMPLES / "pile.toml"}" }}
criteria = {{ pile_set = "5 mm" }}
"""


def texts(path: Path) -> list[str]:
    """Options of a command, one a line."""
    return [text for text in path.read_text("utf-8", "surrogateescape").split("\n") if text]


def refuse(problems) -> None:
    if problems:
        raise InputRefused(problems)


@cache
def values_of_shed() -> SystemValues:
    return SystemValues(prepare_job(Request(str(SHED))))


def vary(path: Path) -> None:
    problems = []
    factors, more = _factors(varied_of(texts(path), problems), values_of_shed())
    refuse(problems + more)
    drawn = any(factor.is_distribution for factor in factors)
    for design in ("random", "lhs", "sobol") if drawn else ("grid", "oat"):
        samples = 16 if drawn else None
        refuse(design_problems(design, factors, samples))
        values = [
            v for point in points(design, factors, samples or 0, 0) for v in point.values.values()
        ]
        assert all(isinstance(value, str) or np.isfinite(value) for value in values)


def assigned(path: Path) -> None:
    problems = []
    values = values_of("--set", texts(path), problems)
    refuse(problems)
    prepare_shed(SHED, values)


def percentiles(path: Path) -> None:
    problems = []
    asked = percentiles_of(path.read_text("utf-8", "surrogateescape"), problems)
    refuse(problems)
    point = SimpleNamespace(role="")
    _shares(asked, SimpleNamespace(design="lhs", entries=[(1, point, None, None)] * 500))


@cache
def slope_and_campaign():
    slope = prepare_slope(tomllib.loads(SLOPE))
    return slope, campaign_of(slope)


def fit(path: Path) -> None:
    slope, campaign = slope_and_campaign()
    parameters = given_parameters(_ranges(texts(path)), slope)
    if parameters:
        ground = GroundOfValues(slope, campaign, [parameter.name for parameter in parameters])
        for place in (0.0, 0.5, 1.0):
            values = values_at(parameters, np.full(len(parameters), place))
            assert np.isfinite(values).all()
            ground.with_values(values)


def ends(path: Path) -> None:
    for observed in read_endpoints(path, slope_and_campaign()[1], 1.0):
        assert np.isfinite(observed.values).all()
        assert 0.0 < observed.scatter < np.inf


def slope(path: Path) -> None:
    prepared = prepare_slope(path)
    campaign_of(prepared)
    assert np.isfinite(prepared.rocks.sample(0, 64)).all()


def boulders(path: Path) -> None:
    site = path.with_suffix(".toml")
    site.write_text(WITH_BOULDERS.replace("FILE", path.name))
    slope(site)


def blow(path: Path) -> None:
    model = WaveModel(*_read(path, tomllib.loads(BELOW_GAUGE))[::-1])
    assert np.isfinite([model.up, model.down]).all()


def measured_blow() -> bytes:
    time = np.linspace(0.0, 50.0, 60)
    pulse = np.exp(-(((time - 10.0) / 4.0) ** 2))
    rows = [f"{t:.3f},{2000 * p:.4g},{1.5 * p:.4g}" for t, p in zip(time, pulse)]
    return "\n".join(["time (ms),force (kN),velocity (m/s)", *rows, ""]).encode()


def pile(path: Path) -> None:
    prepared = prepare_pile(path)
    prepared.hammer()
    drivability = prepared.site.drivability
    for depth in drivability.penetrations if drivability else ():
        assert all(np.isfinite(values).all() for values in prepared.at(depth).soil().values())


PARSERS = {
    "vary": (vary, VARY.encode, ".txt"),
    "vary at random": (vary, RANDOM.encode, ".txt"),
    "set": (assigned, SET.encode, ".txt"),
    "percentiles": (percentiles, b"5,50,95,99".strip, ".txt"),
    "fit": (fit, FIT.encode, ".txt"),
    "boulders": (boulders, BOULDERS.encode, ".csv"),
    "radii of boulders": (boulders, RADII.encode, ".csv"),
    "end points": (ends, ENDS.encode, ".csv"),
    "blow": (blow, measured_blow, ".csv"),
    "diesel": (pile, DIESEL.encode, ".toml"),
    "ground": (pile, lambda: example("pile_ground.toml"), ".toml"),
    "rods": (pile, lambda: example("spt_rods.toml"), ".toml"),
    "spreads": (slope, SPREADS.encode, ".toml"),
    "zone": (slope, ZONE.encode, ".toml"),
    "girders": (prepare_shed, GIRDERS.encode, ".toml"),
    "concrete": (prepare_shed, CONCRETE.encode, ".toml"),
    "on piles": (prepare_shed, ON_PILES.encode, ".toml"),
    "shed": (prepare_shed, SHED.read_bytes, ".toml"),
}


@pytest.mark.parametrize("name", PARSERS)
def test_a_mutated_text_is_accepted_or_refused_in_words(name, tmp_path):
    fuzz(PARSERS[name], name, range(12), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", PARSERS)
def test_20_000_mutated_texts_are_accepted_or_refused_in_words(name, tmp_path):
    fuzz(PARSERS[name], name, range(12, 1212), tmp_path)

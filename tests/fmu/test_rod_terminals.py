"""Hammer, rod and ground connected by their terminals, in system files."""

import pytest

from rockshed.cases.spt import hammer_connections, toe_connections
from rockshed.core.run import simulate
from rockshed.core.system.reading import load_system

FMUS = {"hammer": "Hammer", "ground": "ImpulsiveGround", "rod": "PileRod"}
BY_TERMINALS = ("hammer.head <-> rod.head", "rod.toe <-> ground.toe")
BY_MEMBERS = tuple(
    f"{connection.source} -> {connection.target}"
    for connection in [*hammer_connections("hammer", "rod"), *toe_connections("rod", "ground")]
)
TEXT = """
name = "struck-rod"
master = "sequential"
order = ["hammer", "ground", "rod"]
stop_time = 0.008
exchange_step = {step}
output_interval = 1e-4
connections = [{connections}]

[components.hammer]
fmu = "{hammer}"
[components.rod]
fmu = "{rod}"
parameters = {{ "head.port" = "waves", "toe.condition" = "port", "toe.port" = "{port}", exchange = "sequential", "toe.partner.stiffness" = 8e6 }}
[components.ground]
fmu = "{ground}"
parameters = {{ law = "smith", port = "{ground_port}", damping = 0.5 }}
"""
COUPLINGS = {
    "waves": {"step": 5e-5, "port": "waves", "ground_port": "wave"},
    "kinematics": {"step": 1e-5, "port": "kinematics", "ground_port": "kinematics"},
}


@pytest.fixture
def struck(native_fmus, fmi3_fmus, tmp_path):
    """Run a file with these connections, some components of it with FMUs for FMI 3.0."""

    def run(coupling, connections, three):
        files = {
            name: (fmi3_fmus if name in three else native_fmus)[model]
            for name, model in FMUS.items()
        }
        listed = ", ".join(f'"{connection}"' for connection in connections)
        folder = tmp_path / str(len(connections)) / "-".join(["run", *three])
        file = folder.with_suffix(".toml")
        file.parent.mkdir(exist_ok=True)
        file.write_text(TEXT.format(connections=listed, **files, **COUPLINGS[coupling]))
        return simulate(load_system(file), folder)

    return run


@pytest.mark.parametrize("coupling", COUPLINGS)
def test_terminals_of_hammer_rod_and_ground_stand_for_their_connections(struck, coupling):
    expected = struck(coupling, BY_MEMBERS, ())
    assert expected.series["ground.settlement"].max() > 1e-4
    for three in ((), tuple(FMUS), ("rod",)):
        run = struck(coupling, BY_TERMINALS, three)
        assert list(run.series) == list(expected.series)
        for name, series in expected.series.items():
            assert run.series[name].tobytes() == series.tobytes(), name
        assert not [told for told in run.warnings if "nothing drives" in told]


def test_a_toe_does_not_fit_a_plate(struck):
    with pytest.raises(Exception, match=r"only one of both has force, force\.y, impedance"):
        struck("waves", ("rod.toe <-> ground.plate",), ())

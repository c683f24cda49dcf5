"""Names that are longer than a file system takes are refused in words, wherever a user names a file."""

import pytest

import rockshed
from rockshed.core.errors import InputRefused
from rockshed.core.system.clock import exact
from rockshed.runs.cluster import Certificates
from rockshed.runs.job import Request, prepare
from rockshed.runs.system import System

LONG = "x" * 3000
SITE = {
    "rock": {"radius": 0.5, "density": 2600},
    "start": {"x": 1.0},
    "limit_speed": {"mean": 12.0, "deviation": 2.0},
    "profile": {"points": [[0, 40, "rock"], [30, 10, "soil"], [60, 5]]},
}
HELD = Certificates(LONG, LONG, LONG)
TAKERS = {
    "system file": lambda: prepare(Request(f"{LONG}.toml")),
    "SSP": lambda: prepare(Request(f"{LONG}.ssp")),
    "case": lambda: prepare(Request(LONG)),
    "load": lambda: System.load(f"{LONG}.toml"),
    "project": lambda: rockshed.shed(f"{LONG}.toml"),
    "boulders": lambda: rockshed.rockfall({**SITE, "rock": {"file": LONG}}, trials=3),
    "slope": lambda: rockshed.rockfall(f"{LONG}.toml", trials=3),
    "folder": lambda: rockshed.rockfall(SITE, trials=3, folder=LONG),
    "certificates": lambda: rockshed.rockfall(
        SITE, trials=3, scheduler="tls://a:1", certificates=HELD
    ),
    "run": lambda: rockshed.read_run(LONG),
    "resume": lambda: rockshed.resume(LONG),
    "branch": lambda: rockshed.branch(LONG, {"a": 1}),
    "verify": lambda: rockshed.verify(LONG),
    "FMU": lambda: rockshed.alone(f"{LONG}.fmu"),
    "check": lambda: rockshed.check_fmu(f"{LONG}.fmu"),
    "pile": lambda: rockshed.pile(f"{LONG}.toml"),
    "report": lambda: rockshed.report(LONG),
    "study": lambda: rockshed.study(f"{LONG}.toml", {"a": [1, 2]}),
}


@pytest.mark.parametrize("taker", TAKERS)
def test_a_name_that_no_file_can_have_is_refused_in_words(taker, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputRefused):
        TAKERS[taker]()
    assert not list(tmp_path.iterdir())


def test_a_time_below_a_picosecond_is_none_at_all():
    assert exact(0.0) == 0
    for seconds in (5e-324, 1e-20):
        with pytest.raises(ValueError, match="no whole number of picoseconds"):
            exact(seconds)

"""Studies on the workers of a Dask scheduler: the same table, and clear words when it is gone."""

import pytest

import rockshed
from rockshed.core.errors import InputRefused

VARY = {"rock.velocity0.y": [-4.0, -8.0]}
STOP = {"stop_time": 0.001}


def test_a_study_on_dask_has_the_table_of_processes(tmp_path):
    pytest.importorskip("distributed")
    for name, where in (("dask", {"scheduler": "local"}), ("processes", {})):
        rockshed.study("lab-impact", VARY, options=STOP, workers=1, folder=tmp_path / name, **where)
    tables = [(tmp_path / name / "runs.csv").read_text() for name in ("dask", "processes")]
    assert tables[0] == tables[1]


def test_a_scheduler_that_does_not_answer_is_refused(tmp_path):
    pytest.importorskip("distributed")
    with pytest.raises(InputRefused, match="no scheduler answers"):
        rockshed.study("lab-impact", VARY, options=STOP, scheduler="tcp://127.0.0.1:1")

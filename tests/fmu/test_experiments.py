"""FMUs carry their experiments: files as the standards have them, and kernels that give what is expected."""

import shutil
import zipfile
from io import BytesIO

import numpy as np
import pytest
from lxml import etree

from rockshed.checking.experiments.schemas import EXPERIMENTS, MANIFEST, schema
from rockshed.components.catalogue import NAMES, component, component_in
from rockshed.fmus.build import BuildError, Fmi, fmu_files
from rockshed.fmus.experiments.declaration import Expected, Experiment, Purpose
from rockshed.fmus.experiments.files import FOLDER, experiment_files
from rockshed.fmus.experiments.files import MANIFEST as MANIFEST_FILE
from rockshed.fmus.experiments.found import experiments_of
from rockshed.fmus.native.fmu import stamp
from rockshed.fmus.parts import archive
from rockshed.ssp.documents import SSV, read_document

from .kernels import missed

OWN = [
    (name, one)
    for name in NAMES
    for one in experiments_of(component(name), component(name).with_sizes())
]


@pytest.mark.parametrize(("name", "one"), OWN, ids=lambda each: getattr(each, "name", each))
def test_kernels_give_what_is_expected_within_the_tolerance(name, one):
    """Without FMI. The expected values are made from closed forms, and not by the kernels."""
    made = component(name)
    assert missed(made, made.with_sizes(), one) == {}


@pytest.mark.parametrize("name", NAMES)
def test_each_component_has_experiments_of_all_purposes(name):
    purposes = {one.purpose for owner, one in OWN if owner == name}
    assert purposes == set(Purpose)
    names = [one.name for owner, one in OWN if owner == name]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("sizes", [{"elements": n} for n in (8, 13, 30, 48, 120)])
def test_the_beams_experiments_hold_for_other_numbers_of_discs(sizes):
    made = component("RBSMBeam")
    chosen = made.with_sizes(sizes)
    experiments = experiments_of(made, chosen)
    assert len(experiments) > 5
    assert {one.name: missed(made, chosen, one) for one in experiments} == {
        one.name: {} for one in experiments
    }


def test_what_is_not_within_a_tolerance_is_seen():
    made = component("FallingRock")
    fall = experiments_of(made, {})[0]
    wrong = {"velocity.y": Expected(np.full(21, -8.0), 1e-3)}
    assert list(missed(made, {}, Experiment("x", Purpose.SMOKE, "", fall.step, 20, wrong))) == [
        "velocity.y"
    ]


@pytest.mark.parametrize("fmi", Fmi)
@pytest.mark.parametrize("name", NAMES)
def test_files_of_experiments_keep_to_the_schemas(name, fmi):
    made = component(name)
    files = experiment_files(made, made.with_sizes(), fmi)
    for path, content in files.items():
        if path.endswith(".ssv"):
            read_document(content, path, f"{{{SSV}}}ParameterSet")
        elif path.endswith((".exp", ".xml")):
            rules = schema(MANIFEST if path == MANIFEST_FILE else EXPERIMENTS)
            rules.assertValid(etree.fromstring(content))
    named = {
        f"{FOLDER}/{related.get('source')}".replace(f"{FOLDER}/../../", "")
        for related in etree.fromstring(files[MANIFEST_FILE]).iter("Related")
    }
    assert named | {MANIFEST_FILE} == set(files)
    assert sum(len(content) for path, content in files.items() if ".state" not in path) < 200_000


def test_arrays_are_elements_in_fmi_2_and_whole_in_fmi_3():
    made = component("SlopeRockfall")
    for fmi, first in ((Fmi.TWO, "end.x[1]"), (Fmi.THREE, "end.x")):
        files = experiment_files(made, made.with_sizes(), fmi)
        xml = etree.fromstring(files[f"{FOLDER}/flight.ssv"])
        assert next(xml.iter(f"{{{SSV}}}Parameter")).get("name") == first
    beam = component("RBSMBeam")
    heads = [
        experiment_files(beam, beam.with_sizes(), fmi)[f"{FOLDER}/pull_in.csv"].split(b"\n")[0]
        for fmi in Fmi
    ]
    assert heads[0].startswith(b"time,force.x[1],force.x[2],")
    assert heads[1] == b"time,force.x"


def test_the_same_experiments_give_the_same_bytes():
    made = component("Hammer")
    assert archive(fmu_files(made, {})) == archive(fmu_files(made, {}))


def test_the_documentation_inside_an_fmu_leads_to_its_experiments():
    files = fmu_files(component("Hammer"), {})
    assert b'<a href="fmi-ls-ref.html">' in files["documentation/index.html"]
    assert b"rigid-ram" in files["documentation/fmi-ls-ref.html"]


def test_an_fmu_has_licenses_and_says_what_it_needs():
    with zipfile.ZipFile(BytesIO(archive(fmu_files(component("FallingRock"), {})))) as fmu:
        assert b"MIT" in fmu.read("documentation/licenses/license.txt")
        assert b"Copyright" in fmu.read("documentation/licenses/pythonfmu.txt")
        needed = fmu.read("documentation/externalDependencies.txt").decode()
    assert "numba >=" in needed
    assert "numpy >=" in needed
    assert "Python >=3.11" in needed


OUTSIDE = """
from rockshed.fmus.experiments.declaration import Expected, Experiment, Purpose

def experiments(sizes):
    return (Experiment("still", Purpose.SMOKE, "nothing moves", 1e-4, 5, {"%s": Expected(0.0, 1.0)}),)
"""


def test_a_component_of_a_folder_of_its_own_brings_its_experiments(tmp_path, probe):
    folder = tmp_path / "springy"
    shutil.copytree(probe.folder, folder, ignore=shutil.ignore_patterns("__pycache__"))
    bare = component_in(folder)
    sizes = bare.with_sizes()
    assert experiment_files(bare, sizes) == {}
    before = stamp(bare, sizes)
    output = next(
        v.name for v in bare.layout.variables if v.causality == "output" and v.size is None
    )
    (folder / "experiments.py").write_text(OUTSIDE % output, encoding="utf-8")
    files = fmu_files(bare, sizes)
    assert f"{FOLDER}/still_ref.csv" in files
    assert not any(path.endswith("experiments.py") for path in files)
    assert stamp(bare, sizes) != before


def test_an_experiment_that_names_what_is_not_there_is_refused(tmp_path, probe):
    folder = tmp_path / "wrongly"
    shutil.copytree(probe.folder, folder, ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "experiments.py").write_text(OUTSIDE % "nothing", encoding="utf-8")
    made = component_in(folder)
    with pytest.raises(BuildError, match="its experiment still names the output nothing"):
        experiment_files(made, made.with_sizes())

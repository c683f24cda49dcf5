"""Sources that change while an FMU is built: nothing is made or kept of two versions of them."""

import importlib.util
import re
import shutil
import zipfile

import pytest

from rockshed.components.catalogue import component_in
from rockshed.components.common import cache
from rockshed.fmus.build import BuildError, Fmi, Runtime, build_component
from rockshed.fmus.native import fmu as native_fmu
from rockshed.fmus.native.fmu import own_binary
from rockshed.fmus.wasm import module as wasm
from tests.fmu.conftest import HERE

needs_zig = pytest.mark.skipif(
    not importlib.util.find_spec("ziglang"), reason="not installed: ziglang (extra 'native')"
)


@pytest.fixture
def own_cache(tmp_path, monkeypatch):
    """A folder of compiled code in which nothing is yet."""
    folder = tmp_path / "cache"
    monkeypatch.setenv(cache.CACHE_VARIABLE, str(folder))
    return folder


@pytest.fixture
def made(tmp_path):
    """A component whose sources can be changed."""
    folder = tmp_path / "changing"
    shutil.copytree(HERE / "extra" / "probe", folder, ignore=shutil.ignore_patterns("__pycache__"))
    return component_in(folder)


def changing(monkeypatch, owner, name, change):
    """Make a function change a file before it does its work, once."""
    original, left = getattr(owner, name), [change]

    def changed(*args, **kwargs):
        if left:
            left.pop()()
        return original(*args, **kwargs)

    monkeypatch.setattr(owner, name, changed)


def append(file, text):
    with file.open("a", encoding="utf-8") as opened:
        opened.write(text)


def tokens(file, made, fmi):
    """Tokens of description and binary."""
    with zipfile.ZipFile(file) as archive:
        description = archive.read("modelDescription.xml")
        binary = archive.read(own_binary(made, fmi))
    told = re.search(rb'(?:guid|instantiationToken)="(\{[-0-9a-f]+\})"', description)[1]
    return told, re.search(rb"\{[0-9a-f]{8}(?:-[0-9a-f]{4}){3}-[0-9a-f]{12}\}", binary)[0]


@pytest.mark.parametrize("fmi", Fmi)
@pytest.mark.parametrize("when", ["_linked", "described_files"])
def test_an_fmu_whose_sources_change_meanwhile_is_refused_and_then_built_whole(
    made, tmp_path, monkeypatch, when, fmi
):
    build = {"destination": tmp_path / "fmus", "runtime": Runtime.NATIVE, "fmi": fmi}
    readme = made.folder / "README.md"
    changing(monkeypatch, native_fmu, when, lambda: append(readme, "\nOther.\n"))
    with pytest.raises(BuildError, match="its sources have changed while it was built"):
        build_component(made, **build)
    assert not list(tmp_path.glob("fmus/*.fmu"))
    described, compiled = tokens(build_component(made, **build), made, fmi)
    assert described == compiled


def test_the_token_is_made_once_and_handed_on(made, tmp_path, monkeypatch):
    """Tokens that follow each other would differ; the last one is what is compared in the end."""
    asked = []
    monkeypatch.setattr(
        native_fmu, "stamp", lambda *_: asked.append(0) or "{00000007-0000-0000-0000-000000000000}"
    )
    files = native_fmu.native_files(made, made.with_sizes())
    assert len(asked) == 2
    assert b"{00000007-" in files["modelDescription.xml"]


def test_object_code_of_changed_kernels_is_not_kept_under_the_name_of_the_old_ones(
    made, own_cache, monkeypatch
):
    kernel = next(file for file in made.folder.glob("*.py") if "@kernel" in file.read_text())
    old = kernel.read_text()
    changing(monkeypatch, native_fmu, "_compile", lambda: append(kernel, "\n# other\n"))
    sizes, platforms = made.with_sizes(), [native_fmu.own_platform()]
    with pytest.raises(BuildError, match="nothing was kept"):
        native_fmu._objects(made, sizes, platforms)
    assert not list(own_cache.glob("*.o"))
    kernel.write_text(old)
    native_fmu._objects(made, sizes, platforms)
    assert len(list(own_cache.glob("*.o"))) == 1


@needs_zig
def test_webassembly_of_changed_kernels_is_not_kept_under_the_name_of_the_old_ones(
    made, own_cache, monkeypatch
):
    kernel = next(file for file in made.folder.glob("*.py") if "@kernel" in file.read_text())
    changing(monkeypatch, wasm, "_compile", lambda: append(kernel, "\n# other\n"))
    with pytest.raises(BuildError, match="nothing was kept"):
        wasm.kernel_object(made, "simd")
    assert not list(own_cache.glob("*.o"))
    wasm.kernel_object(made, "simd")
    assert len(list(own_cache.glob("*.o"))) == 1


def test_variables_that_were_declared_since_the_program_was_started_are_refused(made, tmp_path):
    """The description would have the old ones and the binary the new ones, by number."""
    declarations = next(file for file in made.folder.glob("*.py") if "Layout(" in file.read_text())
    text = declarations.read_text()
    first = re.search(r'"([\w.]+)"', text[text.index("Layout(") :])[1]
    declarations.write_text(text.replace(f'"{first}"', f'"{first}_anew"'))
    with pytest.raises(BuildError, match=r"the variables declared in .* are not those"):
        build_component(made, destination=tmp_path / "fmus", runtime=Runtime.NATIVE)
    assert not list(tmp_path.glob("fmus/*.fmu"))

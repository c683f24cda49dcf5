"""``import rockshed``: light, and every public name is there with a docstring and examples that run."""

import doctest
import inspect
import subprocess
import sys
from importlib.metadata import version

import pytest

import rockshed


def test_the_import_takes_no_heavy_library():
    script = (
        "import sys, rockshed\n"
        "heavy = {'numpy', 'pydantic', 'numba', 'matplotlib', 'pyarrow', 'typer', 'rich'}\n"
        "print(heavy & set(sys.modules), rockshed.__version__)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.stdout.strip() == f"set() {version('rockshed')}", done.stderr


def test_a_name_that_is_missing_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'simulat'"):
        rockshed.simulat  # noqa: B018


def test_every_public_name_is_listed_and_documented():
    assert set(rockshed.__all__) <= set(dir(rockshed))
    for name in rockshed.__all__:
        assert name == "__version__" or inspect.getdoc(getattr(rockshed, name)), name


def examples():
    """Every docstring of the face that has examples, methods too."""
    finder = doctest.DocTestFinder(recurse=False)
    found = finder.find(rockshed, "rockshed")
    for name in rockshed.__all__:
        value = getattr(rockshed, name)
        found += finder.find(value, name)
        if inspect.isclass(value):
            for own, method in inspect.getmembers(value, inspect.isroutine):
                found += finder.find(method, f"{name}.{own}") if method.__doc__ else []
    return [test for test in found if test.examples]


@pytest.mark.parametrize("example", examples(), ids=lambda example: example.name)
def test_examples_run(example, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = []
    failed, tried = doctest.DocTestRunner().run(example, out=said.append)
    assert tried
    assert not failed, "".join(said)


def test_functions_of_the_face_have_an_example():
    named = {example.name for example in examples()}
    functions = {n for n in rockshed.__all__ if inspect.isfunction(getattr(rockshed, n))}
    assert functions <= named

"""Built FMUs in which a bit has flipped: built anew or refused, and never another result."""

import io
import random
import re

import numpy as np
import pytest

from rockshed.components.catalogue import component
from rockshed.core.errors import InputRefused
from rockshed.core.fmu.archive import Archive, ArchiveError
from rockshed.core.run import simulate
from rockshed.core.system.reading import system_from
from rockshed.fmus.build import Runtime, build, build_if_needed
from rockshed.fmus.places import native_is_fresh

FLIPS = 100
"""Flips in the FMU of each runtime."""
DIRECTORY = 4000
"""Bytes at the end of an archive in which its directory lies, about."""

LENGTH_OF_COMMENT, MODE = 32, 41
"""Places in an entry of the directory."""


def flipped(content: bytes, chance: random.Random) -> bytes:
    """The content with one bit changed, every second time near the end."""
    damaged = bytearray(content)
    first = chance.choice((0, max(0, len(content) - DIRECTORY)))
    damaged[chance.randrange(first, len(content))] ^= 1 << chance.randrange(8)
    return bytes(damaged)


def series(fmu, folder):
    """Results of a short run with an FMU; None if it is refused."""
    content = {
        "name": "fall",
        "components": {"a": {"fmu": str(fmu)}},
        "exchange_step": 0.001,
        "stop_time": 0.01,
    }
    try:
        return simulate(system_from(content), folder).series
    except InputRefused:
        return None


@pytest.mark.parametrize("runtime", list(Runtime))
def test_a_bit_that_flips_in_an_fmu_never_leads_to_another_result(runtime, request, tmp_path):
    fmu = request.getfixturevalue(f"{runtime}_fmus")["FallingRock"]
    content, chance = fmu.read_bytes(), random.Random(4)
    expected = series(fmu, tmp_path / "whole")
    refused = 0
    for number in range(FLIPS):
        damaged = tmp_path / "a.fmu"
        damaged.write_bytes(flipped(content, chance))
        found = series(damaged, tmp_path / f"run{number}")
        refused += found is None
        assert found is None or all(np.array_equal(found[n], expected[n]) for n in expected)
    assert refused > FLIPS / 2


def members(content: bytes) -> dict[str, bytes]:
    with Archive(io.BytesIO(content)) as archive:
        return {name: archive.read(name, len(content)) for name in archive.names}


def test_an_archive_whose_directory_hides_files_is_refused(python_fmus):
    content = python_fmus["FallingRock"].read_bytes()
    whole = members(content)
    entries = [found.start() for found in re.finditer(b"PK\x01\x02", content)][-len(whole) :]
    for entry in entries[:-1]:
        longer = bytearray(content)
        longer[entry + LENGTH_OF_COMMENT] ^= 1 << 6  # the next entries are in the comment
        with pytest.raises(ArchiveError, match=r"is damaged: it names|not a zip archive"):
            members(bytes(longer))
        folder = bytearray(content)
        folder[entry + MODE] ^= 1 << 6  # as of a folder
        assert members(bytes(folder)) == whole


@pytest.mark.parametrize("runtime", list(Runtime))
def test_a_damaged_fmu_among_the_built_ones_is_built_anew(runtime, native_fmus, tmp_path):
    file = build("FallingRock", destination=tmp_path, runtime=runtime)
    whole, chance = file.read_bytes(), random.Random(5)
    for _ in range(5):
        damaged = bytearray(whole)
        damaged[chance.randrange(len(whole) // 4, len(whole) // 2)] ^= 1 << chance.randrange(8)
        file.write_bytes(damaged)
        if runtime == Runtime.NATIVE:
            declared = component("FallingRock")
            assert not native_is_fresh(declared, declared.with_sizes(), tmp_path)
        assert build_if_needed("FallingRock", destination=tmp_path, runtime=runtime) == file
        assert file.read_bytes() == whole

"""The page of limits says what the program does."""

from pathlib import Path

import pytest

from rockshed.campaigns import campaign
from rockshed.components.catalogue import component
from rockshed.components.common import stepping
from rockshed.core import input_text
from rockshed.core.fmu import archive, fmi3_slave, fmu_slave
from rockshed.core.loop import texts
from rockshed.core.system import clock, limits, names
from rockshed.input_files import csv_table, form
from rockshed.sites.pile import site as pile
from rockshed.sites.rockfall import profile_files
from rockshed.sites.rockfall import site as slope

PAGE = (Path(__file__).parents[2] / "docs" / "limits.md").read_text(encoding="utf-8")
SAND = component("SandCushion").sizes
GIB, MIB = 1 << 30, 1 << 20


@pytest.mark.parametrize(
    ("row", "values"),
    [
        ("elements that a range", [f"{names.MOST_ELEMENTS:,}"]),
        ("elements of an array of an FMU", [f"{fmu_slave._MOST_ELEMENTS:,}"]),
        (
            "an FMU, unpacked",
            [f"{archive.MOST_UNPACKED // GIB} GiB", f"{archive.MOST_MEMBERS:,} files"],
        ),
        ("the model description", [f"{archive.MOST_DESCRIPTION // MIB} MiB"]),
        ("a text file", [f"{input_text.MOST_BYTES // MIB} MiB"]),
        ("tables and lists", [f"| {input_text.DEEPEST} |"]),
        ("lines of a CSV file", [f"{csv_table.MOST_ROWS:,}; {csv_table.LONGEST_FIELD}"]),
        ("points of a drawn profile", [f"{profile_files.MOST_POINTS:,}"]),
        ("a number in an input file", [f"{form.LARGEST:.0e}".replace("+", "")]),
        ("values in the time series", [f"{limits.MOST_VALUES:,}"]),
        ("changes of a recorded text", [f"{texts.MOST_CHANGES:,}"]),
        ("early returns", [f"{fmi3_slave.MOST_RETURNS:,}"]),
        ("recorded states", [f"{limits.MOST_STATES:,}"]),
        ("results of a run without", [f"{limits.MUCH // 10**6} MB"]),
        (
            "internal steps",
            [f"{limits.MOST_INTERNAL_STEPS:,} in a run", f"{stepping.MOST_STEPS:,} in other"],
        ),
        ("times", [f"{clock._MOST / clock.PICOSECONDS / 86400:.0f} days"]),
        ("fractions of a second", [f"{clock._DENOMINATOR:,}"]),
        (
            "discs of a cushion",
            [f"{SAND['discs'].maximum:,}; {component('RBSMBeam').sizes['elements'].maximum:,}"],
        ),
        ("segments of a pile", [f"{pile.MOST_SEGMENTS:,}; {pile.MOST_BLOWS:,}"]),
        ("trials", [f"{slope.MOST_TRIALS:,}", f"{campaign.MOST_MEMORY // GIB} GiB"]),
    ],
)
def test_a_limit_on_the_page_is_that_of_the_program(row, values):
    (line,) = [text for text in PAGE.splitlines() if text.startswith(f"| {row}")]
    assert all(value in line for value in values), (line, values)

"""``rockshed pile``: what the command asks for, carried out and shown."""

from pathlib import Path

from ...commands.screen import COLD_START, Screen
from ...runs.building import is_cold


def pile(
    screen: Screen,
    results: Path,
    file: Path,
    blows: int | None,
    folder: Path | None,
    with_pictures: bool,
) -> None:
    """Carry out the analysis of a pile and show its tables or JSON. results: folder of the runs that name no other.

    Raises:
        InputRefused: everything that is wrong with the site.
    """
    if is_cold(["Hammer", "PileRod"]):
        screen.note(COLD_START)
    from .carrying_out import carry_out
    from .preparation import prepare
    from .report import lines, tables, warnings

    made = prepare(file, blows)
    done = carry_out(made, folder or results / made.name, screen.counting, with_pictures)
    doubts = list(warnings(done))
    for text in doubts:
        screen.warn(text)
    if screen.as_json:
        screen.dump(
            {
                "status": "complete",
                "folder": str(done.folder),
                "warnings": doubts,
                "figures": [figure.as_entry() for figure in done.figures],
                "pictures": [str(file) for file in done.pictures],
            }
        )
        return
    screen.show(*tables(made, done), "")
    for text in lines(made, done):
        screen.say(text)
    screen.say(
        f"results in {done.folder}"
        + (f", pictures in {done.pictures[0].parent}" if done.pictures else "")
    )

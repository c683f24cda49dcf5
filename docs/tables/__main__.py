"""Fill the tables of README and docs: ``python -m docs.tables [FOLDER ...]``.

FOLDER is that of a finished ``rockshed reproduce PAPER``: what it found takes the place of what is
kept in ``docs/results``. Then every text between ``<!-- table: PAPER/NAME -->`` and
``<!-- end -->`` is written anew from there.
"""

import sys
from pathlib import Path

from rockshed.core.errors import InputRefused

from .filling import PAGES, ROOT, filled
from .kept import NotKeptError, take


def main(folders: list[str]) -> int:
    """Take results over, fill all pages, and return the exit code."""
    try:
        for folder in folders:
            print(f"kept: {take(Path(folder)).relative_to(ROOT)}")
        for page in PAGES:
            text = (ROOT / page).read_text(encoding="utf-8")
            new = filled(text)
            if new != text:
                (ROOT / page).write_text(new, encoding="utf-8")
                print(f"filled: {page}")
    except (NotKeptError, InputRefused) as reason:
        print(reason, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

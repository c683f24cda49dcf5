"""A page with the impact, written to a file."""

import base64
import gzip
import hashlib
import json
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any

from rockshed.components.catalogue import component
from rockshed.components.common.units import standard_gravity
from rockshed.fmus.parts import BuildError
from rockshed.fmus.wasm.module import RowKernel, wasm_modules

from ..core.errors import InputRefused, Problem, all_causes, refusing_unwritable
from ..files import write_file
from ..pictures.style import BEAM as GREEN
from ..pictures.style import FAINT, GREY, INK
from ..pictures.style import ROCK as ORANGE
from ..pictures.style import TRANSMITTED as BLUE
from ..runs.building import Note, silent
from ..runs.chosen import choose
from ..runs.job import look_at_target
from ..runs.request import Request
from ..runs.system import System
from ..versions import version_of
from .impact import REMEDY, SAND, computed, kinds_of, refuse_unfit, start_of
from .offers import Offer, offers_of

_HERE = Path(__file__).parent
GENERATOR = '<meta name="generator" content="rockshed page'
"""Mark in the head of a page by which it is known as one of this program."""
_HEAD = 4096
"""Bytes in which a page says who has made it."""
_CONTACTS = RowKernel("rockshed.components.sand_cushion.reader:list_contacts", 9)
_WORKER = ("cosimulation.js", "worker.js")
_SHOWN = ("drawing.js", "page.js")


def page(
    system: str | Path | System | Request, file: str | Path | None = None, *, note: Note = silent
) -> Path:
    """Write one HTML page that computes an impact in the browser, with the bits of native FMUs.

    Its sliders change rock, height of fall, thickness and sand; it needs no network and no other
    file.

    Parameters
    ----------
    system : str, Path, System or Request
        A case, the project of a rock shed, or a system made of one of these.
    file : str or Path, optional
        The page, by default ``NAME.html`` in the working folder.
    note : callable, optional
        Called with a line for each thing that takes long.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputRefused
        There is no such system, it is no impact of a falling rock on sand, the file cannot be
        written or is no page of this program, or zig is missing.

    Examples
    --------
    ``rockshed.page("lab-impact", "impact.html")`` takes a minute the first time. A page is for a
    rock that strikes sand; other systems are refused before that:

    >>> import rockshed
    >>> rockshed.page("spt")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    rockshed.core.errors.InputRefused: 5 problems:
    ...
    """
    look = None if file is None else partial(_refuse_misplaced, Path(file))
    with all_causes(look):
        offers = _offers(system)
    if file is not None:
        _refuse_misplaced(Path(file))
    first = offers[0].system
    place = Path(f"{first.name}.html") if file is None else Path(file)
    _refuse_misplaced(place)
    note("compiling the kernels for WebAssembly takes a minute the first time")
    try:
        text = _page(first, offers)
    except BuildError as error:
        raise InputRefused([Problem("WebAssembly", str(error))]) from None
    with refusing_unwritable(place, "name another file"):
        write_file(place, text)
    return place


def _offers(system: str | Path | System | Request) -> list[Offer]:
    if isinstance(system, System):
        if system.request is None:
            refuse_unfit(system)
            return [Offer("", 0.0, system)]
        system = system.request
    request = system if isinstance(system, Request) else Request(str(system))
    if choose(request, []).case is None:
        look_at_target(request.target)
        what = "is a system of FMU files, which a page does not have inside"
        raise InputRefused([Problem(request.target, what, REMEDY)])
    found = offers_of(replace(request, in_process=True))
    refuse_unfit(found[0].system)
    return found


def _refuse_misplaced(file: Path) -> None:
    """Refuse a file that is no page, lies in no folder, or is somebody else's."""
    if file.suffix.lower() not in (".html", ".htm"):
        raise InputRefused([Problem(str(file), "is no page", "let its name end in .html")])
    if not file.parent.is_dir():
        raise InputRefused([Problem(str(file.parent), "is no folder", "make it, or name another")])
    if not file.exists():
        return
    with refusing_unwritable(file):
        content = file.read_bytes() if file.is_file() else b""
    if GENERATOR.encode() not in content[:_HEAD]:
        what = "is there, is no page of this program, and would be overwritten"
        raise InputRefused([Problem(str(file), what, "rename it or name another file")])


def _page(first: System, offers: list[Offer]) -> str:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(_HERE),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    script = _joined(_SHOWN)
    return environment.get_template("page.html.j2").render(
        name=first.name,
        description=first.spec.description,
        data=_packed(json.dumps(_data(first, offers))),
        modules=_modules(first),
        worker=_joined(_WORKER),
        script=script,
        style=(_HERE / "page.css").read_text(encoding="utf-8"),
        policy=_policy(script),
        version=version_of("rockshed") or "",
    )


def _data(first: System, offers: list[Offer]) -> dict[str, Any]:
    """Return everything that the scripts of the page read."""
    return {
        **computed(first),
        "offers": [
            {"model": v.model, "thickness": v.thickness, **start_of(v.system)} for v in offers
        ],
        "gravity": standard_gravity,
        "colours": {
            "ink": INK,
            "grey": GREY,
            "faint": FAINT,
            "transmitted": BLUE,
            "on_rock": ORANGE,
            "deflection": GREEN,
        },
    }


def _modules(system: System) -> dict[str, str]:
    """Return the modules of all components by ``component-variant``, compressed."""
    found = {}
    for kind in sorted(set(kinds_of(system).values())):
        tables = {"contacts": _CONTACTS} if kind == SAND else None
        for variant, content in wasm_modules(component(kind), tables).items():
            found[f"{kind}-{variant}"] = _base64(gzip.compress(content, 9, mtime=0))
    return found


@cache
def _joined(names: tuple[str, ...]) -> str:
    return "\n".join((_HERE / name).read_text(encoding="utf-8") for name in names)


def _packed(text: str) -> str:
    """Return a text compressed, in letters that HTML takes for nothing but text."""
    return _base64(gzip.compress(text.encode(), 9, mtime=0))


def _base64(content: bytes) -> str:
    return base64.b64encode(content).decode("ascii")


def _policy(script: str) -> str:
    """Return the policy of the page: its script by its digest, its worker, and no address."""
    allowed = _base64(hashlib.sha256(script.encode()).digest())
    return "; ".join(
        (
            "default-src 'none'",
            f"script-src 'sha256-{allowed}' 'wasm-unsafe-eval' blob:",
            "worker-src blob:",
            "style-src 'unsafe-inline'",
            "base-uri 'none'",
            "form-action 'none'",
        )
    )

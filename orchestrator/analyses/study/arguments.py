"""Arguments of a study, as plain data and back."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...core.results.run_folder import RUN
from ...runs.batch import BranchPoint
from ...runs.cluster import Certificates
from ...runs.request import Request
from .factors import Levels, Varied, varied_as_data, varied_from


@dataclass(frozen=True)
class StudyArguments:
    """Everything that a study follows from; see :func:`rockshed.study`."""

    request: Request
    vary: Mapping[str, Varied]
    design: str | None = None
    samples: int | None = None
    seeds: int = 1
    draw: int = 0
    metrics: Sequence[str] = ()
    percentiles: Sequence[float] | None = None
    workers: int | None = None
    scheduler: str | None = None
    certificates: Certificates | None = None
    pictures: bool = False
    branch: BranchPoint | None = None

    @property
    def files(self) -> list[Path]:
        """File of the system or of the run that is branched, absolute; none of a case."""
        if self.branch is not None:
            return [Path(self.branch.run) / RUN]
        return [Path(self.request.target).absolute()] if self.request.is_file else []

    def as_data(self) -> dict[str, Any]:
        """Return the arguments as plain data that mean the same in any folder."""
        request = self.request.as_data()
        if self.files and self.branch is None:
            request["target"] = str(self.files[0])
        held = self.certificates
        return {
            **vars(self),
            "request": request,
            "vary": {name: varied_as_data(varied) for name, varied in self.vary.items()},
            "certificates": held.as_data() if held else None,
            "branch": vars(self.branch) if self.branch else None,
        }


def arguments_from(data: Mapping[str, Any]) -> StudyArguments:
    """Return the arguments of a study of plain data.

    Parameters
    ----------
    data : mapping
        As :meth:`StudyArguments.as_data` gives it.
    """
    held = data["certificates"]
    branch = data.get("branch")
    return StudyArguments(
        **{
            **data,
            "request": Request(**data["request"]),
            "vary": {name: varied_from(varied) for name, varied in data["vary"].items()},
            "certificates": Certificates(**held) if held else None,
            "branch": BranchPoint(**branch) if branch else None,
        }
    )


def varied(given: Any) -> Varied:
    """Return how a factor varies, of what a user gives: values alone are levels."""
    if isinstance(given, Varied):
        return given
    return Levels(tuple([given] if isinstance(given, str | int | float) else given))

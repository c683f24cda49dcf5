"""Arguments of a rockfall campaign, as plain data and back."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from ...runs.cluster import Certificates
from ...sites.rockfall.preparation import PreparedSlope
from ...sites.source import SiteLike


@dataclass(frozen=True)
class CampaignArguments:
    """Everything that a campaign follows from; see :func:`rockshed.rockfall`."""

    site: SiteLike
    trials: int | None = None
    seed: int | None = None
    workers: int | None = None
    scheduler: str | None = None
    certificates: Certificates | None = None
    replay: Sequence[int] = ()
    trajectories: int | Literal["all"] = 0
    animation: str | None = None
    pictures: bool = False

    def as_data(self, slope: PreparedSlope) -> dict[str, Any]:
        """Return the arguments as plain data that mean the same in any folder.

        Parameters
        ----------
        slope : PreparedSlope
            Of the site.
        """
        held = self.certificates
        return {
            **vars(self),
            "site": slope.source.plain(),
            "replay": list(self.replay),
            "certificates": held.as_data() if held else None,
        }


def campaign_arguments_from(data: Mapping[str, Any]) -> CampaignArguments:
    """Return the arguments of a campaign of plain data.

    Parameters
    ----------
    data : mapping
        As :meth:`CampaignArguments.as_data` gives it.
    """
    held = data["certificates"]
    return CampaignArguments(**{**data, "certificates": Certificates(**held) if held else None})

"""The page about the experiments inside an FMU."""

from collections.abc import Sequence
from html import escape

from rockshed.components.common.component import Component

from ..description.documentation import page, table
from .declaration import Experiment


def experiments_html(component: Component, experiments: Sequence[Experiment]) -> str:
    """Return the page.

    Parameters
    ----------
    component : Component
        The component.
    experiments : sequence of Experiment
        Those inside its FMU.

    Returns
    -------
    str
        HTML.
    """
    body = (
        f"<h1>{escape(component.title)}: experiments</h1>\n"
        "<p>Each is done on the FMU alone. Inputs are set at every communication point and held "
        "over the step that begins there. What has to come out is known beforehand; the largest "
        "deviation that is right stands with each output.</p>\n"
    )
    for one in experiments:
        units = {variable.name: variable.unit for variable in component.layout.variables}
        body += (
            f"<h2>{escape(one.name)}</h2>\n<p><b>{one.purpose}</b>, {one.steps} steps of "
            f"{one.step:.6g} s. {escape(one.description)}</p>\n"
        )
        body += table(
            ("output", "unit", "largest expected", "tolerance"),
            (
                (
                    name,
                    units[name],
                    f"{float(abs(one.references[name]).max()):.6g}",
                    f"{expected.tolerance:.3g}",
                )
                for name, expected in one.expected.items()
            ),
        )
    return page(f"{component.title}: experiments", body)

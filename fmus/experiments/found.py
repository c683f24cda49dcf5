"""The experiments of a component, wherever they are declared."""

from importlib import import_module
from pathlib import Path

from rockshed.components.common.component import Component
from rockshed.components.common.ports import Causality, Sizes

from ..parts import COMPONENTS, EXPERIMENTS, BuildError
from .declaration import Experiment

_HERE = Path(__file__).parent


def experiments_of(component: Component, sizes: Sizes) -> tuple[Experiment, ...]:
    """Return the experiments that an FMU of a component carries.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.

    Returns
    -------
    tuple of Experiment
        Those of ``experiments(sizes)`` in the module ``experiments`` of the component's folder, or
        for our components in this package; empty where there are none for these sizes.

    Raises
    ------
    BuildError
        An experiment names what the component has not.
    """
    folder = component.folder
    if (folder / EXPERIMENTS).is_file():
        module = f"{component.kernels.rpartition('.')[0]}.{Path(EXPERIMENTS).stem}"
    elif folder.parent == COMPONENTS and (_HERE / f"{folder.name}.py").is_file():
        module = f"{__package__}.{folder.name}"
    else:
        return ()
    found: tuple[Experiment, ...] = import_module(module).experiments(sizes)
    if problems := [each for one in found for each in _problems(one, component)]:
        raise BuildError(f"{component.name}: {'; '.join(problems)}")
    return found


def _problems(experiment: Experiment, component: Component) -> list[str]:
    """Return in words what an experiment names that the component has not."""
    known = {variable.name: variable.causality for variable in component.layout.variables}
    named = {
        Causality.PARAMETER: experiment.parameters,
        Causality.INPUT: experiment.inputs,
        Causality.OUTPUT: experiment.expected,
    }
    return [
        f"its experiment {experiment.name} names the {causality} {name}, and there is none"
        for causality, names in named.items()
        for name in names
        if known.get(name) is not causality
    ]

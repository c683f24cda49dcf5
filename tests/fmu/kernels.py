"""Experiments carried out on kernels, without FMI."""

import numpy as np


def put(instance, experiment, time):
    """Set the inputs that an experiment has at a time."""
    for name, stimulus in experiment.inputs.items():
        if callable(stimulus):
            instance[name] = stimulus(time)
        elif isinstance(stimulus, tuple | list):
            instance[name] = [each(time) if callable(each) else each for each in stimulus]
        else:
            instance[name] = stimulus


def course(component, sizes, experiment):
    """Values of the outputs that are expected, a row for each time of comparison."""
    instance = component.instance(**sizes)
    for name, value in experiment.parameters.items():
        instance[name] = value
    rows = {name: [] for name in experiment.expected}
    put(instance, experiment, 0.0)
    instance.initialise()
    for number in range(experiment.steps + 1):
        if number >= experiment.first and (number - experiment.first) % experiment.every == 0:
            for name, found in rows.items():
                found.append(np.copy(instance[name]))
        if number < experiment.steps:
            put(instance, experiment, number * experiment.step)
            instance.step(number * experiment.step, experiment.step)
    return {name: np.array(found) for name, found in rows.items()}


def missed(component, sizes, experiment):
    """Outputs that are not within their tolerances, with the largest deviation over the tolerance; or what was refused."""
    try:
        rows = course(component, sizes, experiment)
    except Exception as error:
        if type(error).__name__ != "ComponentError":  # there are several, of copies of the package
            raise
        return {"refused": str(error)}
    found = {}
    for name, expected in experiment.expected.items():
        deviation = np.abs(rows[name] - experiment.references[name]).max()
        if not deviation <= expected.tolerance:
            found[name] = deviation
    return found

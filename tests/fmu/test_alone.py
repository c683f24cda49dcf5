"""Our native FMUs alone, of both versions of FMI, with inputs from a table."""

import numpy as np

import rockshed

OPTIONS = {"stop_time": 0.02, "step_size": 1e-3}


def test_fmi_3_gives_the_bits_of_fmi_2(native_fmus, fmi3_fmus):
    push = {"time": [0.0, 0.01, 0.01, 0.02], "force.x": [0.0, 5.0, -5.0, 3.0]}
    two, three = (
        rockshed.simulate(rockshed.alone(fmus["FallingRock"], push, **OPTIONS))
        for fmus in (native_fmus, fmi3_fmus)
    )
    assert list(two) == list(three)
    assert all(np.array_equal(two[name], three[name]) for name in two)
    assert two["input.force.x"].unit == "N"


def test_an_element_of_an_array_of_fmi_3_is_a_column(fmi3_fmus):
    load = {"time": [0.0, 0.02], "force.y[12]": [0.0, -1e3]}
    run = rockshed.simulate(rockshed.alone(fmi3_fmus["RBSMBeam"], load, **OPTIONS))
    assert run["RBSMBeam.midspan.deflection"][-1] != 0.0

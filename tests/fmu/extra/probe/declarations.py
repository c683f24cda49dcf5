"""Variables of the probe."""

from rockshed.components.common.ports import Layout, State, choice, count, inp, out, param, switch
from rockshed.components.common.stepping import internal_step, stable_step

OVERFLOW, INFLOW_AT_START = 1, 2

LAYOUT = Layout(
    variables=(
        param(
            "limit",
            "highest level allowed, 100 % full",
            10.0,
            "m",
            minimum=0.1,
            maximum=100.0,
            source="made up",
        ),
        choice("leak", "how a tank leaks", ("none", "linear"), "linear"),
        switch("counting", "whether steps are counted", True),
        count("first_count", "number the count starts from", 2, minimum=0, maximum=9),
        internal_step(0.01),
        param(
            "level0",
            "level of each tank at the start",
            lambda i, sizes: i / sizes["tanks"],
            "m",
            size="tanks",
        ),
        inp("inflow", "rise of the level by what flows into every tank", "m/s"),
        inp("valve", "opening of the common valve", "1", start=1.0, minimum=0.0, maximum=1.0),
        inp("extra", "rise of the level by what flows into this tank besides", "m/s", size="tanks"),
        out("count", "number of steps", initial_dependencies=("first_count",)),
        out(
            "flow",
            "inflow through the valve, at the start of the step",
            "m/s",
            initial_dependencies=("inflow", "valve"),
        ),
        out("level", "level of each tank", "m", size="tanks", initial_dependencies=("level0",)),
        out(
            "initialisations",
            "how often the state at the start was computed",
            initial_dependencies=(),
        ),
        stable_step(),
    ),
    states=(
        State("hidden.level", lambda sizes: sizes["tanks"]),
        State("hidden.count", lambda sizes: 2, integer=True),
    ),
)

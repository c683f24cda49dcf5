"""Variables of the relay, which the benchmark of exchanges couples twice."""

from rockshed.components.common.ports import Layout, inp, out

LAYOUT = Layout(
    (
        inp("u", "what it is given", size="inputs"),
        out("y", "half of one of the inputs and one", size="outputs"),
    )
)

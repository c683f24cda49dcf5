"""Times of a run as whole ticks: whether the steps of a system fit together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..errors import Problem
from .clock import to_seconds, to_ticks
from .schedule import fits, nearest_steps
from .system import SystemSpec


@dataclass(frozen=True)
class Timing:
    """Times of a run.

    Attributes
    ----------
    start, exchange : int
        Time at the start and exchange step (ticks).
    exchanges : int
        Length of the run (exchanges).
    output_every, state_every : int
        Intervals of rows and of states (exchanges).
    steps : mapping of str to int
        Communication step of each component (ticks).
    """

    start: int
    exchange: int
    exchanges: int
    output_every: int
    state_every: int
    steps: Mapping[str, int]

    def seconds(self, exchange: int) -> float:
        """Return the time (s) at the beginning of an exchange."""
        return to_seconds(self.start + exchange * self.exchange)


def make_timing(system: SystemSpec, problems: list[Problem]) -> Timing | None:
    """Turn every time of a system into whole ticks.

    Parameters
    ----------
    system : SystemSpec
        Times in s.
    problems : list of Problem
        Gets the reasons where steps and times do not fit together.

    Returns
    -------
    Timing or None
        None where a time is no whole number of ticks.
    """
    ticks = _all_ticks(system, problems)
    if ticks is None:
        return None
    exchange = ticks["exchange_step"]
    steps = {name: ticks.get(f"{name}.step", exchange) for name in system.components}
    misfits = _misfits(system, ticks, steps)
    problems += misfits
    length = ticks["stop_time"] - ticks["start_time"]
    return Timing(
        start=ticks["start_time"],
        exchange=exchange,
        exchanges=length // exchange,
        output_every=ticks["output_interval"] // exchange,
        state_every=ticks["state_interval"] // exchange,
        steps=steps,
    )


def _all_ticks(system: SystemSpec, problems: list[Problem]) -> dict[str, int] | None:
    before = len(problems)
    times = {
        "exchange_step": system.exchange_step,
        "start_time": system.start_time,
        "stop_time": system.stop_time,
        "output_interval": system.output_interval or system.exchange_step,
        "state_interval": system.state_interval or system.exchange_step,
        **{f"{name}.step": spec.step for name, spec in system.components.items() if spec.step},
    }
    ticks = {key: _ticks(key, seconds, problems) for key, seconds in times.items()}
    return ticks if len(problems) == before else None


def _misfits(
    system: SystemSpec, ticks: Mapping[str, int], steps: Mapping[str, int]
) -> list[Problem]:
    """Find steps and times that do not fit together, and a set of times that does."""
    exchange = ticks["exchange_step"]
    start = ticks["start_time"]
    length = ticks["stop_time"] - start
    problems = [
        problem
        for name, step in steps.items()
        for problem in _step_problems(f"{name}.step", step, exchange)
    ]
    if length <= 0:
        what = f"{system.stop_time:g} s is not after start_time = {system.start_time:g} s"
        problems.append(Problem("stop_time", what, "let it be later"))
    fitting = {key: _nearest(ticks[key], exchange) for key in ("output_interval", "state_interval")}
    for key, near in fitting.items():
        problems += _multiple_problems(key, ticks[key], exchange, near, 0)
    longest = max(exchange, *steps.values())
    fitting["stop_time"] = _nearest(length, longest) if length > 0 else []
    problems += _multiple_problems("stop_time", length, longest, fitting["stop_time"], start)
    wrong = {key: near[0] for key, near in fitting.items() if near}
    if len(wrong) > 1 and len(problems) == len(wrong):
        problems.append(_together(exchange, start, wrong))
    return problems


def _together(exchange: int, start: int, nearest: Mapping[str, int]) -> Problem:
    """Name times that fit the exchange step all at once."""
    origin = {"stop_time": start}
    times = {key: origin.get(key, 0) + near for key, near in nearest.items()}
    listed = ", ".join(
        f"{key} = {to_seconds(value):.12g}"
        for key, value in {"exchange_step": exchange, **times}.items()
    )
    return Problem("exchange_step", "does not fit these times", f"this will do: {listed}")


def _ticks(key: str, seconds: float, problems: list[Problem]) -> int:
    try:
        return to_ticks(seconds)
    except ValueError as error:
        problems.append(
            Problem(
                key,
                str(error),
                "make it shorter" if seconds > 1.0 else "round it to 1e-12 s or multiples of it",
            )
        )
        return 0


def _step_problems(key: str, step: int, exchange: int) -> list[Problem]:
    if fits(step, exchange):
        return []
    near = " or ".join(f"{to_seconds(s):g} s" for s in nearest_steps(step, exchange))
    return [
        Problem(
            key,
            f"{to_seconds(step):g} s neither divides the exchange step {to_seconds(exchange):g} s "
            "nor is a whole multiple of it",
            f"nearest are {near}",
        )
    ]


def _nearest(length: int, step: int) -> list[int]:
    """Return the whole numbers of steps (ticks) around a length that is none."""
    if length % step == 0:
        return []
    return [n * step for n in (length // step, length // step + 1) if n > 0]


def _multiple_problems(
    key: str, length: int, step: int, near: Sequence[int], origin: int
) -> list[Problem]:
    if not near:
        return []
    after = f" after {to_seconds(origin):g} s" if origin else ""
    return [
        Problem(
            key,
            f"{to_seconds(origin + length):g} s is no whole number of steps of "
            f"{to_seconds(step):g} s{after}",
            f"nearest {'is' if len(near) == 1 else 'are'} "
            + " or ".join(f"{to_seconds(origin + n):.12g} s" for n in near),
        )
    ]

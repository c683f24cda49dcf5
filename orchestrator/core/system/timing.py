"""Times of a run as whole ticks: whether the steps of a system fit together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..errors import Problem
from .clock import to_seconds, to_ticks
from .schedule import fits, nearest_steps
from .system import System


@dataclass(frozen=True)
class Timing:
    """Start, exchange step and communication steps in ticks; length of the run and intervals of its results in exchanges."""

    start: int
    exchange: int
    exchanges: int
    output_every: int
    state_every: int
    steps: Mapping[str, int]

    def seconds(self, exchange: int) -> float:
        """Time (s) at the beginning of this exchange."""
        return to_seconds(self.start + exchange * self.exchange)


def make_timing(system: System, problems: list[Problem]) -> Timing | None:
    """Whole ticks for every time; None, and the reasons in ``problems``, where that is not possible."""
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
    if len(problems) > before:
        return None
    exchange, start, length = (
        ticks["exchange_step"],
        ticks["start_time"],
        ticks["stop_time"] - ticks["start_time"],
    )
    steps = {name: ticks.get(f"{name}.step", exchange) for name in system.components}
    for name, step in steps.items():
        problems += _step_problems(f"{name}.step", step, exchange)
    if length <= 0:
        problems.append(
            Problem(
                "stop_time",
                f"{system.stop_time:g} s is not after start_time = {system.start_time:g} s",
                "let it be later",
            )
        )
    fitting = {key: _nearest(ticks[key], exchange) for key in ("output_interval", "state_interval")}
    for key, near in fitting.items():
        problems += _multiple_problems(key, ticks[key], exchange, near, 0)
    longest = max(exchange, *steps.values())
    fitting["stop_time"] = _nearest(length, longest) if length > 0 else []
    problems += _multiple_problems("stop_time", length, longest, fitting["stop_time"], start)
    wrong = {key: near for key, near in fitting.items() if near}
    if len(wrong) > 1 and len(problems) - before == len(wrong):
        origin = {"stop_time": start}
        together = {
            "exchange_step": exchange,
            **{key: origin.get(key, 0) + near[0] for key, near in wrong.items()},
        }
        problems.append(
            Problem(
                "exchange_step",
                "does not fit these times",
                "this will do: "
                + ", ".join(f"{key} = {to_seconds(value):.12g}" for key, value in together.items()),
            )
        )
    return Timing(
        start,
        exchange,
        length // exchange,
        ticks["output_interval"] // exchange,
        ticks["state_interval"] // exchange,
        steps,
    )


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
            f"{to_seconds(step):g} s neither divides the exchange step {to_seconds(exchange):g} s nor is a whole "
            "multiple of it",
            f"nearest are {near}",
        )
    ]


def _nearest(length: int, step: int) -> list[int]:
    """The whole numbers of steps (ticks) around a length that is none; nothing if it is one."""
    return (
        []
        if length % step == 0
        else [n * step for n in (length // step, length // step + 1) if n > 0]
    )


def _multiple_problems(
    key: str, length: int, step: int, near: Sequence[int], origin: int
) -> list[Problem]:
    if not near:
        return []
    after = f" after {to_seconds(origin):g} s" if origin else ""
    return [
        Problem(
            key,
            f"{to_seconds(origin + length):g} s is no whole number of steps of {to_seconds(step):g} s{after}",
            f"nearest {'is' if len(near) == 1 else 'are'} "
            + " or ".join(f"{to_seconds(origin + n):.12g} s" for n in near),
        )
    ]

"""Times of a run as whole ticks: whether the steps of a system fit together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm

import numpy as np
from numpy.typing import NDArray

from ..errors import Problem
from .clock import exact, fraction_near, ticks_per_second, to_seconds, to_ticks
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
    rate : int
        Ticks in a second.
    longest : int
        Most exchange steps that are made in one; a power of two.
    window : int
        Exchanges that the implicit master iterates together.
    """

    start: int
    exchange: int
    exchanges: int
    output_every: int
    state_every: int
    steps: Mapping[str, int]
    rate: int
    longest: int = 1
    window: int = 1

    def seconds(self, exchange: int) -> float:
        """Return the time (s) at the beginning of an exchange."""
        return self.lasts(self.start + exchange * self.exchange)

    def moments(self, exchanges: Sequence[int]) -> NDArray[np.float64]:
        """Return the times (s) at the beginning of exchanges, the bits of :meth:`seconds`."""
        ticks = self.start + self.exchange * np.array(exchanges, np.int64)
        return ticks.astype(np.float64) / float(self.rate)

    def lasts(self, ticks: int) -> float:
        """Return a length of time in s."""
        return to_seconds(ticks, self.rate)


def exchanges_in(timing: Timing, seconds: float) -> int | None:
    """Return the number of exchanges that a length of time has.

    Parameters
    ----------
    timing : Timing
        Of the run.
    seconds : float
        Length of time (s).

    Returns
    -------
    int or None
        None where it is no whole number, or no time at all.
    """
    try:
        number = exact(seconds) * timing.rate / timing.exchange
    except (ValueError, ArithmeticError):
        return None
    return int(number) if number.denominator == 1 else None


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
    times = _exact_times(system, problems)
    if times is None:
        return None
    rate = ticks_per_second(times.values())
    ticks = {key: _ticks(key, time, rate, problems) for key, time in times.items()}
    if any(count is None for count in ticks.values()):
        return None
    return _fitted(system, {key: count or 0 for key, count in ticks.items()}, rate, problems)


def _fitted(
    system: SystemSpec, ticks: Mapping[str, int], rate: int, problems: list[Problem]
) -> Timing:
    exchange = ticks["exchange_step"]
    steps = {name: ticks.get(f"{name}.step", exchange) for name in system.components}
    problems += _misfits(system, ticks, steps, rate)
    length = ticks["stop_time"] - ticks["start_time"]
    return Timing(
        start=ticks["start_time"],
        exchange=exchange,
        exchanges=length // exchange,
        output_every=ticks["output_interval"] // exchange,
        state_every=ticks["state_interval"] // exchange,
        steps=steps,
        rate=rate,
        longest=max(1, ticks.get("adaptive.largest_step", exchange) // exchange),
        window=_window(system, ticks, steps),
    )


_WINDOW = "iteration.window"


def _window(system: SystemSpec, ticks: Mapping[str, int], steps: Mapping[str, int]) -> int:
    """Return the exchanges after which all components have come to the end of a window."""
    if system.master != "implicit":
        return 1
    exchange = ticks["exchange_step"]
    lengths = [ticks.get(_WINDOW, exchange), *steps.values()]
    return lcm(*(max(1, length // exchange) for length in lengths))


def _exact_times(system: SystemSpec, problems: list[Problem]) -> dict[str, Fraction] | None:
    times = {
        "exchange_step": system.exchange_step,
        "start_time": system.start_time,
        "stop_time": system.stop_time,
        "output_interval": system.output_interval or system.exchange_step,
        "state_interval": system.state_interval or system.exchange_step,
        **({"adaptive.largest_step": system.adaptive.largest_step} if system.adaptive else {}),
        **_window_asked(system),
        **{f"{name}.step": spec.step for name, spec in system.components.items() if spec.step},
    }
    found = {}
    for key, seconds in times.items():
        try:
            found[key] = exact(seconds)
        except ValueError as error:
            remedy = 'round it to 1e-12 s or multiples of it, or write a fraction, "1/60"'
            problems.append(Problem(key, str(error), remedy))
    return found if len(found) == len(times) else None


def _window_asked(system: SystemSpec) -> dict[str, float]:
    asked = system.iteration.window if system.master == "implicit" else None
    return {} if asked is None else {_WINDOW: asked}


def _ticks(key: str, time: Fraction, rate: int, problems: list[Problem]) -> int | None:
    try:
        return to_ticks(time, rate)
    except ValueError as error:
        problems.append(Problem(key, str(error), "make it shorter"))
        return None


def _misfits(
    system: SystemSpec, ticks: Mapping[str, int], steps: Mapping[str, int], rate: int
) -> list[Problem]:
    """Find steps and times that do not fit together, and a set of times that does."""
    exchange = ticks["exchange_step"]
    start = ticks["start_time"]
    length = ticks["stop_time"] - start
    problems = [
        *_longest_problems(ticks.get("adaptive.largest_step"), exchange, rate),
        *_window_problems(ticks.get(_WINDOW), max(exchange, *steps.values()), rate),
        *(
            problem
            for name, step in steps.items()
            for problem in _step_problems(f"{name}.step", step, exchange, rate)
        ),
    ]
    if length <= 0:
        what = f"{system.stop_time:g} s is not after start_time = {system.start_time:g} s"
        problems.append(Problem("stop_time", what, "let it be later"))
    lengths = {key: ticks[key] for key in ("output_interval", "state_interval")}
    fitting = {key: _nearest(lengths[key], exchange) for key in lengths}
    for key, near in fitting.items():
        problems += _multiple_problems(key, (0, lengths[key]), exchange, near, rate)
    longest = max(exchange * _window(system, ticks, steps), *steps.values())
    fitting["stop_time"] = _nearest(length, longest) if length > 0 else []
    problems += _multiple_problems(
        "stop_time", (start, length), longest, fitting["stop_time"], rate
    )
    wrong = {key: near[0] for key, near in fitting.items() if near}
    if len(wrong) > 1 and len(problems) == len(wrong):
        problems.append(_together(exchange, start, wrong, rate))
    return problems


def _together(exchange: int, start: int, nearest: Mapping[str, int], rate: int) -> Problem:
    """Name times that fit the exchange step all at once."""
    origin = {"stop_time": start}
    times = {key: origin.get(key, 0) + near for key, near in nearest.items()}
    listed = ", ".join(
        f"{key} = {to_seconds(value, rate):.12g}"
        for key, value in {"exchange_step": exchange, **times}.items()
    )
    return Problem("exchange_step", "does not fit these times", f"this will do: {listed}")


def _longest_problems(longest: int | None, exchange: int, rate: int) -> list[Problem]:
    """Refuse a longest step (ticks) that is not 2, 4, 8, ... times the exchange step."""
    if longest is None:
        return []
    times, rest = divmod(longest, exchange)
    if not rest and times > 1 and times & (times - 1) == 0:
        return []
    power = 1 << max(1, times.bit_length() - 1)
    near = " or ".join(f"{to_seconds(exchange * n, rate):.12g} s" for n in (power, 2 * power))
    what = (
        f"{to_seconds(longest, rate):g} s is not 2, 4, 8, ... times the exchange step "
        f"{to_seconds(exchange, rate):g} s, which is the smallest step"
    )
    return [Problem("adaptive.largest_step", what, f"nearest are {near}")]


def _window_problems(window: int | None, longest: int, rate: int) -> list[Problem]:
    """Refuse a window (ticks) that is no multiple of the longest step."""
    if window is None:
        return []
    return _multiple_problems(_WINDOW, (0, window), longest, _nearest(window, longest), rate)


def _step_problems(key: str, step: int, exchange: int, rate: int) -> list[Problem]:
    if fits(step, exchange):
        return []
    near = " or ".join(f"{to_seconds(s, rate):g} s" for s in nearest_steps(step, exchange))
    return [
        Problem(
            key,
            f"{to_seconds(step, rate):g} s neither divides the exchange step "
            f"{to_seconds(exchange, rate):g} s nor is a whole multiple of it",
            f"nearest are {near}",
        )
    ]


def _nearest(length: int, step: int) -> list[int]:
    """Return the whole numbers of steps (ticks) around a length that is none."""
    if length % step == 0:
        return []
    return [n * step for n in (length // step, length // step + 1) if n > 0]


def _multiple_problems(
    key: str, span: tuple[int, int], step: int, near: Sequence[int], rate: int
) -> list[Problem]:
    """Refuse a length, told with its beginning, that is no whole number of steps (ticks)."""
    if not near:
        return []
    origin, length = span
    after = f" after {to_seconds(origin, rate):g} s" if origin else ""
    meant = fraction_near(to_seconds(step, rate))
    return [
        Problem(
            key,
            f"{to_seconds(origin + length, rate):g} s is no whole number of steps of "
            f"{to_seconds(step, rate):g} s{after}",
            f"nearest {'is' if len(near) == 1 else 'are'} "
            + " or ".join(f"{to_seconds(origin + n, rate):.12g} s" for n in near)
            + (f'; if the step is meant to be a fraction, write "{meant}"' if meant else ""),
        )
    ]

"""What a summary says of an output: one table, which documents, arrays, sweeps and pages go through.

A statistic is one entry here, and where `wavesym.results.summary` finds it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from math import nan
from typing import NamedTuple

from wavesym.fields.table import show
from wavesym.results.presentation import number_text, readable_unit


class OutputTime(NamedTuple):
    """`tau`, and the `time` in the scene's unit; None where it has none."""

    tau: float
    time: float | None

    @property
    def in_scene_time(self) -> float:
        """The time of a scene that has units, else tau."""
        return self.tau if self.time is None else self.time


@dataclass(frozen=True)
class Peak:
    """A `value` in the output's unit, and the first instant `at` which it is taken.

    Where it is not `reached` the output comes up to it and jumps at that instant.
    """

    value: float
    at: OutputTime
    reached: bool = True


@dataclass(frozen=True)
class OutputSummary:
    """An output, its least and its greatest value, when it first differs from 0 (None: not on the horizon), its mean
    and root mean square over the horizon, and its value at the end."""

    name: str
    unit: str
    min: Peak
    max: Peak
    arrival: OutputTime | None
    mean: float = 0.0
    rms: float = 0.0
    residual: float = 0.0
    title: str = ""

    @property
    def label(self) -> str:
        """What people are shown: its title, or its name."""
        return self.title or self.name

    @property
    def readable(self) -> OutputSummary:
        """The same in the unit that people write for values so large: forces in kN, not in N."""
        size, unit = readable_unit(self.largest.value, self.unit)
        if size == 1:
            return self
        return replace(
            self,
            unit=unit,
            min=replace(self.min, value=self.min.value / size),
            max=replace(self.max, value=self.max.value / size),
            mean=self.mean / size,
            rms=self.rms / size,
            residual=self.residual / size,
        )

    @property
    def largest(self) -> Peak:
        """The one of `min` and `max` with the larger absolute value, and of equal ones the first."""
        return min(self.min, self.max, key=lambda peak: (-abs(peak.value), peak.at.tau))


@dataclass(frozen=True)
class Statistic:
    """A number of an output, an instant, or both.

    Attributes:
        name: in JSON, in arrays and in sweeps; the instant of a value is `tau_` and the name there.
        heading: of its column, for people.
        about: what it is, in words.
        value: the number, in the output's unit, None for what has none.
        when: the instant, None for what has none.
        is_reached: whether the output takes the value, else it comes up to it and jumps.
        runtime: whether programs with parameters at run time, and records of one structure, have it too.
    """

    name: str
    heading: str
    about: str
    value: Callable[[OutputSummary], float] | None = None
    when: Callable[[OutputSummary], OutputTime | None] | None = None
    is_reached: Callable[[OutputSummary], bool] = lambda _: True
    runtime: bool = False

    @property
    def arrays(self) -> dict[str, str]:
        """The arrays that it fills, by name, and what they are."""
        if self.value is None:
            return {self.name: f"tau at which {self.about}"}
        return {self.name: self.about, **({f"tau_{self.name}": f"tau of the {self.about}"} if self.when else {})}

    def numbers(self, output: OutputSummary) -> list[float]:
        """The numbers of an output in these arrays, NaN for an instant that there is not."""
        found = [] if self.value is None else [self.value(output)]
        if self.when is not None:
            at = self.when(output)
            found.append(nan if at is None else at.tau)
        return found


STATISTICS = (
    Statistic("min", "least", "least value", lambda o: o.min.value, lambda o: o.min.at, lambda o: o.min.reached, True),
    Statistic(
        "max", "greatest", "greatest value", lambda o: o.max.value, lambda o: o.max.at, lambda o: o.max.reached, True
    ),
    Statistic("arrival", "arrives", "it first differs from 0", when=lambda o: o.arrival),
    Statistic("mean", "mean", "mean over the horizon", lambda o: o.mean),
    Statistic("rms", "rms", "root mean square over the horizon", lambda o: o.rms),
    Statistic("residual", "at the end", "value at the end of the horizon", lambda o: o.residual),
)

_EVERY = {name: about for statistic in STATISTICS for name, about in statistic.arrays.items()}
_RUNTIME = [each.name for each in STATISTICS if each.runtime]
RUNTIME_ARRAYS = (*_RUNTIME, *(f"tau_{name}" for name in _RUNTIME))
"""The arrays that programs with parameters at run time have, too."""
ARRAYS = {name: _EVERY[name] for name in (*RUNTIME_ARRAYS, *_EVERY)}
"""The arrays of all statistics, and what they are."""


LINK_ARRAYS = {"set": "permanent set of a link that yields or rubs, positive where it is longer"}
"""The arrays that sweeps may have of links, not of outputs, and what they are."""


def wrong_statistic(names: Sequence[object], known: Collection[str] = tuple(ARRAYS)) -> tuple[str, int] | None:
    """What is wrong with the first of some names that is no array, or stands twice, and its place; None for none."""
    for k, name in enumerate(names):
        if name not in known:
            *others, last = known
            return f"{show(name)} is not a statistic; write {', '.join(others)} or {last}", k
        if name in names[:k]:
            return f"{show(name)} stands twice; write it once", k
    return None


def array_values(output: OutputSummary) -> dict[str, float]:
    """Of one output the numbers of all arrays."""
    return {
        name: number
        for statistic in STATISTICS
        for name, number in zip(statistic.arrays, statistic.numbers(output), strict=True)
    }


def headings(clock: str, behind: str = "") -> tuple[str, ...]:
    """What stands above the columns of `cells`; `clock` above instants of values, and `behind` other instants."""
    found = []
    for each in STATISTICS:
        found += [each.heading, *([clock] if each.when else [])] if each.value else [each.heading + behind]
    return tuple(found)


def cells(output: OutputSummary, jumps: str, digits: int = 7) -> tuple[str, ...]:
    """An output's numbers as people read them; `jumps` stands behind the instant of a value that is not reached."""
    found = []
    for each in STATISTICS:
        if each.value is not None:
            found.append(number_text(each.value(output), digits=digits))
        if each.when is not None:
            at = each.when(output)
            time = "never" if at is None else number_text(at.in_scene_time, digits=digits)
            found.append(time + jumps * (not each.is_reached(output)))
    return tuple(found)

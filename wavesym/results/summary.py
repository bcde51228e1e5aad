"""What a user asks of outputs first: the least and the greatest value of each, when, and when it begins to move."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from flint import fmpq

from wavesym.errors import CostError, ToleranceError, UnservedError, WavesymError
from wavesym.exact.extremes import BOUND, NOTHING, Range, TrueExtreme, extremes_and_averages
from wavesym.exact.first_arrivals import first_arrivals, light_arrivals
from wavesym.exact.joints.fronts import has_more_fronts
from wavesym.mechanics.model import Labels, Model
from wavesym.mechanics.probe import Probe, with_unit
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import midpoint, nearest, not_below, rational
from wavesym.programs.making import make
from wavesym.programs.program import Program
from wavesym.results.link_losses import LinkSummary, link_summaries
from wavesym.results.optional import require_packages
from wavesym.results.presentation import align_columns, html_table, number_text, output_number
from wavesym.results.response import Response
from wavesym.results.sampling import sampled_extremes
from wavesym.results.statistics import STATISTICS, OutputSummary, OutputTime, Peak, cells, headings
from wavesym.results.stepping import describe_step, sample_program, spacing

_MOST_SAMPLES = 8_000_000
_MOST_DRIFTS = 50  # rods in which the largest is looked for, though nobody asked for them
_MOST_FRONTS = 60_000  # for these; where contacts open and close: seconds, beside those for the outputs
_MOST_ERROR = 0.01  # of a drift that is told


@dataclass(frozen=True, repr=False)
class Summary:
    """The extremes of a scene's outputs; `wavesym.summary` makes it. `summary[NAME]` is one of `outputs`.

    `bound` is that of the error of values, relative to each output's largest. Where it is `proved` that no value lies
    beyond an extreme it holds for the extremes, else only for what outputs are at these instants. `how` says how they
    were found. `largest_drift` is that of the rod, of all in the main line, whose drift is the largest; None where it
    was not asked for, no rod changes, or `drifts_cost_too_much`; its bound is `drift_bound`, as what nobody asked for
    need not meet the tolerance. `time_unit` is None for a scene without units. `links` are those with friction and the
    springs that yield; None where they would cost too much. `shapes` of `labels` are the loads that act as straight
    lines: the error of these is in no bound.
    """

    name: str
    outputs: tuple[OutputSummary, ...]
    bound: float
    proved: bool
    how: str
    time_unit: str | None
    largest_drift: OutputSummary | None = None
    drifts_cost_too_much: bool = False
    links: tuple[LinkSummary, ...] | None = ()
    drift_bound: float = 0.0
    labels: Labels | None = None

    def __getitem__(self, name: str) -> OutputSummary:
        return self.outputs[output_number(name, [output.name for output in self.outputs], self.name)]

    def __repr__(self) -> str:
        count = len(self.outputs)
        return f"Summary({self.name!r}, {count} output{'s' * (count != 1)}, {self.how}: {self.accuracy})"

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        """A table of the outputs, and a line for what else there is to know, as `wavesym summary` prints them."""
        clock = "tau" if self.time_unit is None else f"time [{self.time_unit}]"
        shown = [output.readable for output in self.outputs]
        rows = ((with_unit(output.label, output.unit), *cells(output, "-")) for output in shown)
        yield from align_columns([("output", *headings(clock)), *rows])
        yield ""
        if not all(peak.reached for output in self.outputs for peak in (output.min, output.max)):
            yield "-  it comes up to this value, and jumps then"
        if (drift := self.largest_drift) is not None:
            peak, when = drift.largest, number_text(drift.largest.at.in_scene_time, self.time_unit or "")
            yield f"largest drift: {drift.label}, {number_text(peak.value, drift.unit)} at {when}{self.drift_accuracy}"
        if self.drifts_cost_too_much:
            yield "the largest drift would cost too much (drifts as outputs help)"
        yield from map(str, self.links or ())
        yield from self.notes
        if self.links is None:
            yield "sets and what is dissipated would cost too much (a shorter horizon helps)"
        yield f"{self.how}: {self.accuracy}"

    def _rows(self) -> list[dict[str, Any]]:
        """A row for each output, by the names of columns."""
        time = "tau" if self.time_unit is None else f"time [{self.time_unit}]"
        rows = []
        for output in self.outputs:
            row: dict[str, Any] = {"output": output.name, "unit": output.unit}
            for each in STATISTICS:
                if each.value is not None:
                    row[each.name] = each.value(output)
                if each.when is not None:
                    at = each.when(output)
                    row[f"{each.name} at {time}" if each.value else f"{each.name}, {time}"] = (
                        None if at is None else at.in_scene_time
                    )
            rows.append(row)
        return rows

    def to_pandas(self) -> Any:
        """A pandas.DataFrame with a row for each output. WavesymError where pandas is not installed."""
        return require_packages("pandas", "sweep").DataFrame(self._rows()).set_index("output")

    def _repr_html_(self) -> str:
        rows = self._rows()
        return html_table(repr(self), rows[0], (map(_cell, row.values()) for row in rows))

    @property
    def notes(self) -> tuple[str, ...]:
        """What one might not expect of its links, a line for each."""
        return tuple(link.note for link in self.links or () if link.note)

    @property
    def drift_accuracy(self) -> str:
        """How right the largest drift is, in a few words; none where it is as right as the outputs are."""
        return f" (right to {self.drift_bound:.2g} of it)" if self.drift_bound > self.bound else ""

    @property
    def accuracy(self) -> str:
        """How right values are, in a few words."""
        right, lines = (
            f"right to {self.bound:g} of each output's largest",
            self.labels.left_out_text if self.labels else "",
        )
        if self.proved:
            return f"{right}, proved{lines}"
        return f"an estimate (values are {right}{lines}; higher tops may be missed)"


def _cell(value: float | str | None) -> str:
    return "never" if value is None else value if isinstance(value, str) else f"{value:.7g}"


def summarise(model: Model, samples: Sequence[float] | None = None, drifts: Sequence[Probe] = ()) -> Summary:
    """The summary of `summary_and_program`."""
    return summary_and_program(model, samples, drifts)[0]


def summary_and_program(
    model: Model, samples: Sequence[float] | None = None, drifts: Sequence[Probe] = ()
) -> tuple[Summary, Program | None]:
    """The extremes of a model's outputs: true ones, or of the values at the tau of `samples`; the largest of `drifts`.

    True ones are proved where `run` gives values right to the last bit; else they are those of the program that `auto`
    takes, found by samples. The program is that whose values were searched, which has the bound of the summary; None
    where there was none. Drifts are outputs of the same solution, unless that would cost too much.
    ToleranceError, CostError where there is no such program either.
    """
    wanted = {probe.rod for probe in drifts}
    drifts = drifts if len(drifts) <= _MOST_DRIFTS else ()
    known = {probe.rod for probe in model.probes if probe.quantity == "drift"}
    others = [probe for probe in drifts if probe.rod not in known]
    beside = (replace(probe, incidental=True) for probe in others)
    models = [model.watching([*model.probes, *beside]), model] if others else [model]
    if model.network.corners and has_more_fronts(models[0], _MOST_FRONTS):
        models, drifts, others = [model], (), []
    solved, found = _solve_extremes(models, samples)
    outputs = _outputs(solved, found)
    every = [*_drifts(solved, outputs, found), *_drifts_alone(model, solved, others, samples)] if drifts else []
    missing = wanted - {rod for rod, _, _ in every}
    summary = Summary(
        model.name,
        outputs[: len(model.probes)],
        found.bound,
        found.proved,
        found.how,
        model.clock.unit if model.clock else None,
        None if missing else _largest(each for _, each, _ in every),
        bool(missing),
        link_summaries(model, solved),
        max((bound for _, _, bound in every), default=0.0),
        (found.program.provenance.model if found.program else model).labels,
    )
    return summary, found.program


def _drifts(
    model: Model, outputs: Sequence[OutputSummary], found: _Extremes
) -> Iterator[tuple[int, OutputSummary, float]]:
    """Drifts with their rods and bounds; of incidental ones those that are right enough to be told."""
    for probe, each, bound in zip(model.probes, outputs, found.bounds, strict=True):
        if probe.quantity == "drift" and (bound < _MOST_ERROR or not probe.incidental):
            yield probe.rod, each, bound


def _drifts_alone(
    model: Model, solved: Model, others: Sequence[Probe], samples: Sequence[float] | None
) -> Iterator[tuple[int, OutputSummary, float]]:
    """Drifts that cost too much beside the outputs, by themselves; none where that does, too.

    No program is made for them: that would take longer than all that was asked for.
    """
    if others and solved is model:
        with suppress(WavesymError):
            alone = model.watching(others)
            found = _exact(alone) if samples is None else _extremes_at(alone, np.asarray(samples))
            yield from _drifts(alone, _outputs(alone, found), found)


class _Extremes(NamedTuple):
    ranges: list[Range]
    averages: list[tuple[float, float, float]]
    bounds: tuple[float, ...]
    proved: bool
    how: str
    program: Program | None = None

    @property
    def bound(self) -> float:
        """That of the outputs that are held to the tolerance."""
        return self.program.error_bound if self.program else max(self.bounds)

    @property
    def modal(self) -> bool:
        return self.program is not None and self.program.has_equal_steps


def _solve_extremes(models: Sequence[Model], samples: Sequence[float] | None) -> tuple[Model, _Extremes]:
    """The extremes of the first of some models that can be solved, exactly rather than by a program, and that model."""
    methods = (
        [_exact, _search_extremes] if samples is None else [lambda model: _extremes_at(model, np.asarray(samples))]
    )
    *attempts, last = [(method, model) for method in methods for model in models]
    for method, model in attempts:
        with suppress(CostError, UnservedError, ToleranceError):
            return model, method(model)
    method, model = last
    return model, method(model)


def _exact(model: Model) -> _Extremes:
    found = extremes_and_averages(model)
    averaged = []
    for ends, each in found:
        least = BOUND * max(abs(end.value) for end in ends)
        mean, rms, residual = (
            0.0 if abs(middle) <= least else middle for middle in map(midpoint, (each.mean, each.rms, each.residual))
        )
        averaged.append((mean, rms, residual))
    return _Extremes([extreme for extreme, _ in found], averaged, (BOUND,) * len(found), True, "true extremes")


def _outputs(model: Model, found: _Extremes) -> tuple[OutputSummary, ...]:
    arrivals = light_arrivals(model) if found.modal else first_arrivals(model)
    return tuple(
        OutputSummary(
            probe.name,
            probe.unit,
            _peak(model, least),
            _peak(model, greatest),
            None if first is None or (least, greatest) == NOTHING else instant(model, not_below(first), first),
            *averaged,
            probe.title,
        )
        for probe, (least, greatest), averaged, first in zip(
            model.probes, found.ranges, found.averages, arrivals, strict=True
        )
    )


def _largest(drifts: Iterable[OutputSummary]) -> OutputSummary | None:
    """The largest of some drifts; None where no rod changes."""
    largest = min(drifts, key=lambda output: (-abs(output.largest.value), output.largest.at.tau), default=None)
    return largest if largest is not None and largest.largest.value else None


def _peak(model: Model, found: TrueExtreme) -> Peak:
    return Peak(found.value, instant(model, found.tau), found.reached)


def instant(model: Model, tau: float, exact: fmpq | None = None) -> OutputTime:
    """A tau, and the scene's time then."""
    if model.clock is None:
        return OutputTime(tau, None)
    return OutputTime(tau, nearest((rational(tau) if exact is None else exact) * model.clock.per_tau))


def _extremes_at(model: Model, taus: Array) -> _Extremes:
    """The extremes of values at these tau, as `run` has them."""
    response = Response(model)
    values = response(taus)
    ranges = _ranges(*sampled_extremes(taus, values, bound=_column(response.bounds)))
    made = response.program
    how = f"the values{f' of {made.evaluator}' if made else ''} at {taus.size} samples"
    averaged = _averages(values, np.ones(taus.size))
    return _Extremes(ranges, averaged, response.bounds, made is None or made.proved, how, made)


def _search_extremes(model: Model) -> _Extremes:
    """The extremes of the program that `auto` takes, looked for between many samples."""
    step = spacing(model)
    if (count := nearest(model.until) / step) * len(model.probes) > _MOST_SAMPLES:
        raise CostError(
            f"output.until: extremes of {len(model.probes)} outputs would be looked for at {count:.1e} samples "
            f"each, the limit is {_MOST_SAMPLES // len(model.probes):.1e} (a shorter horizon or fewer outputs "
            "help)"
        )
    program = make(model)
    taus, values = sample_program(model, program, step)
    ranges = _ranges(*sampled_extremes(taus, values, program.each, _column(program.bounds)))
    how = f"{program.evaluator} at {taus.size} samples, {describe_step(model, step)}, then refined"
    return _Extremes(ranges, _averages(values, _trapezoids(taus)), program.bounds, False, how, program)


def _column(bounds: Sequence[float]) -> Array:
    return np.array(bounds)[:, None]


def _trapezoids(taus: Array) -> Array:
    """The weights of samples in an integral by trapezoids; of the two sides of a jump both have theirs."""
    steps = np.diff(taus, prepend=taus[:1], append=taus[-1:])
    return np.asarray((steps[:-1] + steps[1:]) / 2 if taus.size > 1 else np.ones(1))


def _averages(values: Array, weights: Array) -> list[tuple[float, float, float]]:
    """Of each row the mean and the root mean square, with weights, and the last value."""
    means, squares = (np.average(each, axis=1, weights=weights) for each in (values, values**2))
    return list(zip(means.tolist(), np.sqrt(squares).tolist(), values[:, -1].tolist(), strict=True))


def _ranges(values: Array, taus: Array) -> list[Range]:
    """As of pieces; all of these are values that are taken."""
    least, greatest = (
        [TrueExtreme(*each) for each in zip(values[:, side].tolist(), taus[:, side].tolist(), strict=True)]
        for side in (0, 1)
    )
    return list(zip(least, greatest, strict=True))

"""Error and time of everything that a chart compares, measured in one process."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, fields
from functools import cached_property, partial
from io import StringIO
from math import isnan, nan

import numpy as np
from numpy.typing import NDArray

from wavesym.errors import WavesymError
from wavesym.lab.chart.subjects import Subject, other_methods, reference, subjects, taus
from wavesym.lab.floor import floor
from wavesym.lab.standard import standard
from wavesym.lab.timing import medians
from wavesym.programs.runtime.making import sets_program
from wavesym.running.model import compiled_model
from wavesym.scene import Scene, lower

NEAR = 0.02
"""How near to an arrival an error counts as one at a front (in tau)."""

SAMPLES = 10001
"""Samples an output that times are measured on."""

# samples whose errors are looked at: of the uniform ones about so many, of the arrivals at most so many
_CHECKED = 1000
_FRONTS = 150
_LINES = 20  # calls in a turn of the floor
_OFFSETS = (-0.015, -0.005, -0.0005, 0.0, 0.0005, 0.005, 0.015)
# a sample that is left of a jump by less than this is there by rounding, and nobody's error
_ROUNDED = {False: 1e-9, True: 1e-5}  # by whether it is in single precision


@dataclass(frozen=True)
class ChartRow:
    """A point of the chart. Errors are relative to each output's largest value, and of the outputs the largest.

    NaN where there is no such place: where nothing jumps, at fronts.
    """

    name: str
    kind: str
    language: str
    precision: str
    resolution: str
    ns_per_value: float
    setup_seconds: float
    error_away: float
    error_at_fronts: float
    proved_bound: float | None


@dataclass(frozen=True)
class Measurements:
    """A scene's chart in numbers: its points, and the nanoseconds that writing a double takes.

    All errors have `known` in them, what the values that they are measured from may be wrong by. `new_parameters` is
    how many seconds pass from new kappa to all samples, by C that takes them when it runs; None where no C does.
    """

    rows: tuple[ChartRow, ...]
    floor: float
    samples: int
    reference_bound: float = 0.0
    new_parameters: float | None = None


def measure(scene: Scene, samples: int = SAMPLES, progress: Callable[[str], None] = lambda _: None) -> Measurements:
    """All evaluators, and other methods, of a scene. CompilerError where there is no C compiler, CostError."""
    judge = _Judge(scene)
    found: list[tuple[Subject, tuple[float, float]]] = []
    for source in (
        (subjects, other_methods) if judge.known.bound else (subjects, other_methods, _single_subject(reference))
    ):
        for subject in source(scene, samples):
            progress(" ".join((*subject.curve, subject.resolution)))
            found.append((subject, judge.errors(subject)))
    again = _new_parameter_calls(scene, samples)
    progress("timing")
    outputs = len(scene.outputs)
    line, *times = medians([floor(outputs, samples, _LINES), *(subject.sample for subject, _ in found), *again])
    new_parameters = times.pop() if again else None
    rows = (
        ChartRow(
            name=subject.name,
            kind=subject.kind,
            language=subject.language,
            precision=subject.precision,
            resolution=subject.resolution,
            ns_per_value=seconds / (len(subject.instants) * outputs) * 1e9,
            setup_seconds=subject.setup,
            error_away=away,
            error_at_fronts=fronts,
            proved_bound=subject.bound,
        )
        for (subject, (away, fronts)), seconds in zip(found, times, strict=True)
    )
    return Measurements(
        tuple(rows), line / (_LINES * samples * outputs) * 1e9, samples, judge.known.bound, new_parameters
    )


def _new_parameter_calls(scene: Scene, samples: int) -> list[Callable[[], object]]:
    """A call that gives values for new kappa, where a program takes them when it runs."""
    try:
        program = sets_program(lower(scene), ["kappa"])
    except WavesymError:
        return []
    model = compiled_model(program)
    return [partial(model.run, taus(model.tau_max, samples, "double"), kappa=model.parameters["kappa"])]


def to_csv(measured: Measurements) -> str:
    """All numbers, with the floor as a row of its own."""
    text = StringIO()
    writer = csv.DictWriter(text, [field.name for field in fields(ChartRow)], lineterminator="\n")
    writer.writeheader()
    line = {"name": "straight line", "kind": "floor", "language": "C", "precision": "double"}
    writer.writerow(line | {"ns_per_value": f"{measured.floor:.3g}"})
    if measured.new_parameters is not None:
        again = {"name": "kappa at run time", "kind": "set-up", "language": "C", "precision": "double"}
        writer.writerow(again | {"setup_seconds": _cell(measured.new_parameters)})
    for row in measured.rows:
        writer.writerow({name: _cell(value) for name, value in asdict(row).items()})
    return text.getvalue()


def _cell(value: object) -> object:
    if not isinstance(value, float):
        return value
    return "" if isnan(value) else f"{value:.3g}"


def _single_subject(make: Callable[[Scene, int], Subject]) -> Callable[[Scene, int], Iterator[Subject]]:
    return lambda scene, samples: iter((make(scene, samples),))


class _Judge:
    """The truth at some of the uniform samples and round the arrivals, and how far subjects are from it."""

    def __init__(self, scene: Scene) -> None:
        self.known = standard(lower(scene))
        self.arrivals = self.known.arrivals
        self._values: dict[bytes, NDArray[np.float64]] = {}

    def errors(self, subject: Subject) -> tuple[float, float]:
        """The largest errors away from fronts and at them."""
        single = subject.precision == "single"
        every = max(1, (len(subject.instants) - 1) // _CHECKED)
        where, values = subject.instants[::every], np.asarray(subject.sample())[:, ::every]
        if subject.evaluate is not None and len(self.arrivals):
            fronts = np.unique(self._fronts.astype(where.dtype))
            fronts = fronts[fronts <= self.known.until]
            where, values = np.concatenate([where, fronts]), np.hstack([values, subject.evaluate(fronts)])
        where = where.astype(np.float64)
        relative = self.known.errors(values, self._truth(where))
        after = where[:, np.newaxis] - self.arrivals
        meant = ~np.any((after < 0) & (after > -_ROUNDED[single]), axis=1)
        near = np.any(np.abs(after) <= NEAR, axis=1)
        away, at = (_largest(relative[:, meant & here]) + self.known.bound for here in (~near, near))
        return away, at

    @cached_property
    def _fronts(self) -> NDArray[np.float64]:
        """Round arrivals, and exactly at them."""
        chosen = self.arrivals[:: max(1, -(-len(self.arrivals) // _FRONTS))]
        places = np.unique(np.add.outer(chosen, _OFFSETS))
        return np.asarray(places[(places >= 0) & (places <= self.known.until)])

    def _truth(self, where: NDArray[np.float64]) -> NDArray[np.float64]:
        key = where.tobytes()
        if key not in self._values:
            self._values[key] = np.array(self.known.values(where.tolist()))
        return self._values[key]


def _largest(errors: NDArray[np.float64]) -> float:
    """The largest error; infinite where a value is no number, NaN of none."""
    return float(np.max(np.where(np.isfinite(errors), errors, np.inf))) if errors.size else nan

"""Parameters at run time, from Python: what `wavesym.model` gives."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import inf
from typing import TYPE_CHECKING, Any, NoReturn
from warnings import warn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesym.errors import WavesymError, did_you_mean
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.programs.program import Program
from wavesym.results.horizon import check_horizon
from wavesym.results.near_zero import is_near_zero, zero_within
from wavesym.results.statistics import RUNTIME_ARRAYS
from wavesym.running.labels import SetLabels

if TYPE_CHECKING:
    from wavesym.running.mode_sets import ModalSets
    from wavesym.running.sets import CompiledSets


_NONE = np.zeros(0)
_SAMPLES = 1001
_WHY = (
    "",
    "a number that is not finite, or not positive where it has to be, or too large or small",
    "bodies too light",
)


@dataclass(frozen=True)
class SetChecks:
    """Of each set its `status`, 0, or 1 for a bad number, or 2 for rates beyond what the degree of the program can
    follow; and its `estimate`, about the largest error of any output relative to its largest value, with a margin (not
    proved; NaN where the status is not 0). `is_poor` says of each set whether that is more than the `tolerance` of the
    scene, which no number of modes, or no degree, that there is room for meets: `bounds` prove such a set, a sweep
    computes it by programs of its own.
    """

    status: NDArray[np.int32]
    estimate: Array
    tolerance: float = inf

    @property
    def is_poor(self) -> NDArray[np.bool_]:
        """Whether the estimate is above the tolerance."""
        return np.asarray(self.estimate > self.tolerance)

    @property
    def why(self) -> list[str]:
        """In words, empty for a set that is fine."""
        poor = f"an estimate above {self.tolerance:.3g}, the tolerance"
        return [poor if short else _WHY[status] for status, short in zip(self.status, self.is_poor, strict=True)]


@dataclass(frozen=True, repr=False)
class SetPeaks:
    """The least and the greatest value of each output, and a tau of it, of shape (sets, outputs), NaN where `checks`
    has a status that is not 0. Where an output jumps, what it comes from counts, too. What is within the estimate of
    `checks` of 0 is 0, at tau = 0 where the output begins so, too.
    """

    min: Array
    tau_min: Array
    max: Array
    tau_max: Array
    checks: SetChecks
    labels: SetLabels

    def __repr__(self) -> str:
        sets, outputs = self.max.shape
        return f"SetPeaks({sets} sets of {outputs} outputs: {', '.join(RUNTIME_ARRAYS)})"

    def to_xarray(self) -> Any:
        """An xarray.Dataset with the outputs and the numbers that vary as coordinates. WavesymError without xarray.

        Of a scene with units it has `time_min` and `time_max` beside tau, in `time_unit`.
        """
        return self.labels.label_extremes({name: getattr(self, name) for name in RUNTIME_ARRAYS})


@dataclass(frozen=True)
class SetGradients:
    """`values` of shape (sets, outputs, *tau.shape), and `by[field]`, their derivatives by each number of a field, of
    shape (sets, numbers, outputs, *tau.shape). `estimates[field]`, of shape (sets, numbers), are about the largest
    error of any output's derivative relative to its largest value, as the estimate of `checks` is of the values; inf
    where nothing is known of it.
    """

    values: Array
    by: Mapping[str, Array]
    checks: SetChecks
    estimates: Mapping[str, Array]


def compiled_model(program: Program) -> RuntimeModel:
    """What a program with parameters at run time computes, compiled when it is first needed."""
    from wavesym.running.sets import CompiledSets

    return RuntimeModel(CompiledSets(program))


class RuntimeModel:
    """A scene whose parameters are given when it runs.

    `outputs` are the names of its outputs, `tau_max` its horizon, `parameters` the scene's own numbers of each field,
    by name. They are given by these names, as arrays of shape (sets, numbers), or (numbers,) for all sets, or (sets,)
    for a field of one number, which may be a number; those that are not given are the scene's. A set that is refused is
    NaN throughout, and `check` says why; so is tau out of range. WavesymError for a field that there is not, and for
    arrays of other shapes; CompilerError where there is no C compiler. A damping ratio above 1 is warned of.
    """

    def __init__(self, engine: CompiledSets | ModalSets) -> None:
        self._engine = engine
        fields = engine.fields
        self.parameters: Mapping[str, Array] = {
            field.name: np.array([float(value) for value in field.values]) for field in fields
        }
        self.labels: Mapping[str, tuple[str, ...]] = {field.name: field.captions for field in fields}
        """What the numbers of each field are called."""
        self.units: Mapping[str, tuple[str, ...]] = {
            field.name: tuple(unit.text for unit in field.units) for field in fields
        }
        """Their units; empty where they have none."""
        self._model = engine.model
        self.outputs = tuple(probe.name for probe in self._model.probes)
        self.tau_max = engine.tau_max
        clock = self._model.clock
        self.time_unit = clock.unit if clock else None
        """That of `times`; None of a scene without units, whose times are tau."""
        self.seconds_per_tau = nearest(clock.seconds) if clock else None
        """What one tau is; None of a scene without units."""
        self.time_per_tau = nearest(clock.per_tau) if clock else 1.0
        """The same in `time_unit`."""

    def run(
        self,
        tau: ArrayLike | None = None,
        *,
        times: ArrayLike | None = None,
        strict: bool = False,
        **parameters: ArrayLike,
    ) -> Any:
        """Values of all sets, labelled.

        Args:
            tau: instants, dimensionless, of any shape; where there are neither these nor `times`, 1001 equally spaced
                ones on the horizon.
            times: instants in the time unit of the scene's results (s), or tau where it has no units; in place of
                `tau`.
            strict: whether an instant outside the horizon is an error.
            parameters: arrays of shape (sets, numbers) or (numbers,), by the name of their field; (sets,) where it has
                one number.

        Returns:
            An xarray.DataArray of shape (sets, outputs, *tau.shape) with outputs, times and the numbers that vary as
            coordinates: where one number varies, it is the first dimension; where xarray is not installed the same
            as a NumPy array, as of `values`. NaN for sets that are refused and, with one warning, outside the horizon.

        Raises:
            WavesymError: where `strict`, for tau outside [0, tau_max]; for unknown fields, arrays of other shapes, and
                for both `tau` and `times`.
        """
        if tau is not None and times is not None:
            raise WavesymError("times: write either times or tau, the instants")
        if times is None and tau is None:
            tau = np.linspace(0.0, self.tau_max, _SAMPLES)
        instants, shown = self._instants(tau, times)
        labels = self._labels(parameters)
        check_horizon(instants, self.tau_max, strict=strict, clock=self._model.clock if times is not None else None)
        return labels.label_values(self._compute(instants, parameters), instants, shown)

    def _labels(self, parameters: Mapping[str, ArrayLike]) -> SetLabels:
        """What the sets of these parameters vary."""
        fields = self._fields(parameters)
        units = tuple(probe.unit for probe in self._model.probes)
        varied = {name: fields[name] for name in parameters}
        titles = tuple(probe.label for probe in self._model.probes)
        return SetLabels(
            varied, self.labels, self.units, self.outputs, units, titles, self.time_unit, self.time_per_tau
        )

    def _instants(self, tau: ArrayLike | None, times: ArrayLike | None) -> tuple[Array, Array]:
        """Instants as tau, and in the unit of results."""
        clock = self._model.clock
        if times is None:
            assert tau is not None
            found = _numbers("tau", tau)
            return found, found * self.time_per_tau
        shown = _numbers("times", times)
        if clock is None:
            return shown, shown
        return np.vectorize(lambda time: clock.tau(time, self._model.until), otypes=[float])(shown), shown

    def values(self, tau: ArrayLike, *, strict: bool = False, **parameters: ArrayLike) -> Array:
        """Values of all sets as a NumPy array, (sets, outputs, *tau.shape); arguments and errors are those of `run`."""
        instants = _numbers("tau", tau)
        check_horizon(instants, self.tau_max, strict=strict)
        return self._compute(instants, parameters)

    def _compute(self, instants: Array, parameters: Mapping[str, ArrayLike]) -> Array:
        found = self._engine.values(self._parameter_rows(parameters), instants.ravel())
        return found.values.reshape(len(found.values), len(self.outputs), *instants.shape)

    def gradients(self, tau: ArrayLike, *, strict: bool = False, **parameters: ArrayLike) -> SetGradients:
        """Values, and their derivatives by all parameters, given or not; arguments and errors are those of `run`.

        The derivative of a peak is that of its output at its tau, as its slope is 0 there: `gradients(peaks.tau_max)`.
        """
        instants = _numbers("tau", tau)
        check_horizon(instants, self.tau_max, strict=strict)
        found = self._engine.tangents(self._parameter_rows(parameters), instants.ravel())
        shape = (len(self.outputs), *instants.shape)
        lanes = found.values.reshape(*found.values.shape[:2], *shape)
        ends = np.cumsum([1, *map(len, self.parameters.values())])
        places = {name: slice(*of) for name, of in zip(self.parameters, pairwise(ends), strict=True)}
        by = {name: lanes[:, place] for name, place in places.items()}
        estimates = {name: found.estimate[:, place] for name, place in places.items()}
        return SetGradients(lanes[:, 0], by, self._checks(found.status, found.estimate[:, 0]), estimates)

    def peaks(self, **parameters: ArrayLike) -> SetPeaks:
        """Extremes on the whole horizon, between samples, too."""
        given = self._parameter_rows(parameters)
        found = self._engine.peaks(given)
        values, taus = found.values[..., ::2].copy(), found.values[..., 1::2].copy()
        zero_within(values, taus, found.estimate[:, None, None], self._first_zeros(given, values, taus, found.estimate))
        (least, greatest), (tau_least, tau_greatest) = np.moveaxis(values, 2, 0), np.moveaxis(taus, 2, 0)
        checks = self._checks(found.status, found.estimate)
        return SetPeaks(least, tau_least, greatest, tau_greatest, checks, self._labels(parameters))

    def _checks(self, status: NDArray[np.int32], estimate: Array) -> SetChecks:
        return SetChecks(status, estimate, nearest(self._model.tolerance))

    def _first_zeros(self, given: Array, values: Array, taus: Array, estimate: Array) -> Array:
        """When outputs whose extremes are within the estimate of 0 first are that near: at the start, or then."""
        bounds = estimate[:, None, None]
        later = np.any(is_near_zero(values, bounds) & (taus > 0), axis=(1, 2))
        if not later.any():
            return taus
        first = taus.copy()
        begin = self._engine.values(given[later], np.zeros(1)).values.reshape(-1, len(self.outputs), 1)
        rests = is_near_zero(values[later], bounds[later], begin)
        first[later] = np.where(rests, 0.0, first[later])
        return first

    def misfit(self, tau: ArrayLike, data: ArrayLike) -> Callable[..., Array]:
        """What makes of parameters, as `run` takes them, the sum of the squares of (output - data), of shape (sets,).

        `data` of shape (outputs, *tau.shape) is NaN where there is none. Where C runs, the work that the number of tau
        sets is done here, once.
        """
        instants, values = _numbers("tau", tau), _numbers("data", data)
        wanted = (len(self.outputs), *instants.shape)
        if values.shape != wanted:
            raise WavesymError(f"data: an array of shape {values.shape}; write one of shape {wanted}")
        if not np.all((instants >= 0) & (instants <= self.tau_max)):
            raise WavesymError(f"tau: beyond the data; where there are data write 0 to {self.tau_max:g}")
        if np.any(np.isinf(values)):
            raise WavesymError("data: an infinite number; write finite ones, and NaN where there is none")
        misfits = self._engine.misfit(instants.ravel(), values.reshape(len(self.outputs), -1))

        def objective(**parameters: ArrayLike) -> Array:
            return misfits(self._parameter_rows(parameters)).values

        return objective

    def bounds(self, **parameters: ArrayLike) -> Array:
        """Of each set and output the largest error relative to its largest value on the horizon, at most: proved.

        It is pessimistic by a few digits, infinite where it leaves nothing. Of shape (sets, outputs).
        """
        return self._engine.bounds(self._parameter_rows(parameters)).values

    def check(self, **parameters: ArrayLike) -> SetChecks:
        """Which sets are refused, and what errors the others have."""
        found = self._engine.values(self._parameter_rows(parameters), np.empty(0))
        return self._checks(found.status, found.estimate)

    def __repr__(self) -> str:
        fields = ", ".join(f"{len(values)} of {name}" for name, values in self.parameters.items())
        count, clock = len(self.outputs), self._model.clock
        until = clock.format(self._model.until) if clock else f"tau = {self.tau_max:g}"
        return f"RuntimeModel({self._model.name!r}, {fields}, {count} output{'s' * (count != 1)}, until {until})"

    def __reduce__(self) -> NoReturn:
        raise TypeError("a model is compiled where it is: in another process, wavesym.model(scene, runtime) makes one")

    def _fields(self, parameters: Mapping[str, ArrayLike]) -> dict[str, Array]:
        """The numbers of all fields, (sets, numbers), or (numbers,) for all sets."""
        columns = dict(self.parameters)
        for name, values in parameters.items():
            if name not in columns:
                meant = did_you_mean(name, columns)
                hint = f". {meant}" if meant else ""
                raise WavesymError(f"{name}: not a parameter of this model; write {' or '.join(columns)}{hint}")
            wanted = columns[name].shape
            columns[name] = _numbers(name, values)
            if wanted == (1,) and columns[name].ndim <= 1:
                columns[name] = columns[name].reshape(-1, 1)
            if columns[name].ndim not in (1, 2) or columns[name].shape[-1:] != wanted:
                raise WavesymError(
                    f"{name}: an array of shape {columns[name].shape}; write one of shape (sets, {wanted[0]})"
                )
        return columns

    def _parameter_rows(self, parameters: Mapping[str, ArrayLike]) -> Array:
        """All fields side by side, a row for each set."""
        columns = self._fields(parameters)
        if (largest := float(np.max(columns.get("damping", _NONE), initial=0.0))) > 1:
            warn(f"damping: {largest:g} is {100 * largest:g} % of critical; write 0.05 for 5 %", stacklevel=3)
        counts = {len(values) for values in columns.values() if values.ndim == 2} - {1}  # which is for all sets
        if len(counts) > 1:
            raise WavesymError(f"{' and '.join(map(str, sorted(counts)))} sets; write as many of each parameter")
        sets = counts.pop() if counts else 1
        rows = [np.broadcast_to(values, (sets, values.shape[-1])) for values in columns.values()]
        return np.ascontiguousarray(np.concatenate(rows, axis=1))


def _numbers(name: str, values: ArrayLike) -> Array:
    try:
        if np.iscomplexobj(values):  # NumPy would leave out what is imaginary
            raise TypeError
        return np.asarray(values, np.float64)
    except (TypeError, ValueError):
        raise WavesymError(f"{name}: not numbers; write an array of them") from None

"""The frequency response of a scene: complex amplitudes of its outputs over frequency, each right to the tolerance."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import nan
from time import monotonic
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import acb, arb, ctx

from wavesym.errors import CostError, ToleranceError, UnservedError, WavesymError
from wavesym.exact.modes.damped_modes import remove_dashpots
from wavesym.exact.modes.frequencies import bisect_frequencies
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.numbers.arrays import Array, Complex
from wavesym.numbers.doubles import midpoint, nearest, upper_double
from wavesym.progress import tell_detail, warn_count
from wavesym.results.modal_transfer import MOST_MODES, transfers
from wavesym.results.optional import require_packages
from wavesym.results.presentation import OutputRows, csv_line
from wavesym.results.resonance import AmplitudePeaks, peaks
from wavesym.results.transfer import HarmonicLoad, Transfer, angular

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


_MODES_SHOWN, _STEPS = 5, 400
_CLOSER = 2.0 ** -np.arange(12)  # of the distance of two frequencies
_RIGID = 1e-6  # of what is above a frequency, one that is 0 but for rounding
_MOST_POINTS = 1_000_000
_OFTEN = 100  # frequencies after which it is said how many are done
_BITS, _MOST_BITS = 128, 1 << 13
_TIMES = 2  # as many modes, where damping ratios need more
_SHARP, _ZERO, _BITS_OF_ZERO = 70, 160, 1024
_BITS_OF_MODES = 192
_ROUNDING = 2.0**-52  # both parts, each to the nearest double


@dataclass(frozen=True, repr=False, eq=False)
class FrequencyResponse(OutputRows):
    """Complex amplitudes of the outputs under one unit of a load exp(+i w t); `wavesym.frf` makes it.

    Attributes:
        name: the scene.
        load: what the load is called; `load_unit` its unit, empty without [units].
        frequency: (n,), in Hz, or, without [units], w in rad per tau; `frequency_label` says which.
        outputs: the names, in the order of the scene; `units` that of each, per unit of the load.
        values: (outputs, n), complex; nan at a natural frequency that nothing damps.
        bound: what a value is wrong by at most, relative to its output's largest amplitude here: proved.
        poles: the natural frequencies met: there is no value, or nothing limits it.
        possible_poles: of these the ones at which an output may have a value.

    `response[NAME]` is one output, (n,).
    """

    name: str
    load: str
    load_unit: str
    frequency: Array
    frequency_label: str
    outputs: tuple[str, ...]
    units: tuple[str, ...]
    values: Complex
    bound: float
    poles: tuple[float, ...]
    possible_poles: tuple[float, ...]
    _model: Model = field(repr=False)
    _load: HarmonicLoad = field(repr=False)

    def __repr__(self) -> str:
        low, high = self.frequency[[0, -1]] if len(self.frequency) else (0.0, 0.0)
        unit = "Hz" if self.frequency_label.endswith("[Hz]") else "rad per tau"
        return (
            f"FrequencyResponse({self.name!r}, {len(self)} outputs at {len(self.frequency)} frequencies from {low:g} "
            f"to {high:g} {unit}, bound {self.bound:.1e})"
        )

    @property
    def amplitude(self) -> Array:
        """The absolute values, (outputs, n)."""
        return np.abs(self.values)

    @property
    def phase(self) -> Array:
        """By how much each output is ahead of the load, in degrees from -180 to 180, (outputs, n)."""
        return np.degrees(np.angle(self.values))

    def peaks(self) -> AmplitudePeaks:
        """The greatest amplitude of each output between the least frequency and the last, enclosed.

        WavesymError where there are no two. CostError where too many intervals would be needed.
        """
        band = self.frequency.min(initial=np.inf), self.frequency.max(initial=0.0)
        return peaks(self._model, self._load, *map(float, band))

    def with_peaks(self) -> FrequencyResponse:
        """The same at more frequencies: at the greatest amplitude of each output and ever closer to it, so that a line
        through values shows it; at no more where that costs too much, or nothing limits it.
        """
        try:
            tops = [peak.frequency for peak in self.peaks() if np.isfinite(peak.amplitude)]
        except WavesymError:
            return self
        at = np.sort(self.frequency)
        reach = [top + side * _CLOSER * (at[-1] - at[0]) / len(at) for top in tops for side in (-1, 1)]
        more = np.concatenate([tops, *reach])
        every = np.unique(np.concatenate([at, more[(more >= at[0]) & (more <= at[-1])]]))
        return frequency_response(self._model, self._load, every)

    @property
    def notes(self) -> tuple[str, ...]:
        """What is to be known of the scene, how good values are, and where there are none: lines for people."""
        unit = "Hz" if self.frequency_label.endswith("[Hz]") else "rad per tau"
        poles, undecided = (", ".join(f"{each:g}" for each in found) for found in (self.poles, self.possible_poles))
        return (
            *self._model.labels.structure_notes,
            f"per {self.load_unit or 'unit'} of {self.load}{self._units_text}; right to {self.bound:.1e} of each "
            "output's largest amplitude here, proved",
            *([f"no value at {poles} {unit}: there is none, or nothing limits it"] if poles else []),
            *([f"not decided at {undecided} {unit}: the load may not excite it"] if undecided else []),
        )

    @property
    def _units_text(self) -> str:
        """In what units outputs are, by what they are; empty where they have none."""
        pairs = zip(self.outputs, self.units, strict=True)
        found = dict.fromkeys(f"{name.partition('@')[0]} in {unit}" for name, unit in pairs if unit)
        return f": {', '.join(found)}" if found else ""

    def to_pandas(self) -> Any:
        """A pandas.DataFrame: a complex column for each output over the frequency. WavesymError without pandas."""
        pandas = require_packages("pandas", "sweep")
        index = pandas.Index(self.frequency, name=self.frequency_label)
        return pandas.DataFrame(dict(zip(self.outputs, self.values, strict=True)), index=index)

    def csv(self) -> Iterator[str]:
        """Lines of CSV: the frequency, then the real and the imaginary part of each output."""
        yield csv_line([self.frequency_label, *(f"{name}.{part}" for name in self for part in ("real", "imag"))])
        parts = np.stack([self.values.real, self.values.imag], axis=1).reshape(2 * len(self), -1)
        for f, row in zip(self.frequency.tolist(), parts.T.tolist(), strict=True):
            yield csv_line([f, *row])

    def json(self) -> str:
        """As JSON: `frequency`, and the parts, amplitude and phase of each output; null where there is no value."""
        rows = zip(self.outputs, self.units, self.values, self.amplitude, self.phase, strict=True)
        outputs = [
            {
                "name": name,
                "unit": unit,
                "real": _numbers(row.real),
                "imag": _numbers(row.imag),
                "amplitude": _numbers(amplitude),
                "phase": _numbers(phase),
            }
            for name, unit, row, amplitude, phase in rows
        ]
        about = {"load": self.load, "load_unit": self.load_unit, "frequency_label": self.frequency_label}
        more = {"bound": self.bound, "poles": list(self.poles), "outputs": outputs}
        return json.dumps({"name": self.name, **about, "frequency": self.frequency.tolist(), **more}, indent=2) + "\n"


def _numbers(row: Array) -> list[float | None]:
    return [None if np.isnan(value) else value for value in row.tolist()]


def frequency_response(model: Model, load: HarmonicLoad, frequencies: ArrayLike) -> FrequencyResponse:
    """The outputs of a model under one unit of a load, at some frequencies.

    Args:
        model: a chain without contacts that open.
        load: which load (transfer.harmonic_load).
        frequencies: (n,), in Hz where the model has a clock, else in rad per tau; at least 0.

    Raises:
        WavesymError: for a frequency that is negative or no number.
        UnservedError: for contacts, rings of parts, modes that cannot be told apart.
        ToleranceError: where damping ratios of single modes would need too many modes for the tolerance.
        CostError: for too many frequencies, or more bits than can be had.
    """
    given = np.atleast_1d(np.asarray(frequencies, np.float64))
    for f in given:
        if not (np.isfinite(f) and f >= 0):
            raise WavesymError(f"frequency: {f:g} is not a number of at least 0")
    _refuse_many(len(given))
    if model.damping is not None and any(bar.loss != 0 for bar in model.network.bars):
        raise UnservedError("system.damping: rods have a loss already; write one of both")
    values = np.full((len(model.probes), len(given)), np.nan + 0j)
    errors = np.zeros(len(model.probes))
    if model.damping is not None and model.damping.modes is None and model.damping.acts:
        errors = _modal(model, load, given, values)
        undecided = given[np.isnan(values.real).any(axis=0)].tolist()
    else:
        points = _Points(Transfer(model, load))
        start = monotonic()
        for k, f in enumerate(given.tolist()):
            if k % _OFTEN == 0:
                tell_detail(f"{k} of {len(given)} frequencies")
            if k == _OFTEN:
                warn_count(len(given), "frequencies", (monotonic() - start) / k, "fewer take less")
            values[:, k], radii = points.solve(f)
            errors = np.fmax(errors, radii)
        undecided = points.possible_poles
    largest = np.nanmax(np.abs(values), axis=1, initial=0.0)
    relative = np.divide(errors, largest, out=np.zeros_like(errors), where=largest > 0)
    if relative.max(initial=0.0) > nearest(model.tolerance):
        raise ToleranceError(
            f"output.tolerance: {relative.max():.1e} reached (frequencies further from resonance help)"
        )
    missing = np.isnan(values.real).any(axis=0)
    return FrequencyResponse(
        name=model.name,
        load=load.label,
        load_unit=load.unit,
        frequency=given,
        frequency_label="omega" if model.clock is None else "frequency [Hz]",
        outputs=tuple(probe.name for probe in model.probes),
        units=tuple(probe.unit for probe in model.probes),
        values=values,
        bound=float(relative.max(initial=0.0)) + _ROUNDING,
        poles=tuple(given[missing].tolist()),
        possible_poles=tuple(undecided),
        _model=model,
        _load=load,
    )


def equally_spaced(model: Model, low: float | None, high: float | None, points: int) -> Array:
    """Frequencies from `low` to `high`, ends included, where these are None from one step above 0 to the fifth mode.

    (That is the mode without dashpots. At 0 nothing but supports holds the chain: it may have no answer.)

    WavesymError for a band that is none. CostError for too many points.
    """
    if high is None:
        high = float(f"{_last_shown(remove_dashpots(model.network)) / midpoint(angular(model, 1.0)):.3g}")
    _refuse_many(points)
    if low is None:
        low = high / max(points, _STEPS)
    if not 0 <= low < high or points < 2:
        band = f"--from {low:g} --to {high:g} --points {points}"
        raise WavesymError(f"{band}: no band of frequencies; write two that rise, from 0 on, and 2 points or more")
    return np.linspace(low, high, points)


def _last_shown(network: Network) -> float:
    """The frequency of the fifth mode, or of the last one, in doubles; 0 where that has no strain."""
    stiffness = Stiffness(network)
    count = _MODES_SHOWN if stiffness.modes is None else min(_MODES_SHOWN, stiffness.modes)
    last = float(bisect_frequencies(stiffness, count)[-1]) if count else 0.0
    return last if last > _RIGID * float(stiffness.upper_bounds(np.array([count]))[0]) else 0.0


def _refuse_many(points: int) -> None:
    if points > _MOST_POINTS:
        raise CostError(f"--points: {points} of them, the limit is {_MOST_POINTS} (fewer points help)")


@dataclass
class _Points:
    """The outputs at single frequencies, with as many bits as the last one needed."""

    transfer: Transfer
    bits: int = _BITS
    possible_poles: list[float] = field(default_factory=list)
    """Where an output has no value, as its numerator may be 0, too."""

    def solve(self, frequency: float) -> tuple[list[complex], list[float]]:
        """The outputs at a frequency, both parts as the nearest doubles, and what these are wrong by before rounding.

        nan where there is no answer, as at a natural frequency. CostError where no bits tell.
        """
        model, bits = self.transfer.model, self.bits
        before = [arb("inf") for _ in model.probes]
        while bits <= _MOST_BITS:
            with ctx.workprec(bits):
                found = [acb(each) for each in self.transfer(angular(model, frequency))]
                radii = [max(each.real.rad(), each.imag.rad()) for each in found]
                finite = [k for k, each in enumerate(found) if each.is_finite()]
                # frequencies of modes, which Rayleigh's damping takes, are known to so many bits and no more
                known = all(radii[k] == 0 or 2 * radii[k] > before[k] for k in finite)
                enough = known or all(_is_sharp(found[k], radii[k], bits) for k in finite)
                if len(finite) == len(found) and enough:
                    self.bits = max(_BITS, bits * 7 // 8 if bits == self.bits else bits)
                    break
                before = radii
            bits = bits * 3 // 2
        if enough:
            self._take_lowest_terms(frequency, found, radii)
            return [_nearest(each) for each in found], [upper_double(r) if r.is_finite() else nan for r in radii]
        raise CostError(
            f"frequency: more than {_MOST_BITS} bits at {frequency:g}, the limit is {_MOST_BITS} (fewer parts help)"
        )

    def _take_lowest_terms(self, frequency: float, found: list[acb], radii: list[arb]) -> None:
        """Fill in values where numerator and divisor are both 0, in place."""
        for k in (k for k, each in enumerate(found) if not each.is_finite()):
            with ctx.workprec(_BITS_OF_ZERO):
                w, terms = angular(self.transfer.model, frequency), self.transfer.lowest_terms(k)
                if terms is not None:
                    found[k] = acb(terms(w)[0])
                    radii[k] = max(found[k].real.rad(), found[k].imag.rad())
                elif frequency not in self.possible_poles:
                    parts = self.transfer.parts(w)
                    if parts is None or acb(parts[0][k]).contains(0):
                        self.possible_poles.append(frequency)


def _nearest(value: acb) -> complex:
    """Both parts as doubles; nan where the value is not known."""
    return complex(midpoint(value.real), midpoint(value.imag)) if value.is_finite() else complex(nan)


def _is_sharp(value: acb, radius: arb, bits: int) -> bool:
    """Whether a value is known beside its absolute value, or, with many bits, is 0 as far as anyone can see."""
    if radius == 0 or radius < abs(value).lower() * arb(2) ** -_SHARP:
        return True
    return bits >= _BITS_OF_ZERO and bool(abs(value) < arb(2) ** -_ZERO)


def _modal(model: Model, load: HarmonicLoad, given: Array, values: Complex) -> Array:
    """Fill in sums over as many modes as the tolerance needs; what each output is wrong by at most.

    ToleranceError where that are too many.
    """
    tolerance = nearest(model.tolerance)
    with ctx.workprec(_BITS_OF_MODES):
        highest = max((angular(model, f) for f in given.tolist()), default=arb(0))
        for transfer, rests in transfers(model, load, highest, _TIMES):
            errors = left = np.array([upper_double(each) for each in rests])
            if not np.isfinite(errors).all():
                continue
            for k, f in enumerate(given.tolist()):
                found = [acb(each) for each in transfer(angular(model, f))]
                values[:, k] = [_nearest(each) for each in found]
                radii = [upper_double(each.real.rad() + each.imag.rad()) if each.is_finite() else nan for each in found]
                errors = np.fmax(errors, left + radii)
            largest = np.nanmax(np.abs(values), axis=1, initial=0.0)
            if (errors <= tolerance * largest).all():
                return np.asarray(errors)
    raise ToleranceError(
        f"output.tolerance: {tolerance:.1e} would need more than {MOST_MODES} modes in a frequency response; "
        "a larger tolerance, lower frequencies or Rayleigh damping (modes = [i, j]) help"
    )

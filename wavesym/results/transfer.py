"""The transfer functions of a model: its outputs under one unit of a load exp(i w tau), as balls.

The network's amplitudes are exact (exact/modes/harmonic.py). With Rayleigh's damping a + b w_n^2 of mode n each mode
answers a force by 1/(w_n^2 - w^2 + i w (a + b w_n^2)), which is that of the undamped network at another frequency v:

    1/((1 + i b w) (w_n^2 - v^2)),    v^2 = (w^2 - i a w)/(1 + i b w)

so their sum needs no modes. What a prescribed motion imposes is not damped, nor is a motion without strain.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from math import factorial

from flint import acb, arb, fmpq

from wavesym.errors import WavesymError, did_you_mean
from wavesym.exact.modes.branches import BranchTree
from wavesym.exact.modes.frequencies import Spectrum
from wavesym.exact.modes.harmonic import Amplitudes, Frequency, Quantity, ball_frequency
from wavesym.exact.modes.lowest_terms import LowestTerms, polynomial_frequency
from wavesym.exact.modes.shape import rigid, rigid_mass
from wavesym.mechanics.gauge import Gauge, ReadingTerm, readings
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import End, Network
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import common_measure, rational

_I = acb(0, 1)
_MOST_TERMS = 8000  # of the polynomials of one output
ORDERS = {"velocity": 1, "acceleration": 2}
"""How often a displacement is differentiated in time for an output."""


@dataclass(frozen=True)
class HarmonicLoad:
    """One unit of a load that is harmonic.

    Attributes:
        label: what it is called.
        unit: its unit; empty without [units].
        drives: the points it acts on, each with what acts when the load is a unit step, as coefficients of powers of
            tau.
    """

    label: str
    unit: str
    drives: tuple[tuple[int, tuple[fmpq, ...]], ...]


def harmonic_load(model: Model, sources: tuple[str, ...], wanted: str | int | None = None) -> HarmonicLoad:
    """The load that is meant.

    Args:
        model: the chain.
        sources: what its loads are steps of, in the order of the scene.
        wanted: its number from 0 on, its name, its node or its source; None where there is one.

    Raises:
        WavesymError: where there is no load, more than one and none wanted, or none of that name.
    """
    nodes = {source: source.partition(":")[0] for source in sources}
    names = {source: model.labels.titles.get(source) or node for source, node in nodes.items()}
    known = ", ".join(f"{number} ({name})" for number, name in enumerate(names.values()))
    if not sources:
        raise WavesymError("load: there is none; a frequency response needs a [[load]] that says where it acts")
    if wanted is None and len(sources) > 1:
        raise WavesymError(f"--load: there are {len(sources)} loads; name one of {known}")
    found = [
        source
        for number, source in enumerate(sources)
        if wanted is None or str(wanted) in (str(number), source, nodes[source], names[source])
    ]
    if len(found) != 1:
        hint = did_you_mean(str(wanted), names.values())
        raise WavesymError(f"--load: {wanted} is no load of this scene; it has {known}{hint and '. '}{hint}")
    (source,) = found
    factor, unit = model.inputs.get(source, (fmpq(1), ""))
    drives = tuple(
        (number, tuple(fmpq(c) / factor for c in load.coefficients))
        for number, point in enumerate(model.network.points)
        for load in point.loads
        if load.source == source
    )
    return HarmonicLoad(names[source], unit, drives)


def laplace(coefficients: tuple[fmpq, ...], rate: Quantity, order: int = 0) -> Quantity:
    """What a load exp(rate tau) does that as a unit step is a sum of powers of tau: by Laplace's transform.

    It is differentiated `order` times, or integrated: at rate 0 it is finite where no integral is left of it.
    """
    made = rate * 0
    for power, c in enumerate(coefficients):
        if c != 0:
            part = rate * 0 + c * factorial(power)
            for _ in range(abs(order - power)):  # one by one: a ball that 0 is not in may have squares that it is in
                part = part * rate if order > power else part / rate
            made = made + part
    return made


@dataclass(frozen=True)
class Transfer:
    """The outputs of a model under one unit of a load, as functions of the frequency.

    UnservedError, when it is called, for contacts that open, rings of parts and frequencies that modal damping cannot
    tell apart.
    """

    model: Model
    load: HarmonicLoad
    _lowest_terms: dict[int, LowestTerms | None] = field(default_factory=dict, repr=False, compare=False)

    def __call__(self, w: Quantity) -> list[Quantity]:
        """The complex amplitudes of the outputs.

        Args:
            w: the frequency in rad per tau: a ball, or a power series of complex ones about one that is not 0.

        Returns:
            One for each output, in its unit per unit of the load; not finite where w may be a natural frequency.
        """
        total: list[Quantity] = [acb(0) for _ in self.model.probes]
        for point, coefficients in self.load.drives:
            outputs = zip(self.model.probes, self._undifferentiated_outputs(point, w), strict=True)
            for k, (probe, moved) in enumerate(outputs):
                total[k] = total[k] + laplace(coefficients, w * _I, self._order(point, probe)) * moved
        return total

    def parts(self, w: Quantity) -> tuple[list[Quantity], Quantity] | None:
        """The same as a numerator for each output and one divisor, none of which has a pole but at 0.

        None where several points are driven, or modes are damped.
        """
        if len(self.load.drives) != 1 or self._rayleigh is not None:
            return None
        return self._fractions(self.model.probes, ball_frequency(w))

    def _fractions(self, probes: Sequence[Probe], w: Frequency) -> tuple[list[Quantity], Quantity]:
        """Some outputs as numerators over one divisor, at a frequency in any arithmetic."""
        totals, divisor = [w.number(0)] * len(probes), w.number(1)
        for point, coefficients in self.load.drives:
            amplitudes = Amplitudes(self._trees[point], w, undivided=True)
            for k, probe in enumerate(probes):
                acting = laplace(coefficients, w.rate, self._order(point, probe))
                moved = acting * output_amplitude(self.model.network, probe, amplitudes)
                totals[k] = totals[k] * amplitudes.divisor + moved * divisor
            divisor = divisor * amplitudes.divisor
        return totals, divisor

    def _order(self, point: int, probe: Probe) -> int:
        """How often an output is differentiated in time, once more than what drives a point."""
        return ORDERS.get(probe.quantity, 0) - ORDERS.get(self.model.network.points[point].motion or "", 0)

    def has_pole(self, k: int, low: arb, high: arb) -> bool:
        """Whether output k is proved to have a pole between two frequencies.

        As its divisor is real and changes sign, and its numerator is not 0; or by its lowest terms.
        """
        found = self.parts(low.union(high))
        if found is not None and not acb(found[0][k]).contains(0) and acb(found[1]).imag == 0:
            first, last = (acb(each[1]).real for each in (self.parts(low), self.parts(high)) if each is not None)
            return bool(first * last < 0)
        terms = self.lowest_terms(k)
        return terms is not None and terms.has_pole(0, low, high)

    def lowest_terms(self, k: int) -> LowestTerms | None:
        """Output k as one fraction without common factors.

        None where modes are damped, a rod has a loss, or delays have so small a common measure that it is too long.
        """
        if k not in self._lowest_terms:
            self._lowest_terms[k] = self._reduce(k)
        return self._lowest_terms[k]

    def _reduce(self, k: int) -> LowestTerms | None:
        network, probe = self.model.network, self.model.probes[k]
        if self._rayleigh is not None or any(bar.loss != 0 for bar in network.bars):
            return None
        inside = [
            network.bars[each.rod - 1].delay * each.place for _, each in _motion_readings(network, probe) if each.rod
        ]
        measure = common_measure([bar.delay for bar in network.bars] + inside)
        steps = sum(bar.delay / measure for bar in network.bars)
        if (1 + 2 * steps) * (2 * len(network.points) + len(network.bars)) > _MOST_TERMS:
            return None
        (numerator,), divisor = self._fractions([probe], polynomial_frequency(measure))
        return LowestTerms(numerator, divisor, measure)

    @cached_property
    def imposed_outputs(self) -> frozenset[int]:
        """The outputs that are what a driven end itself does, whatever the rest does."""
        network, driven = self.model.network, [point for point, _ in self.load.drives]
        if len(driven) != 1 or network.points[driven[0]].motion is None:
            return frozenset()
        found = ((k, [each for _, each in _motion_readings(network, p)]) for k, p in enumerate(self.model.probes))
        return frozenset(k for k, every in found if all(_point_of(network, each) == driven[0] for each in every))

    def _undifferentiated_outputs(self, point: int, w: Quantity) -> list[Quantity]:
        """The outputs, not yet differentiated in time, under a unit force on a point, or its unit displacement."""
        if self._rayleigh is None:
            return self._undamped_outputs(point, w)
        first, second, ratio = self._rayleigh
        a, b = 2 * ratio * first * second / (first + second), 2 * ratio / (first + second)
        lag = w * (_I * b) + 1
        square = (w * w - w * (_I * a)) / lag
        moved = self._undamped_outputs(point, square.sqrt())
        if self.model.network.points[point].motion is None:
            made = [each / lag for each in moved]
            if self._rigid is None:
                return made
            # the motion without strain: as it is, in place of damped
            shape, mass = self._rigid
            share = shape(point) / mass
            rigid_part = [share * self._of_shape(probe, shape) for probe in self.model.probes]
            return [each + r / (square * lag) - r / (w * w) for each, r in zip(made, rigid_part, strict=True)]
        imposed = self._undamped_outputs(point, arb(0))
        # w^2/(v^2 (1 + i b w)), also at 0
        share_of_w = w / (w - _I * a)
        return [u + (each - u) * share_of_w for each, u in zip(moved, imposed, strict=True)]

    def _undamped_outputs(self, point: int, w: Quantity) -> list[Quantity]:
        amplitudes = Amplitudes(self._trees[point], ball_frequency(w))
        return [output_amplitude(self.model.network, probe, amplitudes) for probe in self.model.probes]

    @cached_property
    def _trees(self) -> dict[int, BranchTree]:
        """The network as it is seen from each point that is driven."""
        self.model.network.refuse_corners()
        return {point: BranchTree(self.model.network, point) for point, _ in self.load.drives}

    @cached_property
    def _rayleigh(self) -> tuple[arb, arb, fmpq] | None:
        """The frequencies of the two modes, and the ratio of both."""
        damping = self.model.damping
        if damping is None or damping.modes is None or not damping.acts:
            return None
        found = (mode.frequency for mode in Spectrum(self.model.network).first(max(damping.modes) + 1))
        strained = [w for w in found if w != 0]
        first, second = (strained[number - 1] for number in damping.modes)
        return first, second, damping.ratios[0]

    @cached_property
    def _rigid(self) -> tuple[Callable[[int], fmpq], fmpq] | None:
        network = self.model.network
        found = rigid(network)
        return None if found is None else (found.__getitem__, rigid_mass(network, found))

    def _of_shape(self, probe: Probe, shape: Callable[[int], fmpq]) -> fmpq:
        """What an output is of a motion without strain."""
        total, bars = fmpq(0), self.model.network.bars
        for weight, reading in _motion_readings(self.model.network, probe):
            if reading.point is not None:
                total += weight * shape(reading.point)
            elif reading.quantity != "strain":
                bar = bars[reading.rod - 1]
                total += weight * shape(bar.left) * bar.ratios[0]
        return total


def _motion_readings(network: Network, probe: Probe) -> list[ReadingTerm]:
    """The strains and displacements that an output is the sum of, before it is differentiated in time."""
    moved = replace(probe, quantity="displacement") if probe.quantity in ORDERS else probe
    return [term for term in readings(network, moved) if term.reading.moves]


def _point_of(network: Network, reading: Gauge) -> int | None:
    """The point whose motion is read; None for a strain, and inside a rod."""
    if reading.quantity == "strain" or (reading.rod and reading.place not in (0, 1)):
        return None
    return network.point_at(End(reading.rod - 1, int(reading.place))) if reading.rod else reading.point


def output_amplitude(network: Network, probe: Probe, amplitudes: Amplitudes) -> Quantity:
    """What an output is of amplitudes, its factor included, but not differentiated in time."""
    total = amplitudes.zero
    for weight, reading in _motion_readings(network, probe):
        number, bar = reading.rod - 1, network.bars[reading.rod - 1] if reading.rod else None
        if bar is None:
            assert reading.point is not None  # which is read where no rod is
            moved = amplitudes.point(reading.point)
        elif reading.quantity == "strain":
            moved = amplitudes.slope(number, reading.place) / bar.speed
            if probe.computed_quantity == "force" and bar.loss != 0:
                moved = moved * acb(1, arb(bar.loss))
        else:
            moved = amplitudes.displacement(number, reading.place)
        total = total + moved * weight
    return total


def angular(model: Model, frequency: float) -> arb:
    """w in rad per tau of a frequency as users give it, which stands for its shortest decimal, at the set precision."""
    exact = arb(rational(Fraction(repr(frequency))))
    return exact if model.clock is None else 2 * arb.pi() * exact * model.clock.seconds

"""Model -> modes: as many as its tolerance needs, and what those that are left out can add at most."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import ceil, inf, isqrt, log

import numpy as np
from flint import fmpq

from wavesym.errors import CostError, ToleranceError, UnservedError
from wavesym.exact.modes.frequencies import Spectrum
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.modes.damped import Damped, damped
from wavesym.programs.modes.loads import LinearLoads, linear_loads
from wavesym.programs.modes.modal import ModalSystem, Numbers
from wavesym.programs.modes.roughness import Roughness, roughness
from wavesym.programs.modes.rounding import rounded
from wavesym.programs.modes.shares import Shares, shares
from wavesym.programs.modes.silent import silent
from wavesym.programs.modes.tables import scheme_tables
from wavesym.programs.modes.tail import LeftOut
from wavesym.programs.modes.watched import Driver, Seen, driven, places, seen
from wavesym.programs.schemes.modes import ModesScheme

_FIRST = 6  # modes for a bar, for a start
_MOST = 4000  # modes, and
_MOST_WORK = 100_000  # modes times bars
_REASONABLE = 0.1  # error relative to what a bound of the largest value may be read from


@dataclass(frozen=True)
class ModalModes:
    """A modal system of a model under its loads, dimensionless in time, its outputs as users get them.

    `errors` is what the modes that are left out can add to each output at most, `bounds` the same relative to its
    largest value, of which `largest` is a lower bound; all are 0 for an output that is 0 throughout the horizon.
    `sources` are the step and the ramp of each load: a force on a node, or the acceleration of an end. `frequencies`
    and `damping` are those of the modes alone: the system may have an oscillator more for each load.
    """

    system: ModalSystem
    sources: tuple[tuple[str, str], ...]
    loads: LinearLoads
    errors: Numbers
    largest: Numbers
    frequencies: Numbers
    damping: Numbers
    proved: bool = True

    @property
    def count(self) -> int:
        """How many modes."""
        return len(self.frequencies)

    @cached_property
    def bounds(self) -> Numbers:
        """Of each output, relative to its largest value."""
        return _relative(self.errors, self.largest)


def modal_system(model: Model) -> ModalModes:
    """The first modes of a model, as many as leave out at most half of its tolerance.

    UnservedError for what modes do not serve, ToleranceError where too many would be needed.
    """
    chain = ModalChain(model)
    tolerance = nearest(model.tolerance) / 2
    count, largest = chain.fewest, np.zeros(len(model.probes))
    while True:
        known = chain.shares(count)
        errors = chain.errors(known, count)
        # an output that no mode has a part in may have no error at all, and has a largest value
        if np.any(errors > _REASONABLE * largest) or not largest.any():
            largest = np.maximum(largest, chain.reached(known, count))
        worst = _relative(errors, largest).max(initial=0.0)
        if worst <= tolerance:
            break
        # errors fall with a power of the number of modes, as they do from half of them
        half = max(chain.fewest // 2, count // 2)
        before = _relative(chain.errors(known, half), largest).max(initial=0.0)
        power = max(log(before / worst) / log(count / half), 1.0) if worst < before < inf else 1.0
        more = (worst / tolerance) ** (1 / power) if worst < inf else 4.0
        if count == chain.most or (worst < _REASONABLE and count * more > 4 * chain.most):
            raise _unmet(model, chain, errors, largest, (chain.most / count) ** power)
        count = min(ceil(count * min(max(1.05 * more, 1.2), 8.0)), chain.most)
    # of these as few as will do
    low, high = chain.least - 1, count
    while high - low > 1:
        middle = (low + high) // 2
        enough = _relative(chain.errors(known, middle), largest).max(initial=0.0) <= tolerance
        low, high = (low, middle) if enough else (middle, high)
    system = chain.system(known, high)
    return ModalModes(
        system,
        chain.sources,
        chain.loads,
        chain.errors(known, high),
        np.where(chain.silent, 0.0, largest),
        known.w[:high],
        system.damping[:high],
    )


def _unmet(model: Model, chain: ModalChain, errors: Numbers, largest: Numbers, better: float) -> ToleranceError:
    bounds = _relative(errors, largest)
    worst = int(np.argmax(bounds))
    name = model.probes[worst].name
    if bounds[worst] < inf:
        what = f"leave a bound of about {2 * bounds[worst] / better:.2g} for {name}"
    else:
        what = f"do not tell the largest value of {name} from 0 (without it the others may do)"
    return ToleranceError(
        f"output.tolerance: {nearest(model.tolerance):g} cannot be met: modes: {chain.most} modes, the most that are "
        f"taken, {what}"
    )


def _relative(errors: Numbers, largest: Numbers) -> Numbers:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(errors > 0, errors / largest, 0.0)


@dataclass(frozen=True)
class ModalChain:
    """What is the same for any number of modes."""

    model: Model

    @cached_property
    def drivers(self) -> tuple[Driver, ...]:
        """The loads that act; one that moves nothing where there are none."""
        network = self.model.network
        acting = {load.source for load in self.model.acting(self.model.until)}
        every = driven(network)
        found = tuple(each for each in every if {each.step, each.ramp} & acting)
        still = next((number for number, point in enumerate(network.points) if point.motion != "fixed"), 0)
        return found or (every[0] if every else Driver(still, fmpq(0), "none:step", "none:ramp"),)

    @cached_property
    def sources(self) -> tuple[tuple[str, str], ...]:
        return tuple((each.step, each.ramp) for each in self.drivers)

    @cached_property
    def loads(self) -> LinearLoads:
        return linear_loads(self.model.loads, self.sources, self.model.until, self.model.told)

    @cached_property
    def rough(self) -> tuple[Roughness, ...]:
        return tuple(roughness(self.loads))

    @cached_property
    def silent(self) -> tuple[bool, ...]:
        return silent(self.model, self.drivers, self.loads)

    @cached_property
    def spectrum(self) -> Spectrum:
        return Spectrum(self.model.network, places(self.model))

    @cached_property
    def least(self) -> int:
        """As many modes as damping is said of, one more that has no strain, and one more to know a frequency of."""
        damping = self.model.damping
        return max(len(damping.ratios), *(damping.modes or (0,)), 0) + 2 if damping else 2

    @property
    def fewest(self) -> int:
        """The modes to begin with."""
        return max(_FIRST * len(self.model.network.bars), self.least)

    @property
    def most(self) -> int:
        """More are not taken."""
        return max(min(_MOST, _MOST_WORK // len(self.model.network.bars)), self.fewest)

    def shares(self, count: int) -> Shares:
        """The first modes. UnservedError for what modes do not serve."""
        network = self.model.network
        moving = any(bar.velocity != 0 or bar.strain != 0 for bar in network.bars)
        if moving or any(point.velocity != 0 for point in network.points):
            raise UnservedError(
                "system: a motion or strain at tau = 0 given, rest expected in modes (pieces and march serve it)"
            )
        if not self.drivers:
            raise UnservedError("load: none that acts by output.until given, one expected in modes (all is at rest)")
        _ = self.loads  # refused before the work
        self._refuse_many(len(network.bars))
        found = self.spectrum.first(count)
        return shares(found, self.spectrum.cut, self.seen, self.drivers)

    def _refuse_many(self, rods: int) -> None:
        most = isqrt(_MOST_WORK // _FIRST)
        if rods <= most:
            return
        if self.model.chain is None:
            raise CostError(f"system.parts: {rods} rods in modes, at most {most} expected (fewer rods or march helps)")
        raise CostError(f"system.m: {rods} rods in modes, at most {most} expected (fewer rods or march helps)")

    @property
    def seen(self) -> list[Seen]:
        return [seen(self.model.network, self.spectrum.cut, probe) for probe in self.model.probes]

    def rule(self, known: Shares) -> Damped:
        """The damping of all modes."""
        return damped(self.model.damping, known.w[known.w > 0].tolist())

    def tail(self, known: Shares, count: int) -> LeftOut:
        """The modes after the first `count`."""
        taken = known.w[:count]
        return LeftOut(self.rule(known), float(np.nextafter(taken[-1], 0.0)), int(np.count_nonzero(taken)))

    def errors(self, known: Shares, count: int, loads: Sequence[Roughness] | None = None) -> Numbers:
        """What the modes after the first `count` can add to each output, under its own or other `loads`."""
        tail, rest = self.tail(known, count), known.rest(count)
        left = [rows[:, count] for rows in known.spare]
        made = np.zeros(len(self.model.probes))
        for j, rough in enumerate(self.rough if loads is None else loads):
            declines = tail.declines(rough)
            for o, output in enumerate(self.seen):
                decline = declines[output.order]
                powers = known.powers[0][o] + known.powers[1][j]
                made[o] += np.sqrt(left[0][o] * left[1][j]) * decline.size * tail.w ** float(powers - decline.power)
                if tail.lags and output.order < 2:
                    made[o] += abs(rest[o, j]) * decline.size / tail.above**2
        return np.where(self.silent, 0.0, (1 + 1e-12) * made)

    def system(self, known: Shares, count: int) -> ModalSystem:
        """The system of the first `count` modes."""
        w, values, pushes = known.w[:count], known.seen[:, :count], known.shares[:, :count]
        tail, rule = self.tail(known, count), self.rule(known)
        rest = known.rest(count)
        orders = np.array([output.order for output in self.seen])[:, None]
        damping = rule.of(w)
        direct = np.zeros((*rest.shape, 3))
        for order in range(3):
            direct[:, :, 2 - order] += np.where(orders == order, known.imposed, 0.0)
        direct[:, :, 0] += np.where(orders == 2, values @ pushes.T, 0.0)
        if tail.lags:
            # the modes left out, each load's as one
            above = np.full(len(pushes), tail.above)
            w, damping = np.append(w, above), np.append(damping, rule.of(above))
            values = np.hstack([values, np.where(orders < 2, rest, 0.0)])
            pushes = np.hstack([pushes, np.diag(above**2)])
        else:
            direct[:, :, 0] += np.where(orders == 0, rest, 0.0)
        moved = np.where(orders == 0, values, np.where(orders == 2, -w * w * values, 0.0))
        moving = np.where(orders == 1, values, np.where(orders == 2, -2 * damping * w * values, 0.0))
        heard = ~np.array(self.silent)
        return ModalSystem(
            w, damping, pushes.T.copy(), moved * heard[:, None], moving * heard[:, None], direct * heard[:, None, None]
        )

    def reached(self, known: Shares, count: int) -> Numbers:
        """What each output reaches at least, in spite of what is left out."""
        system, until = self.system(known, count), self.model.horizon()
        scheme = ModesScheme(scheme_tables(system, self.loads, DOUBLE), {"loads": len(self.drivers)}, until, np.float64)
        values = rounded(system, self.loads, scheme, until, DOUBLE).largest
        return np.maximum(values - self.errors(known, count), 0.0)

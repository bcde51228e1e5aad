"""Model -> modes: as many as its tolerance needs, and what those that are left out can add at most."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import arb, ctx, fmpq

from wavesym.errors import ToleranceError, UnservedError
from wavesym.exact.modes.frequencies import Spectrum, refuse_damped
from wavesym.exact.modes.shape import Mode
from wavesym.exact.modes.statics import Shape, Statics
from wavesym.model.model import Model
from wavesym.model.network import End, Network
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.modes.damped import Damped, damped
from wavesym.programs.modes.loads import LinearLoads, linear_loads
from wavesym.programs.modes.modal import ModalSystem, Numbers
from wavesym.programs.modes.rounding import rounded
from wavesym.programs.modes.roughness import Roughness, roughness
from wavesym.programs.modes.tables import scheme_tables
from wavesym.programs.modes.tail import Tail
from wavesym.programs.modes.watched import Driven, Seen, Watched, driven, ground
from wavesym.programs.schemes.modes import ModesScheme

_BITS = 256
_FIRST = 6  # modes for a bar, for a start
MOST = 6000  # modes
MOST_WORK = 80_000  # modes times bars


@dataclass(frozen=True)
class ModalModes:
    """A modal system of a model under its loads.

    `errors` is what the modes that are left out can add to each output, in its own unit, `bounds` the same relative to
    its largest value, of which `largest` is a lower bound (0, with error 0, for one that is 0 throughout the horizon).
    `sources` names the step and the ramp of each load, which is a force on a node or the acceleration of an end.
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
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.errors > 0, self.errors / self.largest, 0.0)


def modal_system(model: Model) -> ModalModes:
    """The first modes of a model, as many as make its truncation error half of its tolerance at most.

    UnservedError for what modes do not serve, ToleranceError where too many would be needed.
    """
    chain = _Chain(model)
    chain.refuse()
    count = chain.fewest
    largest = np.zeros(len(model.probes))
    tolerance = nearest(model.tolerance) / 2
    while True:
        made = chain.system(count)
        largest = np.maximum(largest, chain.least_largest(made))
        with np.errstate(divide="ignore", invalid="ignore"):
            worst = float(np.max(np.where(made.errors > 0, made.errors / largest, 0.0), initial=0.0))
        if worst <= tolerance:
            return ModalModes(
                made.system, chain.pairs, chain.loads, made.errors, largest, made.frequencies, made.damping
            )
        if count == chain.most:
            output = int(np.argmax(np.where(made.errors > 0, made.errors / np.maximum(largest, 1e-300), 0.0)))
            raise ToleranceError(
                f"output.tolerance: {nearest(model.tolerance):g} cannot be met: modes: {count} modes, at most "
                f"{chain.most} expected, leave a bound of {2 * worst:.2g} for {model.probes[output].name}"
            )
        # errors fall with the square of the number of modes, or faster
        more = min(max((worst / tolerance) ** 0.5, 1.25), 4.0)
        count = min(int(count * more) + 1, chain.most)


@dataclass(frozen=True)
class _Made:
    system: ModalSystem
    errors: Numbers
    frequencies: Numbers
    damping: Numbers


@dataclass(frozen=True)
class _Chain:
    """What is the same for any number of modes."""

    model: Model

    @cached_property
    def watched(self) -> Watched:
        return Watched(self.model)

    @cached_property
    def drivers(self) -> tuple[Driven, ...]:
        """The loads that act."""
        acting = {load.source for load in self.model.acting(self.model.until)}
        return tuple(each for each in driven(self.model.network) if {each.step, each.ramp} & acting)

    @cached_property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        return tuple((each.step, each.ramp) for each in self.drivers)

    @cached_property
    def loads(self) -> LinearLoads:
        return linear_loads(self.model.loads, self.pairs, self.model.until)

    @cached_property
    def rough(self) -> tuple[Roughness, ...]:
        return tuple(roughness(self.loads))

    @property
    def bars(self) -> int:
        return len(self.model.network.bars)

    @property
    def fewest(self) -> int:
        ratios = len(self.model.damping.ratios) if self.model.damping else 0
        pair = max(self.model.damping.modes or (0,)) if self.model.damping else 0
        return max(_FIRST * self.bars, ratios, pair) + 2

    @property
    def most(self) -> int:
        return max(min(MOST, MOST_WORK // self.bars), self.fewest)

    def refuse(self) -> None:
        """UnservedError for what starts otherwise than at rest, and for what has no real modes."""
        network = self.model.network
        refuse_damped(network)
        moving = any(bar.velocity != 0 or bar.strain != 0 for bar in network.bars)
        if moving or any(point.velocity != 0 for point in network.points):
            raise UnservedError(
                "system: a motion or strain at tau = 0 given, rest expected in modes (pieces and march serve it)"
            )
        _ = self.loads

    @cached_property
    def silent(self) -> tuple[bool, ...]:
        """Which outputs are 0 throughout the horizon: nothing has come there, or nothing can act there."""
        return tuple(self._silent(number) for number in range(len(self.model.probes)))

    def _silent(self, number: int) -> bool:
        network, probe = self.model.network, self.model.probes[number]
        if probe.rod and probe.quantity in ("strain", "force") and probe.place in (0, 1):
            if network.is_free(End(probe.rod - 1, int(probe.place))):
                return True
        places = [] if probe.point is not None else [(probe.rod - 1, probe.place)]
        points = [] if probe.point is None else [probe.point]
        if probe.quantity == "drift":
            places = [(probe.rod - 1, fmpq(0)), (probe.rod - 1, fmpq(1))]
        if probe.quantity == "relative":
            points.append(ground(network))
        away = network.distances(places, points)
        for j, each in enumerate(self.drivers):
            begins = next((k for k, row in enumerate(self.loads.samples) if row[j] != 0), None)
            start = self.loads.times[begins - 1] if begins else self.loads.times[-1]
            acts = begins is not None or self.loads.slopes[j] != 0
            if acts and start + away[network.joint_of[each.point]] < self.model.until:
                return False
        return True

    @cached_property
    def spectrum(self) -> Spectrum:
        return Spectrum(self.model.network, self.watched.places)

    def system(self, count: int) -> _Made:
        """The system of the first `count` modes, and the errors of what is left out."""
        found = self.spectrum.first(count)
        with ctx.workprec(_BITS):
            return self._system(found)

    def _system(self, found: Sequence[Mode]) -> _Made:
        network = self.spectrum.cut.network
        statics = Statics(found[0].stiffness)
        seen = self.watched.seen(self.spectrum.cut)
        w = np.array([float(mode.frequency) for mode in found])
        strained = [mode for mode in found if mode.frequency != 0]
        rule = damped(self.model.damping, [float(mode.frequency) for mode in strained])
        ratios = rule.of(w)
        tail = Tail(rule, float(strained[-1].frequency.lower()), len(strained))
        shapes = [self._shape(statics, driver) for driver in self.drivers]
        shares = [[_share(network, driver, mode) for mode in found] for driver in self.drivers]
        seens = [[each.of(mode) for mode in found] for each in seen]
        spare = [arb(s) for s in self._spare_shares(statics, found, shares)]
        made = _Rows(len(seen), len(found), len(self.drivers))
        errors = np.zeros(len(seen))
        for o, (output, row) in enumerate(zip(seen, seens, strict=True)):
            if self.silent[o]:
                continue
            made.modes(o, output, row, w, ratios)
            power = output.power()
            left = output.total(statics) - _squares(row, found, power)
            for j, (driver, share) in enumerate(zip(self.drivers, shares, strict=True)):
                imposed, static = shapes[j]
                decline = tail.declines(self.rough[j])[output.order]
                known = 1 if imposed is None else 0
                within = (left.upper().max(0) * spare[j].upper().max(0)).sqrt()
                errors[o] += _above(within * decline.size * arb(tail.w) ** -(decline.power - power - known))
                if imposed is not None:
                    made.direct[o, j, 2 - output.order] += float(driver.gain * output.of(imposed))
                if output.order == 2:
                    made.direct[o, j, 0] += float(sum((a * b for a, b in zip(row, share, strict=True)), arb(0)))
                    continue
                rest = _rest(output, static, driver.gain, row, share, found)
                if rule.rayleigh:
                    made.late(o, j, output, rest, len(found))
                    errors[o] += _above(abs(rest) * decline.size / arb(tail.above) ** 2)
                elif output.order == 0:
                    made.direct[o, j, 0] += float(rest)
        pushes = np.array([[float(b) for b in share] for share in shares]).reshape(len(shares), len(found)).T
        if rule.rayleigh:
            above = np.full(len(shares), tail.above)
            w_all, ratios_all = np.append(w, above), np.append(ratios, rule.of(above))
            pushes = np.vstack([pushes, np.diag(above**2)])
        else:
            w_all, ratios_all = w, ratios
        columns = len(w_all)
        system = ModalSystem(w_all, ratios_all, pushes, made.moved[:, :columns], made.moving[:, :columns], made.direct)
        return _Made(system, errors, w, ratios)

    def _shape(self, statics: Statics, driver: Driven) -> tuple[Shape | None, Shape]:
        """What a load imposes, and the shape under it when it does not change, both but for its gain."""
        if self.model.network.points[driver.point].motion is None:
            return None, statics.under({driver.point: fmpq(1)})
        imposed = statics.imposed(driver.point)
        return imposed, statics.accelerated(imposed)

    def _spare_shares(self, statics: Statics, found: Sequence[Mode], shares: Sequence[Sequence[arb]]) -> list[arb]:
        """Of each load the sum over the modes left out of b^2/w^2 for a force, of b^2 for a motion."""
        spare = []
        for driver, share in zip(self.drivers, shares, strict=True):
            imposed, static = self._shape(statics, driver)
            total = statics.mass(imposed.points) if imposed else static.points[driver.point]
            spare.append(total * driver.gain * driver.gain - _squares(share, found, 0 if imposed else 1))
        return spare

    def least_largest(self, made: _Made) -> Numbers:
        """What each output reaches at least, in spite of what is left out."""
        if not self.drivers:
            return np.zeros(len(self.model.probes))
        tables = scheme_tables(made.system, self.loads, DOUBLE)
        until = self.model.horizon()
        scheme = ModesScheme(tables, {"loads": len(self.drivers)}, until, np.float64)
        reached = rounded(made.system, self.loads, scheme, until, DOUBLE).largest
        return np.maximum(reached - made.errors, 0.0)


class _Rows:
    """The rows of outputs as they are made; there is a column more for each load."""

    def __init__(self, outputs: int, count: int, loads: int) -> None:
        self.moved, self.moving = np.zeros((2, outputs, count + loads))
        self.direct = np.zeros((outputs, loads, 3))

    def modes(self, o: int, output: Seen, row: Sequence[arb], w: Numbers, ratios: Numbers) -> None:
        """What the modes that are taken add."""
        values = np.array([float(each) for each in row])
        count = len(values)
        match output.order:
            case 0:
                self.moved[o, :count] = values
            case 1:
                self.moving[o, :count] = values
            case 2:
                self.moved[o, :count] = -w * w * values
                self.moving[o, :count] = -2 * ratios * w * values

    def late(self, o: int, j: int, output: Seen, rest: arb, count: int) -> None:
        """What the oscillator adds that stands for the modes left out."""
        (self.moving if output.order else self.moved)[o, count + j] = float(rest)


def _share(network: Network, driver: Driven, mode: Mode) -> arb:
    """The share of a mode of mass 1 in a load."""
    if network.points[driver.point].motion is None:
        return mode.points[driver.point] * driver.gain
    # what holds the end in the mode, over w^2, is the mass that both move together, the mode and what the end imposes
    pull = arb(0)
    for number, bar in enumerate(network.bars):
        if bar.left == driver.point:
            pull += mode.slope(End(number, 0)) * (bar.impedance * bar.ratios[0])
        if bar.right == driver.point:
            pull -= mode.slope(End(number, 1)) * (bar.impedance * bar.ratios[1])
    for link in network.links:
        if driver.point in (link.left, link.right):
            other = link.right if link.left == driver.point else link.left
            pull += mode.points[other] * (link.ratio * link.stiffness)
    return -pull * driver.gain / (mode.frequency * mode.frequency)


def _squares(row: Sequence[arb], found: Sequence[Mode], power: int) -> arb:
    """The sum over modes with strain of squares over w^(2 power)."""
    total = arb(0)
    for value, mode in zip(row, found, strict=True):
        if mode.frequency != 0:
            square = mode.frequency * mode.frequency
            total += value * value / (square if power == 1 else square * square if power else arb(1))
    return total


def _rest(
    output: Seen, static: Shape, gain: fmpq, row: Sequence[arb], share: Sequence[arb], found: Sequence[Mode]
) -> arb:
    """What the modes left out do together under a load that does not change."""
    rest = output.of(static) * gain
    for value, part, mode in zip(row, share, found, strict=True):
        if mode.frequency != 0:
            rest -= value * part / (mode.frequency * mode.frequency)
    return rest


def _above(value: arb) -> float:
    """A double that is not below."""
    return float(np.nextafter(float(value.upper()), np.inf))

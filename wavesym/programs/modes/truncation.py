"""A model as modes: as many as its tolerance needs, and the truncation error of those that are left out."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import ceil, inf, isqrt, log
from typing import ClassVar, Generic, Protocol, TypeVar

import numpy as np
from flint import fmpq

from wavesym.errors import CostError, ToleranceError, UnservedError
from wavesym.exact.modes.cuts import Cut
from wavesym.exact.modes.damped_spectrum import DampedSpectrum
from wavesym.exact.modes.frequencies import Spectrum
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.modes.loads import LinearLoads, Roughness, linear_loads, roughness
from wavesym.programs.modes.modal_system import ModalSystem, scheme_tables
from wavesym.programs.modes.projection import Driver, ModalOutput, drivers_of, modal_output, places
from wavesym.programs.modes.rounding import rounding_errors
from wavesym.programs.modes.stepping import SteppedModes
from wavesym.programs.modes.zero_outputs import zero_outputs
from wavesym.programs.request import unmet_tolerance


class ModeProjection(Protocol):
    """What modes are of loads and outputs, by columns."""

    @property
    def w(self) -> Array:
        """The absolute values of their frequencies, ascending."""


K = TypeVar("K", bound=ModeProjection)


@dataclass(frozen=True)
class ModalModel(ABC, Generic[K]):
    """What is the same for any number of modes: at most `MOST`, and as many that they are `WORK` times bars."""

    model: Model

    SPECTRUM: ClassVar[type[Spectrum | DampedSpectrum]]
    MOST: ClassVar[int] = 4000
    WORK: ClassVar[int] = 100_000
    FIRST: ClassVar[int] = 6  # modes for a bar, for a start

    @cached_property
    def drivers(self) -> tuple[Driver, ...]:
        """The loads that act; one that moves nothing where there are none."""
        network = self.model.network
        acting = {load.source for load in self.model.loads_until(self.model.until)}
        every = drivers_of(network)
        found = tuple(each for each in every if {each.step, each.ramp} & acting)
        still = next((number for number, point in enumerate(network.points) if point.motion != "fixed"), 0)
        return found or (every[0] if every else Driver(still, fmpq(0), "none:step", "none:ramp"),)

    @cached_property
    def sources(self) -> tuple[tuple[str, str], ...]:
        return tuple((each.step, each.ramp) for each in self.drivers)

    @cached_property
    def loads(self) -> LinearLoads:
        self._refuse_motion()  # which acts, too
        return linear_loads(self.model.loads, self.sources, self.model.until, self.model.describe_step)

    @cached_property
    def roughness(self) -> tuple[Roughness, ...]:
        return tuple(roughness(self.loads))

    @cached_property
    def zero_outputs(self) -> tuple[bool, ...]:
        return zero_outputs(self.model, self.drivers, self.loads)

    @property
    def least(self) -> int:
        """As many modes as are taken at least."""
        return 1

    @cached_property
    def all_modes(self) -> int | None:
        """How many modes there are; None where bars have infinitely many."""
        return Stiffness(self.model.network).modes

    @property
    def fewest(self) -> int:
        """The modes to begin with."""
        return self.all_modes or max(self.FIRST * len(self.model.network.bars), self.least)

    @property
    def most(self) -> int:
        """More are not taken."""
        if self.all_modes:
            return self.all_modes
        return max(min(self.MOST, self.WORK // len(self.model.network.bars)), self.fewest)

    @cached_property
    def spectrum(self) -> Spectrum | DampedSpectrum:
        """Its modes."""
        return self.SPECTRUM(self.model.network, places(self.model))

    @property
    def cut(self) -> Cut:
        """The network with points wherever outputs are."""
        return self.spectrum.cut

    @cached_property
    def outputs(self) -> list[ModalOutput]:
        """The outputs, as they are read from a mode."""
        return [modal_output(self.model.network, self.cut, probe) for probe in self.model.probes]

    @abstractmethod
    def project(self, count: int) -> K:
        """The first modes. UnservedError for what modes do not serve."""

    @abstractmethod
    def errors(self, known: K, count: int, loads: Sequence[Roughness] | None = None) -> Array:
        """What the modes after the first `count` can add to each output, under its own or other `loads`."""

    @abstractmethod
    def system(self, known: K, count: int) -> ModalSystem:
        """The system of the first `count` modes."""

    def massless_accelerations(self) -> Iterator[Probe]:
        """The accelerations of what has no mass."""
        for probe, output in zip(self.model.probes, self.outputs, strict=True):
            if output.order == 2 and not output.massive:
                yield probe

    def refuse(self) -> None:
        """UnservedError for what no modes serve, CostError for too much."""
        network = self.model.network
        network.refuse_dead_loads()
        _ = self.loads  # refused before the work
        rods, most = len(network.bars), isqrt(self.WORK // self.FIRST)
        if rods > most:
            raise CostError(f"system: {rods} rods in modes, the limit is {most} (fewer rods or march helps)")

    def _refuse_motion(self) -> None:
        network = self.model.network
        moving = any(bar.velocity != 0 or bar.strain != 0 for bar in network.bars)
        if moving or any(point.velocity != 0 for point in network.points):
            raise UnservedError(
                "system: a motion or strain at tau = 0 is not supported by modes (take pieces or march)"
            )

    def output_bounds(self, known: K, count: int) -> Array:
        """What each output reaches, but for what is left out."""
        system, until = self.system(known, count), self.model.horizon()
        scheme = SteppedModes(
            scheme_tables(system, self.loads, DOUBLE), {"loads": len(self.drivers)}, until, np.float64
        )
        return rounding_errors(system, self.loads, scheme, until, DOUBLE).largest


_REASONABLE = 0.1  # error relative to what a bound of the largest value may be read from
_FAST = 2.0  # the power of the number of modes with which errors of strains fall
_FAR = 64.0  # times the tolerance: what is not tried


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
    errors: Array
    largest: Array
    frequencies: Array
    damping: Array

    @property
    def count(self) -> int:
        """How many modes."""
        return len(self.frequencies)

    @cached_property
    def bounds(self) -> Array:
        """Of each output, relative to its largest value."""
        return _relative(self.errors, self.largest)


def truncate(chain: ModalModel[K]) -> ModalModes:
    """The first modes of a model, as many as leave out at most half of its tolerance.

    Raises:
        UnservedError: for what modes do not serve.
        ToleranceError: where too many would be needed.
    """
    model = chain.model
    tolerance = nearest(model.tolerance) / 2
    count, largest = chain.fewest, np.zeros(len(model.probes))
    about = largest
    while True:
        known = chain.project(count)
        errors = chain.errors(known, count)
        # an output that no mode has a part in may have no error at all, and has a largest value
        if np.any(errors > _REASONABLE * largest) or not largest.any():
            about = chain.output_bounds(known, count)
            largest = np.maximum(largest, about - errors)
        worst = _relative(errors, largest).max(initial=0.0)
        if worst <= tolerance:
            break
        # errors fall with a power of the number of modes, as they do from half of them
        half = max(chain.fewest // 2, count // 2)
        before = _relative(chain.errors(known, half), largest).max(initial=0.0)
        power = max(log(before / worst) / log(count / half), 1.0) if worst < before < inf else 1.0
        more = (worst / tolerance) ** (1 / power) if worst < inf else 4.0
        hopeless = worst < _REASONABLE and count * more > 4 * chain.most
        if worst >= _REASONABLE:  # of values, be they right or not, and if errors fall as fast as they may
            left = _relative(errors, about).max() * (count / chain.most) ** max(power, _FAST)
            hopeless = left > _FAR * tolerance
        if count == chain.most or hopeless:
            raise _tolerance_error(chain, errors, largest, (chain.most / count) ** power)
        count = min(ceil(count * min(max(1.05 * more, 1.2), 8.0)), chain.most)
    # of these as few as will do
    low, high = min(chain.least, count) - 1, count
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
        np.where(chain.zero_outputs, 0.0, largest),
        known.w[:high],
        system.damping[:high],
    )


def _tolerance_error(chain: ModalModel[K], errors: Array, largest: Array, better: float) -> ToleranceError:
    model = chain.model
    bounds = _relative(errors, largest)
    worst = int(np.argmax(bounds))
    name = model.probes[worst].name
    bound = 2 * float(bounds[worst]) / better
    if bound < inf:
        what = f"leave a bound of about {bound:.2g} for {name}"
    else:
        what = f"would not tell the largest value of {name} from 0 (leaving it out may help)"
    return unmet_tolerance(model.tolerance, {"modes": f"{chain.most} modes, the most taken, {what}"}, bound)


def _relative(errors: Array, largest: Array) -> Array:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(errors > 0, errors / largest, 0.0)

"""Model -> modes: as many as its tolerance needs, and what those that are left out can add at most."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil, inf, log
from typing import Any

import numpy as np

from wavesym.errors import ToleranceError
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest
from wavesym.programs.modes.chain import K, ModalChain
from wavesym.programs.modes.loads import LinearLoads
from wavesym.programs.modes.modal import ModalSystem, Numbers
from wavesym.programs.modes.slowed import SlowedChain
from wavesym.programs.modes.swinging import SwingingChain

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
    return _enough(model, modal_chain(model))


def modal_chain(model: Model) -> ModalChain[Any]:
    """A model as modes, until its last double or later: with dashpots they die away."""
    model = model.to_horizon()
    return SlowedChain(model) if model.network.loses else SwingingChain(model)


def _enough(model: Model, chain: ModalChain[K]) -> ModalModes:
    tolerance = nearest(model.tolerance) / 2
    count, largest = chain.fewest, np.zeros(len(model.probes))
    about = largest
    while True:
        known = chain.shares(count)
        errors = chain.errors(known, count)
        # an output that no mode has a part in may have no error at all, and has a largest value
        if np.any(errors > _REASONABLE * largest) or not largest.any():
            about = chain.reached(known, count)
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


def _unmet(model: Model, chain: ModalChain[K], errors: Numbers, largest: Numbers, better: float) -> ToleranceError:
    bounds = _relative(errors, largest)
    worst = int(np.argmax(bounds))
    name = model.probes[worst].name
    if bounds[worst] < inf:
        what = f"leave a bound of about {2 * bounds[worst] / better:.2g} for {name}"
    else:
        what = f"would not tell the largest value of {name} from 0 (leaving it out may help)"
    return ToleranceError(
        f"output.tolerance: {nearest(model.tolerance):g} cannot be met: modes: {chain.most} modes, the most "
        f"taken, {what}"
    )


def _relative(errors: Numbers, largest: Numbers) -> Numbers:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(errors > 0, errors / largest, 0.0)

"""What rounding can do to modes that are stepped, and how large their outputs are.

A free mode only loses of w^2 y^2 + v^2, and |y| <= |y_0| + |v_0| t. So in the size |y|/T + |v|, T = min(1/w, tau_max),
an error that is made once never more than doubles, and a force f adds at most 4 f min(s, T) in a panel of length s.
As v^2 + 2 z w y v + w^2 y^2, z the damping, falls as exp(-2 z w t), it even falls below 2.5 exp(-z w t) of itself where
z <= 1/2 and T = 1/w. The numbers of a step are wrong, in that size, by at most _STEP (1 + (1 + 2 z) w s) units
roundoff: `exp`, `sin` and `cos` are within 4 ulp, their arguments and the frequency are rounded a few times, and so are
the sums. A rounded time moves a mode by (1 + 2 z) w tau roundoffs more.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import Real
from wavesym.programs.modes.loads import LinearLoads
from wavesym.programs.modes.modal_system import ModalSystem
from wavesym.programs.modes.stepping import SteppedModes

_STEP = 16
_MORE = 1.01  # for the roundings of this file


class RoundingErrors(NamedTuple):
    """Of each output: how wrong rounding can make it on the horizon, and a value that it is not below somewhere."""

    errors: Array
    largest: Array


def rounding_errors(
    system: ModalSystem, loads: LinearLoads, scheme: SteppedModes, tau_max: float, real: Real
) -> RoundingErrors:
    """The errors of a scheme in `real` numbers that steps a system under loads, all of which begin by tau_max."""
    unit, w = nearest(real.roundoff), system.frequency
    times = [*map(nearest, loads.times), tau_max]
    lengths = np.diff(times)
    a = np.array([[abs(nearest(value)) for value in row] for row in loads.samples])
    slopes = np.array([abs(nearest(slope)) for slope in loads.slopes])
    force = np.abs(system.pushes) @ (a.max(axis=0) + slopes * lengths[-1])
    reach = 1 / np.maximum(w, 1 / tau_max) if tau_max > 0 else np.zeros(len(w))
    size, at_times = _sizes(scheme, reach, tau_max)
    size += 4 * np.minimum(reach, lengths.max()) * force
    swift = (1 + 2 * system.damping) * w
    wrong = _sum_over_panels(system, lengths, swift, tau_max)
    made = unit * (_STEP * wrong * size + 4 * tau_max * (swift * size + force))
    weight = np.abs(system.displacement_weights) * reach + np.abs(system.velocity_weights)
    errors = weight @ (2 * made + unit * (len(w) + 20) * size)
    errors += np.einsum("ojk,jk->o", np.abs(system.direct), _integrals(scheme, slopes, lengths, unit))
    return RoundingErrors(_MORE * errors, np.maximum(at_times - _MORE * errors, 0.0))


def _sum_over_panels(system: ModalSystem, lengths: Array, swift: Array, tau_max: float) -> Array:
    """The sum over panels of 1 + (1 + 2 damping) w s, each as far as it is not damped away until it counts."""
    w, count = system.frequency, len(lengths) + 1
    whole = count + swift * tau_max
    shortest = lengths[:-1].min(initial=tau_max)
    left = np.exp(-system.damping * w * shortest)
    fading = (system.damping > 0) & (system.damping <= 0.5) & (w * tau_max >= 1) & (left < 1)
    lasting = 1.25 * (2 - left) / np.where(fading, 1 - left, 1.0)  # panels, and the one that values are in
    return np.where(fading, np.minimum(lasting * (1 + swift * lengths.max()), whole), whole)


def _sizes(scheme: SteppedModes, reach: Array, tau_max: float) -> tuple[Array, Array]:
    """The largest |y|/T + |v| of each mode at the instants, and the largest size there of each output."""
    size, largest = np.zeros(len(reach)), np.zeros(scheme.outputs)
    for states, outputs in scheme.starts():
        y, v = np.abs(states).astype(np.float64).max(axis=0)
        size = np.maximum(size, y / np.where(reach > 0, reach, 1.0) + v)
        largest = np.maximum(largest, np.abs(outputs).max(axis=0, initial=0.0))
    return size, np.maximum(largest, np.abs(scheme.evaluate([tau_max])).max(axis=1))


def _integrals(scheme: SteppedModes, slopes: Array, lengths: Array, unit: float) -> Array:
    """How wrong loads and their integrals are: (loads, 3). They are sums of as many terms as there are panels."""
    h, tau, count = lengths.max(), lengths.sum(), len(lengths) + 8
    load, once, twice = np.abs(scheme.load[1:]).astype(np.float64).max(axis=1)
    steepest = np.maximum(slopes, np.abs(scheme.load[0]).astype(np.float64).max(axis=0))
    load = load + lengths[-1] * slopes
    once, twice = once + lengths[-1] * load, twice + lengths[-1] * (once + lengths[-1] * load)
    wrong = count * once + 4 * tau * load
    return unit * np.stack(
        [4 * (load + tau * steepest), wrong, tau * wrong + count * twice + 4 * tau * once + 4 * h * tau * load], axis=1
    )

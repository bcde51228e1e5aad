"""The reference: values of a scene's outputs that are right to the last bit, whatever they cost.

Two routes lead there, and both are balls: the exact tables, where they are of moderate size, and power series on
windows, where they are not (many unequal rates, many reflections).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cached_property, partial

from flint import arb

from wavesym.errors import CostError
from wavesym.evaluators.ball import Segment, largest, segments, values
from wavesym.evaluators.doubles import not_below, rational
from wavesym.evaluators.motion import Motion
from wavesym.evaluators.signal import Signal, horizon, signals
from wavesym.mechanics.chain import chain
from wavesym.mechanics.cone import light_cone
from wavesym.scene import Scene

# nodes times windows that are known in seconds
_QUICK = 6000
# coefficients of the tables from which on windows are cheaper
_MODERATE = 50_000


def beginning(scene: Scene) -> Scene:
    """The scene, or as much of its horizon as takes little time to know exactly."""
    nodes = len(light_cone(chain(scene), scene.outputs, scene.output.until))
    if nodes * scene.output.until <= _QUICK:
        return scene
    shorter = {"until": Fraction(max(8, _QUICK // nodes))}
    return scene.model_copy(update={"output": scene.output.model_copy(update=shorter)})


class Reference:
    """The outputs of a scene on [0, tau_max], in balls. CostError where that would cost too much."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.tau_max = horizon(scene)

    @cached_property
    def signals(self) -> tuple[Signal, ...] | None:
        """The outputs as exact sums of arrivals; None where their tables would be large."""
        try:
            return signals(self.scene, _MODERATE)
        except CostError:
            return None

    @cached_property
    def _sources(self) -> list[Callable[[], Sequence[Segment]]]:
        if self.signals is not None:
            return [partial(segments, signal) for signal in self.signals]
        motion = Motion(self.scene, rational(self.tau_max))
        return [partial(motion.segments, place) for place in motion.places]

    def values(self, taus: Sequence[float]) -> list[list[float]]:
        """Each output at doubles 0 <= tau <= tau_max, correctly rounded."""
        return [values(source, taus, self.tau_max) for source in self._sources]

    def largest(self) -> list[arb]:
        """A lower bound of the largest absolute value of each output; 0 where it is 0 throughout."""
        return [largest(source, self.tau_max) for source in self._sources]

    def breakpoints(self) -> list[float]:
        """All tau at which an output may jump or bend, as doubles at or just above."""
        starts = {segment.start for source in self._sources for segment in source()}
        return sorted(not_below(start) for start in starts)

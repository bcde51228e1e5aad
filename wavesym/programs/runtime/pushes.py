"""What loads do when their amplitudes come at run time: the events of a march, each times an amplitude."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby

from flint import fmpq, fmpq_poly

from wavesym.errors import UnservedError
from wavesym.mechanics.loads import Applied, AppliedRecord
from wavesym.mechanics.model import Model
from wavesym.programs.runtime.units import Function


@dataclass(frozen=True)
class Push:
    """From panel `panel` of window `window` on, `strength` and `weight` times amplitude `load` times the `power` of the
    time since acts as load `force` (in the units of a law that is divided by g): added to what acts there, or, `anew`,
    in its place.
    """

    window: int
    panel: int
    force: int
    power: int
    strength: Function
    load: int
    weight: fmpq = field(default_factory=lambda: fmpq(1))
    anew: bool = False


def as_one(model: Model) -> list[Applied]:
    """All loads of a model, which have no amplitude of their own."""
    loads = tuple(load for load in model.loads if load.source != "impact")
    return [AppliedRecord(loads[0].source, loads[0].time, fmpq(1), loads)] if loads else []


def told(changes: Sequence[Applied], powers: Mapping[str, fmpq_poly]) -> Iterator[tuple[fmpq, int, fmpq, bool]]:
    """When, which power and how much of it: at each change all that acts, so that nothing adds up."""
    since, acts, begun = fmpq(0), fmpq_poly(), False
    for time, same in groupby(changes, key=lambda change: change.time):
        new = sum((change.weight * powers[change.source] for change in same if change.source in powers), fmpq_poly())
        if new:
            since, acts = time, acts(fmpq_poly([time - since, 1])) + new
            told = [(power, acts[power]) for power in range(3) if acts[power]] or [(0, fmpq(0))]
            for place, (power, weight) in enumerate(told):
                yield time, power, weight, begun and place == 0
            begun = True


def ordered(pushes: Iterable[Push]) -> tuple[Push, ...]:
    """In the order of time. UnservedError where samples, which are told anew, have an amplitude beside another one."""
    found = tuple(sorted(pushes, key=lambda push: (push.window, push.panel)))
    for force in {push.force for push in found if push.anew}:
        if len({push.load for push in found if push.force == force}) > 1:
            raise UnservedError(
                "--runtime: load given where samples act beside another load on the same body, one load expected "
                "there (samples that are added up, or loads as in the scene, help)"
            )
    return found

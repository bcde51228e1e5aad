"""When each output is first felt on the horizon, contacts that open and close included.

There it is the start of the first piece that, in balls, certainly is not 0. What is at rest until loads that do not
jump act on it needs no transform: the light cone tells, but for outputs that are 0 throughout.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain, pairwise

from flint import ctx, fmpq

from wavesym.exact.arrivals import arrivals
from wavesym.exact.motion import Motion
from wavesym.exact.tables.ball import Segment
from wavesym.mechanics.gauge import positions
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import rational

_MOST = 200_000  # fronts that are followed: some seconds
_MOMENT = fmpq(1, 2**64)  # of the horizon: pieces as short are stretches on which it is left open what a link does


def first_arrivals(model: Model) -> list[fmpq | None]:
    """The tau of each output; None where nothing arrives on the horizon (or within the first _MOST fronts).

    CostError where contacts open and close too often.
    """
    until = rational(model.horizon())
    if model.network.corners:
        motion = Motion(model, until)
        with ctx.workprec(motion.first_bits):
            return [_begins(motion.walk(probe), until) for probe in model.probes]
    found: list[fmpq | None] = [None] * len(model.probes)
    shortest = model.network.shortest
    early, left = shortest, list(range(len(found)))
    while left:
        early = min(2 * early, until)
        beginning = replace(model.watching(model.probes[k] for k in left), loads=model.loads_until(early))
        for k, time in zip(left, arrivals(beginning, early), strict=True):
            found[k] = time
        left = [k for k in left if found[k] is None]
        fronts = len(model.network.joints) * (1 + len(beginning.loads)) * early / shortest
        if early == until or fronts > _MOST:
            break
    return found


def light_arrivals(model: Model) -> list[fmpq | None]:
    """When the first load can be felt by each output of a chain that rests until then; None: not on the horizon."""
    network, last = model.network, rational(model.horizon())
    starts: dict[int, fmpq] = {}
    for number, point in enumerate(network.points):
        sources = {unit.source for unit in point.loads}
        times = [load.time for load in model.loads if load.source in sources]
        if times:
            joint = network.joint_of[number]
            starts[joint] = min([starts[joint], *times] if joint in starts else times)
    found: list[fmpq | None] = []
    for probe in model.probes:
        distances = network.distances(*positions([reading for _, reading in model.sums[probe]]))
        times = [time + distances[joint] for joint, time in starts.items() if joint in distances]
        found.append(min((time for time in times if time <= last), default=None))
    return found


def _begins(segments: Iterator[Segment], until: fmpq) -> fmpq | None:
    begin = fmpq(0)
    for segment, after in pairwise(chain(segments, (None,))):
        assert segment is not None  # the last one has none after it
        end = after.start if after else until
        if segment.start - begin > until * _MOMENT:
            begin = segment.start
        if any(segment.evaluate((end - segment.start) * fmpq(k, 3)) != 0 for k in range(4)):
            return begin
    return None

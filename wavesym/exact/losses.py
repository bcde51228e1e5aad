"""What links lose where they slide or yield: their force then is constant, so that only how far they went is asked.

A dashpot that acts with a spring on one side takes c times the square of the rate meanwhile.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

from flint import arb, ctx, fmpq

from wavesym.exact.contacts.events import contact_schedule
from wavesym.exact.contacts.touching_waves import Stage
from wavesym.exact.motion import Motion
from wavesym.exact.tables.ball import Balls
from wavesym.mechanics.gauge import gauge_at
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Link
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import rational

_BRIEF = 2**64  # longest stretches on which a branch may be left open: on shorter ones a spring may have acted
_NOTHING = fmpq(1, 10**9)  # of a spring's limit: what it bears until it is certain that it yields without a force


@dataclass(frozen=True)
class LinkLoss:
    """A link that rubs or yields: how far that took it until the end, `set`, and the energy `dissipated`, as balls.

    Of a spring on one side, or on both sides of a gap, that is what the dashpot took that acts with it; it has no set.
    What `gives_way` is a spring of which one limit is 0, that yields on this side as soon as it is loaded, and never on
    the other.
    """

    link: Link
    set: arb
    dissipated: arb
    gives_way: bool = False


def losses(model: Model, solved: Model | None = None) -> tuple[LinkLoss, ...]:
    """Those of all links that can reach an output, up to the horizon: friction, springs that yield, engaged dashpots.

    `solved` is the same with more outputs, where what its links do is known already.
    CostError, GrazingError as in `events`.
    """
    until = rational(model.horizon())
    links = {n: model.network.links[n] for n in model.contacts(until)}
    losing = {n: link for n, link in links.items() if link.friction != 0 or link.limits is not None}
    damped = {n: link for n, link in links.items() if link.side != 0 and link.damping != 0}
    solved = solved or model
    known = contact_schedule(solved, until) if losing or damped else None
    if known is None:
        return ()
    probes = {
        (quantity, point): _probe(model, quantity, point)
        for quantity, some in (("displacement", losing), ("velocity", damped))
        for link in some.values()
        for point in (link.left, link.right)
    }
    motion = Motion(solved.watching([*solved.probes, *probes.values()]), until)
    with ctx.workprec(bits := motion.first_bits):
        seen = {key: Balls(motion.segments(probe, bits)) for key, probe in probes.items()}
        found: list[LinkLoss] = []
        for n, link in links.items():
            stages = known.stages[model.network.joint_of[link.left]]
            if n in damped:
                rate = _LinkMotion(seen["velocity", link.left], seen["velocity", link.right], link.ratio)
                work = arb(link.damping) * _engaged_square(n, stages, until, rate, known.vague * _BRIEF)
                other = found.pop() if found and _is_other_side(found[-1].link, link) else None
                found.append(LinkLoss(link, arb(0), work + (other.dissipated if other else 0)))
            if n not in losing:
                continue
            stretch = _LinkMotion(seen["displacement", link.left], seen["displacement", link.right], link.ratio)
            slides = _slides(n, stages, until)
            before = [stage.start for stage in stages if slides and stage.start <= slides[0][1]]
            gives_way = all(_bears_nothing(link, sign) for sign, *_ in slides) and _is_unstrained(link, stretch, before)
            found.append(replace(_loss(link, slides, stretch), gives_way=gives_way))
        return tuple(found)


class _LinkMotion(NamedTuple):
    """How much longer a link is than at tau = 0, or how fast it gets longer, by what its ends do."""

    left: Balls
    right: Balls
    ratio: fmpq

    def evaluate(self, tau: fmpq) -> arb:
        """The value at an instant."""
        return self.right.evaluate(tau) - arb(self.ratio) * self.left.evaluate(tau)

    def integrate_square(self, low: fmpq, high: fmpq) -> arb:
        """The integral of its square from one instant to another."""
        starts = (segment.start for balls in (self.left, self.right) for segment in balls.segments)
        total = arb(0)
        for start, end in pairwise(sorted({low, high, *(start for start in starts if low < start < high)})):
            value = self.right.polynomial_from(start) - arb(self.ratio) * self.left.polynomial_from(start)
            total += (value * value).integral()(arb(end - start))
        return total


def _probe(model: Model, quantity: str, point: int) -> Probe:
    at = gauge_at(quantity, model.network, point)
    return Probe(f"{quantity} of {point}", quantity, at.rod, at.place, at.point)


def _is_other_side(one: Link, other: Link) -> bool:
    """Whether two springs are those of one gap."""
    return one.side != 0 and (one.left, one.right, -one.side) == (other.left, other.right, other.side)


def _engaged_square(number: int, stages: Sequence[Stage], until: fmpq, rate: _LinkMotion, brief: fmpq) -> arb:
    """The integral of the square of a rate while a spring acts, which it may also do while it idles `brief`ly."""
    ends, total = [*(stage.start for stage in stages), until], arb(0)
    for stage, (low, high) in zip(stages, pairwise(ends), strict=True):
        if number in stage.branches.closed_links and low < high:
            total += rate.integrate_square(low, high)
        elif low < high <= low + brief:
            total += rate.integrate_square(low, high).union(arb(0))
    return total


def _slides(number: int, stages: Sequence[Stage], until: fmpq) -> list[tuple[int, fmpq, fmpq]]:
    """Which way a link slides or yields, from when to when."""
    ends = [*(stage.start for stage in stages), until]
    stretches = zip(stages, pairwise(ends), strict=True)
    return [(sign, low, high) for stage, (low, high) in stretches if (sign := stage.branches.sliding.get(number, 0))]


def _bears_nothing(link: Link, sign: int) -> bool:
    """Whether a spring that yields this way does so without a force, and with one on the other."""
    if link.limits is None:
        return False
    pull, push = link.limits
    return push > 0 == pull if sign > 0 else pull > 0 == push


def _is_unstrained(link: Link, stretch: _LinkMotion, taus: Sequence[fmpq]) -> bool:
    """Whether a spring without a preload bears at most `_NOTHING` of its limit at all of some tau and between."""
    if not taus or link.limits is None or link.preload != 0:
        return False
    places = [*taus, *((low + high) / 2 for low, high in pairwise(taus))]
    allowed = arb(_NOTHING * max(link.limits) / link.stiffness)
    return all(abs(stretch.evaluate(tau)) < allowed for tau in places)


def _loss(link: Link, slides: list[tuple[int, fmpq, fmpq]], stretch: _LinkMotion) -> LinkLoss:
    pull, push = link.limits or (link.friction, link.friction)
    total, work = arb(0), arb(0)
    for sign, low, high in slides:
        moved = stretch.evaluate(high) - stretch.evaluate(low)
        total += moved
        work += sign * (pull if sign > 0 else push) * moved
    return LinkLoss(link, total, work)

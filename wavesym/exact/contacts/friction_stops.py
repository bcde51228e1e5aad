"""What friction stops: which way it may be moving yet, when it has come to rest, what it may slip beyond a limit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from flint import arb, ctx, fmpq

from wavesym.exact.contacts.cluster import Touch
from wavesym.exact.contacts.cluster_motion import ClusterMotion
from wavesym.exact.contacts.crossing import shortfall
from wavesym.exact.contacts.guards import lasts_until, margins
from wavesym.exact.joints.enclosure import Enclosure
from wavesym.numbers.doubles import middle

_LATER = 2  # times: when friction has stopped a mass is not known closely
_SPARE = 64  # bits of the working precision: the others tell how closely it is known since when a limit is passed


def way_of(motion: ClusterMotion, k: int, one_way: Mapping[int, int]) -> int:
    """Which way a point may be moving that moves as a mass that friction stops; 0 where that is not known."""
    cluster = motion.cluster
    for j, sign in one_way.items():
        if cluster.group(j) == cluster.group(k):
            return sign if cluster.ratio(k) / cluster.ratio(j) > 0 else -sign
    return 0


def _masses_on_ground(motion: ClusterMotion) -> Iterator[tuple[int, int]]:
    """The friction that holds a mass on the ground, and the mass, where no other one moves as that does."""
    group = motion.cluster.group
    for n in motion.cluster.pushes:
        k = motion.joint.mass_on_ground(n)
        if k >= 0 and [j for j in motion.held_masses if group(j) == group(k)] == [k]:
            yield n, k


def find_ways(motion: ClusterMotion) -> None:
    """Which way the masses that friction holds on the ground may be moving yet.

    One that certainly moved that way does not turn round as long as friction may bear what would hold it: N is what
    drives it beyond friction, so that r' = 0 or -sign(r) (R - N sign(r)) w, and r has the sign it had or is 0.
    """
    for n, k in _masses_on_ground(motion):
        velocity = motion.joint.velocity(k)
        if sign := motion.joint.stopping.get(k, int(velocity > 0) - int(velocity < 0)):
            motion.result.stops[n] = (k, sign)


def find_rests(motion: ClusterMotion) -> None:
    """When what friction holds on the ground has certainly stopped: beside what it bears at rest, it has some left.

    The rate r of its right side then has |r|' <= -(R - |N|) w, with w its `lightness`. Nothing else may rub on it.
    """
    rates = motion.unseen_rates(motion.result.state)
    for n, k in _masses_on_ground(motion):
        touch = motion.joint.touches[n]
        rate = rates.get(k, arb(0)) * arb(1 if k == touch.right else touch.ratio)
        if (since := _rest_time(motion, n, rate)) is not None:
            motion.result.rests[n] = since


def _rest_time(motion: ClusterMotion, n: int, rate: arb) -> fmpq | None:
    """When a mass on the ground that is this fast at most has stopped; None where that is not certain."""
    if rate == 0:
        return fmpq(0)
    push, limit, lightness = motion.result.pushes[n], arb(motion.joint.touches[n].friction), motion.joint.lightness(n)
    stopping = (limit - abs(push.evaluate(fmpq(0)))) * lightness
    if not stopping > 0:
        return None
    since = min(middle((_LATER * rate / stopping.lower()).upper()), motion.length)
    worst = abs(push.evaluate_on(arb(0).union(arb(since))))
    return since if rate < (limit - worst) * lightness * arb(since) else None


def lose_excess(motion: ClusterMotion) -> None:
    """What sticks and is pulled beyond its limits may slide meanwhile: energy that is not known."""
    for root in slips(motion).values():
        motion.result.state |= motion.lose(root, motion.result.state)


def slips(motion: ClusterMotion) -> dict[int, arb]:
    """The root of the energy that is not known of what sticks and is pulled beyond its limits, where it may be.

    By dE/dt <= e d, with a force that is off by d, sqrt(E) grows by at most the integral of d sqrt(w/2), with w the
    `lightness` of what it holds. Where contacts are vague, that may have any value in its range at any time.
    """
    found, mass = {}, motion.joint.law.mass
    for n in motion.cluster.pushes:
        touch, push = motion.joint.touches[n], motion.result.pushes[n]
        if not _may_slip(touch) or not set(touch.sides).intersection(motion.cluster.stuck_points):
            continue
        if motion.result.branches.vague:
            impulse = excess(touch, push, motion.span) * arb(motion.length)
        else:
            shortfalls = (shortfall_integral(each, motion.length) for each in margins(touch.friction, push))
            impulse = sum(shortfalls, arb(0))
        if impulse > 0:
            motion.result.excesses.add(n)
            lightness = sum((1 / mass[j] for j in touch.sides if mass[j] != 0), fmpq(0))
            found[n] = (impulse * (arb(lightness) / 2).sqrt()).upper()
    return found


def _may_slip(touch: Touch) -> bool:
    """Whether it is friction of which it is left open on which branch it is, as that is energy."""
    return touch.friction != 0 and touch.breakaway == 0


def excess(touch: Touch, force: Enclosure, span: arb) -> arb:
    """By how much what sticks bears more than its limit anywhere in a span, at most; not certainly more than 0."""
    return (abs(force.evaluate_on(span)) - arb(touch.friction)).upper() if _may_slip(touch) else arb(0)


def shortfall_integral(margin: Enclosure, length: fmpq) -> arb:
    """How much a function may be below 0 on a stretch, integrated, at most."""
    end = lasts_until(margin, fmpq(0), length, length / fmpq(2) ** (ctx.prec - _SPARE))
    return arb(0) if end is None else shortfall(margin, length) * arb(length - end.length)

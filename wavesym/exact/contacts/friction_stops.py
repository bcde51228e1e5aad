"""What friction stops: which way it may be moving yet, when it has come to rest, what it may slip beyond a limit."""

from __future__ import annotations

from collections.abc import Mapping

from flint import arb, ctx, fmpq

from wavesym.exact.contacts.cluster import Cluster, Touch
from wavesym.exact.contacts.cluster_states import ClusterStates
from wavesym.exact.contacts.crossing import shortfall
from wavesym.exact.contacts.guards import lasts_until, margins
from wavesym.exact.contacts.holding_forces import HoldingForces
from wavesym.exact.contacts.joint_stretch import JointStretch
from wavesym.exact.joints.enclosure import Enclosure
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.numbers.doubles import middle

_LATER = 2  # times: when friction has stopped a mass is not known closely
_SPARE = 64  # bits of the working precision: the others tell how closely it is known since when a limit is passed


class FrictionStops:
    """Of a joint the masses that friction stops, as time goes on; `resting` of its states are those that it has."""

    def __init__(
        self, law: JointLaw, touches: Mapping[int, Touch], forces: HoldingForces, states: ClusterStates
    ) -> None:
        self._law, self._touches, self._forces, self._states = law, touches, forces, states
        self._stopping: dict[int, int] = {}  # masses that friction stops, and which way they may be moving yet
        grounded = {self._mass_on_ground(n) for n, touch in touches.items() if touch.friction != 0} - {-1}
        states.resting = {k for k in grounded if states.of_point[k].velocity == 0}

    def take(self, moved: JointStretch) -> None:
        """Go on to the end of a stretch."""
        self._states.resting = {self._mass_on_ground(n) for n in moved.rests.keys() - moved.excesses}
        self._stopping = {k: sign for n, (k, sign) in moved.stops.items() if n not in moved.excesses}

    @staticmethod
    def way(cluster: Cluster, k: int, one_way: Mapping[int, int]) -> int:
        """Which way a point may be moving that moves as a mass that friction stops; 0 where that is not known."""
        for j, sign in one_way.items():
            if cluster.group(j) == cluster.group(k):
                return sign if cluster.ratio(k) / cluster.ratio(j) > 0 else -sign
        return 0

    def find_ways(self, cluster: Cluster, result: JointStretch) -> None:
        """Which way the masses that friction holds on the ground may be moving yet.

        One that certainly moved that way does not turn round as long as friction may bear what would hold it: N is what
        drives it beyond friction, so that r' = 0 or -sign(r) (R - N sign(r)) w, and r has the sign it had or is 0.
        """
        for n in cluster.pushes:
            if (k := self._mass_on_ground(n)) < 0 or not self._is_alone(cluster, k):
                continue
            velocity = self._states.of_point[k].velocity
            velocity += arb(0, (2 * self._states.of_point[k].error_energy / arb(self._law.mass[k])).sqrt().upper())
            sign = self._stopping.get(k, int(velocity > 0) - int(velocity < 0))
            if sign:
                result.stops[n] = (k, sign)

    def _is_alone(self, cluster: Cluster, k: int) -> bool:
        """Whether no other mass moves as one does."""
        return [j for j in self._states.held_masses(cluster) if cluster.group(j) == cluster.group(k)] == [k]

    def _mass_on_ground(self, n: int) -> int:
        """The mass that rubs on the ground, and on nothing else; -1 of other friction, or if it bears more at rest."""
        touch = self._touches[n]
        for k, other in (touch.sides, touch.sides[::-1]):
            if self._law.motions[other] == "fixed" and self._law.motions[k] is None and self._law.mass[k] != 0:
                rubs = [m for m, each in self._touches.items() if each.friction != 0 and k in each.sides]
                return k if rubs == [n] and touch.breakaway == 0 else -1
        return -1

    def find_rests(self, cluster: Cluster, result: JointStretch) -> None:
        """When what friction holds on the ground has certainly stopped: beside what it bears at rest, it has some left.

        The rate r of its right side then has |r|' <= -(R - |N|) w, with w its `lightness`. Nothing else may rub on it.
        """
        rates = self._states.unseen_rates(cluster, result.state)
        for n in cluster.pushes:
            touch, k = self._touches[n], self._mass_on_ground(n)
            if k < 0 or not self._is_alone(cluster, k):
                continue
            rate = rates.get(k, arb(0)) * arb(1 if k == touch.right else touch.ratio)
            since = self._rest_time(result, n, rate)
            if since is not None:
                result.rests[n] = since

    def _rest_time(self, result: JointStretch, n: int, rate: arb) -> fmpq | None:
        """When a mass on the ground that is this fast at most has stopped; None where that is not certain."""
        if rate == 0:
            return fmpq(0)
        held = abs(result.pushes[n].evaluate(fmpq(0)))
        stopping = (arb(self._touches[n].friction) - held) * self._forces.lightness(n)
        if not stopping > 0:
            return None
        since = min(middle((_LATER * rate / stopping.lower()).upper()), result.length)
        worst = abs(result.pushes[n].evaluate_on(arb(0).union(arb(since))))
        stopping = (arb(self._touches[n].friction) - worst) * self._forces.lightness(n)
        return since if rate < stopping * arb(since) else None

    def lose_excess(self, cluster: Cluster, result: JointStretch) -> None:
        """What sticks and is pulled beyond its limits may slide meanwhile: energy that is not known."""
        for root in self.slips(cluster, result).values():
            for j in cluster.points:
                result.state[j] = result.state.get(j, self._states.of_point[j]).lose(root**2)

    def slips(self, cluster: Cluster, result: JointStretch) -> dict[int, arb]:
        """The root of the energy that is not known of what sticks and is pulled beyond its limits, where it may be.

        By dE/dt <= e d, with a force that is off by d, sqrt(E) grows by at most the integral of d sqrt(w/2), with w the
        `lightness` of what it holds. Where contacts are vague, that may have any value in its range at any time.
        """
        found = {}
        for n in cluster.pushes:
            touch = self._touches[n]
            if touch.friction == 0 or touch.breakaway != 0 or not set(touch.sides).intersection(cluster.stuck_points):
                continue
            if result.branches.vague:
                force = result.pushes[n].evaluate_on(arb(0).union(arb(result.length)))
                impulse = (abs(force) - arb(touch.friction)).upper() * arb(result.length)
            else:
                impulse = sum(
                    (shortfall_integral(each, result.length) for each in margins(touch.friction, result.pushes[n])),
                    arb(0),
                )
            if impulse > 0:
                result.excesses.add(n)
                lightness = sum((1 / self._law.mass[j] for j in touch.sides if self._law.mass[j] != 0), fmpq(0))
                found[n] = (impulse * (arb(lightness) / 2).sqrt()).upper()
        return found

    def excess(self, n: int, force: Enclosure, tau: fmpq | arb) -> arb:
        """By how much what sticks bears more than its limit at an instant, or anywhere in a span, at most."""
        touch = self._touches[n]
        if touch.friction == 0 or touch.breakaway != 0:
            return arb(0)
        if isinstance(tau, fmpq) and force.exact is not None:
            return arb(abs(force.exact(tau)) - touch.friction).upper()
        return (abs(force.evaluate_on(arb(tau))) - arb(touch.friction)).upper()


def shortfall_integral(margin: Enclosure, length: fmpq) -> arb:
    """How much a function may be below 0 on a stretch, integrated, at most."""
    end = lasts_until(margin, fmpq(0), length, length / fmpq(2) ** (ctx.prec - _SPARE))
    return arb(0) if end is None else shortfall(margin, length) * arb(length - end.length)

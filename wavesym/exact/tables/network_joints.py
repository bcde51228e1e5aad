"""The joints of a network and what each answers, as far as that is exact; where sources act on them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, cached_property

from flint import fmpq

from wavesym.derivation.increments import Increment, add
from wavesym.errors import UnservedError
from wavesym.exact.joints.joint_law import JointEnd, JointLaw, joint_ends
from wavesym.exact.tables.joint_response import JointResponse, joint_polynomial, joint_response, polynomial_text, rates
from wavesym.mechanics.network import Network, Point

START = "start"
"""The source of what moves at tau = 0."""
MOST_POINTS = 20  # of a joint whose determinant is made
MOST_NAMES = 3  # of one, in a message


def unit_at(point: Point, source: str) -> Increment:
    """What a unit of a source does at a point: a force, or its velocity where that is prescribed."""
    total: Increment = {}
    for load in point.loads:
        if load.source == source:
            add(total, {fmpq(0): list(point.action(load))})
    return total


class NetworkJoints:
    """What the joints of a network answer, made when they are first asked for. UnservedError where it has contacts."""

    def __init__(self, network: Network) -> None:
        network.refuse_corners()
        network.refuse_dead_loads()
        self.network = network
        # of a joint M, C and K, its ends of bars, and what it answers
        self.law: Callable[[int], JointLaw] = cache(lambda number: JointLaw.assemble(network, network.joints[number]))
        self.ends: Callable[[int], tuple[JointEnd, ...]] = cache(lambda n: joint_ends(network, network.joints[n]))
        self.response: Callable[[int], JointResponse] = cache(self._response)

    def _response(self, number: int) -> JointResponse:
        """What a joint answers. UnservedError, with its polynomial, where that does not split over the rationals."""
        law = self.law(number)
        if (count := len(law.mass)) > MOST_POINTS:
            raise UnservedError(
                f"system: springs and dashpots hold {count} nodes together ({self.describe(number)}), and exact "
                f"tables support at most {MOST_POINTS} (take pieces, march or `run`)"
            )
        if rates(law) is None:
            raise UnservedError(
                f"system: the joint at {self.describe(number)} has the polynomial "
                f"{polynomial_text(joint_polynomial(law))}, and exact tables support only those with factors s + g, g "
                "rational (take pieces, march or `run`)"
            )
        return joint_response(law)

    def describe(self, number: int) -> str:
        """What a scene calls the points of a joint that are free to move: their names or places, a few of them."""
        law, joint = self.law(number), self.network.joints[number]
        points = [self.network.points[joint.points[k]] for k in sorted((*law.heavy, *law.light))]
        names = [point.name or f"x = {point.place}" for point in points]
        return ", ".join(names[:MOST_NAMES]) + (f" and {left} more" if (left := len(names) - MOST_NAMES) > 0 else "")

    @cached_property
    def sources(self) -> tuple[str, ...]:
        """The start, where not all stays as it is, and the unit loads."""
        units = (load.source for point in self.network.points for load in point.loads)
        return (*([START] if self.acting_joints(START) else []), *units)

    def acting_joints(self, source: str) -> tuple[int, ...]:
        """The joints at which a source acts."""
        network = self.network
        if source == START:
            return tuple(number for number, joint in enumerate(network.joints) if not network.at_rest(joint))
        points = (number for number, point in enumerate(network.points) if unit_at(point, source))
        return tuple(sorted({network.joint_of[number] for number in points}))

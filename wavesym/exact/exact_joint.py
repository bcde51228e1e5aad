"""A joint whose motion is a polynomial: rational data at a joint without mass, or in free flight, stay exact.

The powers come one after another as in `joint`, in rational numbers. Once nothing acts any more and the state's next
powers are all 0, so are all that follow, and the series is the motion itself. Otherwise it has no end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import fmpq, fmpq_poly

from wavesym.exact.joint import JointLaw

# powers beyond those of what acts, in which a motion that is a polynomial must have come to its end
_MORE = 5


@dataclass
class ExactMotion:
    """Where the points of a joint are and how fast (velocities by the point that leads a group), exactly."""

    velocity: dict[int, fmpq]
    displacement: list[fmpq]

    def moved(
        self, law: JointLaw, forces: Sequence[fmpq_poly], prescribed: Sequence[fmpq_poly]
    ) -> list[fmpq_poly] | None:
        """The velocities of the groups of points, or None where they are no polynomials."""
        size = range(len(law.mass))
        end = max([p.length() for p in (*forces, *prescribed)], default=0)
        inverse = law.inverse
        q: list[list[fmpq]] = [[] for _ in size]
        u = [[value] for value in self.displacement]
        last = {k: self.velocity[law.leaders[k]] for k in law.heavy}
        for n in range(end + _MORE):
            done = n >= end and not any(last.values())
            if done and not (law.springs and any(places[n] for places in u)):
                return [fmpq_poly(powers) for powers in q]
            pull = [
                forces[k][n] - sum((c * places[n] for c, places in zip(law.stiffness[k], u, strict=True)), fmpq(0))
                if law.springs
                else forces[k][n]
                for k in size
            ]
            for k in size:
                if law.given[k] is not None:
                    q[k].append(prescribed[k][n])
            for k in law.heavy:
                q[k].append(last[k])
            known = {k: q[k][n] for k in size if k not in law.light}
            right = [pull[k] - sum((law.damping[k][b] * v for b, v in known.items()), fmpq(0)) for k in law.light]
            for row, k in enumerate(law.light):
                q[k].append(sum((inverse[row, j] * value for j, value in enumerate(right)), fmpq(0)))
            for k in law.heavy:
                force = pull[k] - sum((law.damping[k][b] * q[b][n] for b in size), fmpq(0))
                last[k] = force / (law.mass[k] * (n + 1))
            if law.springs:
                for k, (group, ratio) in enumerate(law.moves):
                    u[k].append(ratio * q[group][n] / (n + 1))
        return None

    def after(self, law: JointLaw, q: Sequence[fmpq_poly], length: fmpq) -> ExactMotion:
        """At the end of a stretch with these velocities."""
        velocity = self.velocity | {law.leaders[k]: q[k](length) for k in law.heavy}
        displacement = [
            u + ratio * q[group].integral()(length)
            for u, (group, ratio) in zip(self.displacement, law.moves, strict=True)
        ]
        return ExactMotion(velocity, displacement if law.springs else self.displacement)

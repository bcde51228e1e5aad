"""A joint in motion: its points' velocities on a stretch without fronts, as polynomials with a proved error.

Of the law of a joint (`joint_law`), M q' + C q + K u = s with u' = q, coefficients of powers of w (the time since the
start of the stretch) come one after another; points without mass follow from the others at each power (`joint_series`).
What is kept are the middles: any error of theirs is in the defect
d = s - (M q' + C q + K u), and with E = (e M e + v K v)/2 for the errors e of q and v of u

    dE/dt = e d - e C e <= sqrt(2 E) delta + rho,

where delta is the size of d on points with mass, rho what points without mass can add. So
sqrt(E(t)) <= sqrt(E(0)) + delta t / sqrt(2) + sqrt(rho t): stiffness does not make errors grow. On a short stretch with
large defects another bound is better: with x = C^-1 d on the points without mass, what they add to dE/dt is at most
v K x <= sqrt(2 E) kappa, kappa = sqrt(x K x), and kappa t / sqrt(2) takes the place of sqrt(rho t).

Contacts that are closed make one `group` of their points, which move with fixed ratios. The defect of a group is the
sum over its points, each times its ratio, and the energy is the same sum over all points: the proof stays as it is,
and what is not known goes on unchanged where a contact opens or closes, as no mass changes its velocity then.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from typing import TYPE_CHECKING

from flint import arb, arb_poly, fmpq, fmpq_poly

from wavesym.exact.joints.enclosure import Enclosure, weighted_sum
from wavesym.exact.joints.joint_law import JointLaw, bound_sum
from wavesym.exact.joints.joint_series import motion_series

if TYPE_CHECKING:
    from wavesym.exact.joints.relaxation import Relaxation


@dataclass
class JointMotion:
    """A joint as time goes on: where its points are and how fast, and the energy of what is not known of that.

    Velocities are those of groups. `places` are the coefficients of the points' displacements on the last stretch;
    what springs make of these is off by at most sqrt(K_kk) `spring_error` at point k. Where it `decays`, the error of a
    body alone is taken to decay as the body does, which matters only where signs of what is left are asked for.
    """

    law: JointLaw
    velocity: list[arb]
    displacement: list[arb]
    unknown_energy: arb = field(default_factory=lambda: arb(0))
    places: list[list[arb]] = field(default_factory=list)
    spring_error: arb = field(default_factory=lambda: arb(0))
    decays: bool = False

    def move(
        self, forces: Sequence[Enclosure], prescribed: Sequence[fmpq_poly], length: fmpq, terms: int
    ) -> list[Enclosure]:
        """The velocities of the points on a stretch, in so many terms; afterwards the joint is at its end.

        `prescribed` are the velocities of the points whose motion is given, exact.
        """
        return self.follow(*self._series(forces, prescribed, terms), forces, length)

    def follow(
        self, q: list[list[arb]], u: list[list[arb]], forces: Sequence[Enclosure], length: fmpq
    ) -> list[Enclosure]:
        """The same along any series of the velocities of groups and the displacements of points, its integrals.

        How far it begins from where the joint is has to be among `unknown_energy`.
        """
        errors = self._errors(forces, q, u, length)
        result = [Enclosure(arb_poly(c), e) for c, e in zip(q, errors, strict=True)]
        self.places, h = u, arb(length)
        self.round([arb_poly(c)(h) for c in q], [arb_poly(c)(h) for c in u] if self.law.springs else [])
        return result

    def accelerations(
        self,
        forces: Sequence[Enclosure],
        rates: Sequence[Enclosure],
        velocities: Sequence[Enclosure],
        prescribed: Sequence[fmpq_poly],
    ) -> list[Enclosure]:
        """The derivatives of the `velocities` that `move` found for the last stretch.

        Args:
            forces: s on the points, and `rates`, its derivatives; on points with mass s alone matters.
            rates: M q' = s - C q - K u of points with mass, C q' = s' - K q of those without.
            velocities: q, as `move` gave it.
            prescribed: the velocities of the points whose motion is given.
        """
        law = self.law
        found = {
            k: Enclosure.from_polynomial(each.derivative())
            for k, each in enumerate(prescribed)
            if law.motions[k] is not None
        }
        for k in law.heavy:
            share = 1 / law.mass[k]
            slow = [(-share * c, velocities[b]) for b, c in enumerate(law.damping[k])]
            places = self.places if law.springs else [[]] * len(law.mass)
            sprung = [
                (-share * c, Enclosure(arb_poly(u), arb(0))) for c, u in zip(law.stiffness[k], places, strict=True)
            ]
            total = weighted_sum([(share, forces[k]), *slow, *sprung])
            strained = arb(share) * arb(law.stiffness[k][k]).sqrt() * self.spring_error
            found[k] = replace(total, error=(total.error + strained).upper())
        acting = {
            k: weighted_sum([(fmpq(1), rates[k]), *((-c, velocities[b]) for b, c in enumerate(law.stiffness[k]))])
            for k in law.light
        }
        found |= law.light_velocities(acting, found, weighted_sum)
        return [found[k] for k in range(len(law.mass))]

    def relax(
        self, relaxation: Relaxation, forces: Sequence[Enclosure], prescribed: Sequence[fmpq_poly], terms: int
    ) -> tuple[list[list[arb]], list[list[arb]], arb]:
        """The series without what decays fast, as `follow` takes it, and the energy of what it leaves out."""
        velocities, places = relaxation.series(
            self.velocity, self.displacement, *self._inputs(forces, prescribed, terms), terms
        )
        u = [[place] for place in places]
        if self.law.springs:
            for series, (group, ratio) in zip(u, self.law.moves, strict=True):
                series += [(arb(ratio) * c / n).mid() for n, c in enumerate(velocities[group], 1)]
        missed = self.energy(
            [now - series[0] for now, series in zip(self.velocity, velocities, strict=True)],
            [now - place for now, place in zip(self.displacement, places, strict=True)],
        )
        return velocities, u, missed

    def energy(self, velocity: Sequence[arb], displacement: Sequence[arb]) -> arb:
        """An upper bound of the energy that velocities of groups and displacements of points have."""
        law = self.law
        twice = sum((arb(law.mass[k]) * velocity[k] * velocity[k] for k in law.heavy), arb(0))
        if law.springs:
            for u, row in zip(displacement, law.elastic or law.stiffness, strict=True):
                twice += sum((arb(c) * u * other for c, other in zip(row, displacement, strict=True) if c != 0), arb(0))
        return (twice / 2).upper().max(arb(0))

    @property
    def rounded_energy(self) -> arb:
        """Of what rounding errors are parts: the energy that each velocity and each displacement has alone."""
        law = self.law
        parts = [arb(law.mass[k]) * self.velocity[k] ** 2 for k in law.heavy]
        if law.springs:
            rows = law.elastic or law.stiffness
            parts += [arb(rows[k][k]) * place**2 for k, place in enumerate(self.displacement)]
        return (sum(parts, arb(0)) / 2).upper()

    def lose(self, energy: arb) -> None:
        """Know less of the joint, by so much energy."""
        root = self.unknown_energy.sqrt() + energy.sqrt()
        self.unknown_energy = (root * root).upper()

    def round(self, velocity: Sequence[arb], displacement: Sequence[arb]) -> None:
        """Go on from the middles of balls; what rounding loses there is energy not known."""
        self.velocity = [each.mid() for each in velocity]
        if self.law.springs:
            self.displacement = [each.mid() for each in displacement]
        around = [[each - each.mid() for each in balls] for balls in (velocity, displacement)]
        self.lose(self.energy(*around))

    def _series(
        self, forces: Sequence[Enclosure], prescribed: Sequence[fmpq_poly], terms: int
    ) -> tuple[list[list[arb]], list[list[arb]]]:
        """The coefficients of q and u: middles, whatever rounding made of them."""
        acting, given = self._inputs(forces, prescribed, terms)
        *_, (q, u, _) = islice(
            motion_series(self.law, self.velocity, self.displacement, acting, given, arb, arb.mid), terms + 1
        )
        return q, u

    @staticmethod
    def _inputs(
        forces: Sequence[Enclosure], prescribed: Sequence[fmpq_poly], terms: int
    ) -> tuple[list[arb_poly], list[arb_poly]]:
        """The middles of forces, in so many terms, and prescribed velocities."""
        acting = [arb_poly([c.mid() for c in force.polynomial.coeffs()[:terms]]) for force in forces]
        return acting, [arb_poly([arb(c) for c in each.coeffs()]) for each in prescribed]

    def _errors(self, forces: Sequence[Enclosure], q: list[list[arb]], u: list[list[arb]], length: fmpq) -> list[arb]:
        """What the velocities may be off by, at most, on the stretch; and the energy of it at the end."""
        law = self.law
        h = arb(length)
        defect = {}
        for k in (*law.heavy, *law.light):
            left = sum((arb(c) * arb_poly(q[b]) for b, c in enumerate(law.damping[k]) if c != 0), arb_poly())
            left += sum((arb(c) * arb_poly(u[b]) for b, c in enumerate(law.stiffness[k]) if c != 0), arb_poly())
            if law.mass[k] != 0:
                left += arb(law.mass[k]) * arb_poly(q[k]).derivative()
            defect[k] = (_size(forces[k].polynomial - left, h) + forces[k].error).upper()
        through = law.light_velocities(defect, {}, bound_sum)
        delta, absorbed, kept = arb(0), arb(0), arb(0)  # kept and absorbed: the same, where points are slowed down
        for k in law.heavy:
            square = (defect[k] + bound_sum([(law.damping[k][b], speed) for b, speed in through.items()])) ** 2
            delta += square / arb(law.mass[k])
            if k in law.absorption:
                absorbed += square / (4 * arb(law.absorption[k]))
            else:
                kept += square / arb(law.mass[k])
        rho = sum((defect[k] * speed for k, speed in through.items()), arb(0)) / 4
        before = (2 * self.unknown_energy / arb(law.mass[law.heavy[0]])).sqrt() if law.heavy else arb(0)
        kappa = sum(
            (
                abs(arb(law.group_stiffness[a][b])) * one * other
                for a, one in through.items()
                for b, other in through.items()
                if law.group_stiffness[a][b] != 0
            ),
            arb(0),
        ).sqrt()
        added = (rho * h).sqrt().min(kappa * h / arb(2).sqrt())
        # the energy E grows as E' <= sum of d_k |q_k| - c_k q_k^2 <= sum of d_k^2/(4 c_k) + sqrt(2 E sum of d_k^2/M_k)
        slowed = (self.unknown_energy + absorbed * h).sqrt() + kept.sqrt() * h / arb(2).sqrt()
        root = ((self.unknown_energy.sqrt() + delta.sqrt() * h / arb(2).sqrt()).min(slowed) + added).upper()
        self.unknown_energy = (root * root).upper()
        self.spring_error = speed = (root * arb(2).sqrt()).upper()
        errors = {k: (speed / arb(law.mass[k]).sqrt()).upper() for k in law.heavy}
        if len(law.mass) == 1 and law.heavy and not (law.springs or law.rubs) and law.damping[0][0] != 0:
            (k,) = law.heavy  # a body alone comes to rest
            held = defect[k] / arb(law.damping[k][k])
            errors[k] = errors[k].min((before + held).upper())
            after = errors[k]
            if self.decays:
                after = after.min((before * (-arb(law.damping[k][k]) * h / arb(law.mass[k])).exp() + held).upper())
            self.unknown_energy = (arb(law.mass[k]) * after**2 / 2).upper()
        strained = {k: defect[k] + speed * arb(law.group_stiffness[k][k]).sqrt() for k in law.light}
        errors |= {k: bound.upper() for k, bound in law.light_velocities(strained, errors, bound_sum).items()}
        return [errors.get(k, arb(0)) for k in range(len(law.mass))]


def _size(polynomial: arb_poly, h: arb) -> arb:
    """The largest value on [0, h], at most."""
    total, power = arb(0), arb(1)
    for c in polynomial.coeffs():
        total += abs(c) * power
        power *= h
    return total.upper()

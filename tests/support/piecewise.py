"""Any chain whose links have corners, from the text of its scene alone: the truth that branches are held against.

Nothing of the package is used. Time goes on in steps for all points at once, from one instant at which anything is not
smooth to the next; in a step all that moves is a power series, with some 50 digits:

    M q' + C q + K u = sum over rod ends of 2 n Z a + F - sum of B P,      u' = q,      sent into an end: n q - a,

with the pull P of every link that has a corner: a multiplier where it is held, so that B q = 0, else what its branch
says. After every step the branches are the first, of all that may be, on which no guard is negative just afterwards.
Two instants, and any two numbers, are the same where they differ by less than `SAME`: nothing here is proved.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from heapq import heappop, heappush
from itertools import product
from math import ceil
from typing import Any, NamedTuple

from flint import arb, arb_poly, ctx, fmpq, fmpq_mat

from tests.support.assembly import Assembly, exact, jumps
from tests.support.laws import Branch
from tests.support.series import BITS, SAME, History, Piece, Unclear, first_fall, middle, sign_after

_NOTHING = arb_poly([])
# the series converge as (rate * step)^k/k!
_REACH, _TERMS = 4, 72


class Event(NamedTuple):
    """What happens at a link, and tau to some 50 digits."""

    place: str
    subject: str
    kind: str
    tau: fmpq


@dataclass(frozen=True)
class _Joint:
    """Points that links without length join, and the numbers of the corners between them."""

    points: tuple[int, ...]
    corners: tuple[int, ...]
    lasting: bool
    """Whether it has a state: a mass or a spring."""


class _Moved(NamedTuple):
    """The velocities of points, and stretches, rates and pulls of corners, in a step."""

    q: dict[int, arb_poly]
    corners: dict[int, tuple[arb_poly, arb_poly, arb_poly]]


class PiecewiseChain:
    """A chain of a scene, given as the table that its text is, for 0 <= tau <= until."""

    def __init__(self, scene: Mapping[str, Any], until: Fraction | int, most: int = 400) -> None:
        """AssertionError after more than `most` events; Unclear where something only touches 0."""
        self.until, self.events = fmpq(*Fraction(until).as_integer_ratio()), list[Event]()
        self._made, self._most = Assembly.of(scene), most
        self._loads: list[tuple[fmpq, int, int, fmpq]] = [
            (fmpq(*time.as_integer_ratio()), self._made.loaded(str(load["at"])), power, size)
            for load in scene.get("load", ())
            for time, power, size in jumps(load)
        ]
        with ctx.workprec(BITS):
            self._begin()
            self._march()

    def _begin(self) -> None:
        made = self._made
        self._joints = tuple(self._joined())
        self._joint_of = {point: number for number, joint in enumerate(self._joints) for point in joint.points}
        self._q = [History(fmpq(0)) for _ in made.mass]
        self._sent = {(k, s): History(rod.begun[1 - s]) for k, rod in enumerate(made.rods) for s in (0, 1)}
        self._speed = [arb(v) for v in made.velocity]
        self._u = [arb(0)] * len(made.mass)
        self._dissipated = [arb(0)] * len(made.corners)
        self._inverses: dict[object, list[list[arb]]] = {}

    # what it found

    @property
    def corners(self) -> list[tuple[str, str]]:
        """The place of each link with a corner, and what has it."""
        return [(corner.place, corner.subject) for corner in self._made.corners]

    def value(self, quantity: str, place: object, tau: Fraction) -> arb:
        """At tau (at a jump: after it)."""
        with ctx.workprec(BITS):
            return self._value(quantity, place, fmpq(*Fraction(tau).as_integer_ratio()))

    def _value(self, quantity: str, place: object, tau: fmpq) -> arb:
        made, where = self._made, self._made.shown(quantity, place)
        if isinstance(where, int):
            return self._q[where].integral(tau) if quantity == "displacement" else self._q[where].value(tau)
        rod, x = made.rods[where[0]], where[1]
        lates = [fmpq(*(far / rod.speed).as_integer_ratio()) for far in (x, rod.length - x)]
        right, left = (
            self._sent[where[0], s].integral(tau - late) - self._sent[where[0], s].integral(-late)
            if quantity == "displacement"
            else self._sent[where[0], s].value(tau - late)
            for s, late in enumerate(lates)
        )
        return (left - right) / arb(exact(rod.speed)) if quantity == "strain" else left + right

    def energy(self) -> arb:
        """That of masses, springs and rods at `until`; of springs that yield what they would give back."""
        made, total = self._made, arb(0)
        with ctx.workprec(BITS):
            for p, mass in enumerate(made.mass):
                total += mass * self._speed[p] ** 2 / 2
                total += (
                    sum((self._u[p] * x * self._u[j] for (i, j), x in made.stiffness.items() if i == p), arb(0)) / 2
                )
            for corner, branch, stretch in zip(made.corners, self._on, self._stretches(), strict=True):
                pull = branch.spring * stretch + branch.rest
                total += pull**2 / (2 * corner.law.stiffness) if corner.law.stiffness else 0
            for k, rod in enumerate(made.rods):
                begin = self.until - fmpq(*rod.delay.as_integer_ratio())
                total += rod.impedance * (self._sent[k, 0].square(begin, self.until))
                total += rod.impedance * (self._sent[k, 1].square(begin, self.until))
        return total

    def dissipated(self) -> list[arb]:
        """What each corner has taken by sliding or yielding, or its dashpot meanwhile, in the order of the text."""
        return list(self._dissipated)

    # time

    def _march(self) -> None:
        made = self._made
        delays = [fmpq(*rod.delay.as_integer_ratio()) for rod in made.rods]
        longest = min([*delays, fmpq(_REACH) / fmpq(ceil(self._rate() * 1024), 1024)])
        knots: list[tuple[fmpq, int]] = []
        for number in range(len(self._joints)):
            heappush(knots, (fmpq(0), number))
        for time, point, _, _ in self._loads:
            heappush(knots, (time, self._joint_of[point]))
        now = fmpq(0)
        while now < self.until:
            met = set()
            while knots and knots[0][0] <= now + SAME:
                met.add(heappop(knots)[1])
            self._send_on(knots, now, met, delays)
            end = min([now + longest, self.until, *(time for time, _ in knots[:1])])
            happened = self._step(now, end - now)
            for number, time in happened:
                heappush(knots, (time, number))
            now = happened[0][1] if happened else end

    def _send_on(self, knots: list[tuple[fmpq, int]], now: fmpq, met: set[int], delays: list[fmpq]) -> None:
        for number in met:
            for k, rod in enumerate(self._made.rods):
                for side in (0, 1):
                    if rod.ends[side] in self._joints[number].points:
                        there = self._joint_of[rod.ends[1 - side]]
                        if all(abs(time - now - delays[k]) > SAME or other != there for time, other in knots):
                            heappush(knots, (now + delays[k], there))

    def _step(self, now: fmpq, step: fmpq) -> list[tuple[int, fmpq]]:
        """One step, or a part of it up to the first thing that happens at a corner: the joints, and when."""
        made = self._made
        arriving = {
            (k, s): self._sent[k, 1 - s].about(now - fmpq(*rod.delay.as_integer_ratio()), step)
            for k, rod in enumerate(made.rods)
            for s in (0, 1)
        }
        solved, first = [], dict[int, fmpq]()
        for number, joint in enumerate(self._joints):
            found, watched = self._settled(joint, now, step, arriving)
            solved.append(found)
            times = [time for series in watched if (time := first_fall(series, step)) is not None]
            if times:
                first[number] = min(times)
        q = {point: series for found in solved for point, series in found.q.items()}
        for point, series in q.items():
            self._q[point].add(Piece(now, middle(series)))
        for (k, side), wave in arriving.items():
            rod = made.rods[k]
            self._sent[k, side].add(Piece(now, middle(q[rod.ends[side]] * arb(rod.ratios[side]) - wave)))
        last = min([step, *first.values()])
        for point, series in q.items():
            self._u[point] = (self._u[point] + series.integral()(arb(last))).mid()
            self._speed[point] = series(arb(last)).mid()
        for found in solved:
            for number, (_, rate, _) in found.corners.items():
                branch = self._on[number]
                if branch.sign:
                    self._dissipated[number] += branch.rest * rate.integral()(arb(last))
                elif branch.dashpot:
                    self._dissipated[number] += branch.dashpot * (rate * rate).integral()(arb(last))
        for corner, branch, stretch in zip(made.corners, self._on, self._stretches(), strict=True):
            corner.law.keep(branch, stretch)
        return [(number, now + last) for number, time in first.items() if time <= last + SAME]

    # branches

    def _settled(
        self, joint: _Joint, now: fmpq, step: fmpq, arriving: Mapping[tuple[int, int], arb_poly]
    ) -> tuple[_Moved, list[arb_poly]]:
        """How the points of a joint move, and what has to stay positive."""
        made = self._made
        corners = [made.corners[k] for k in joint.corners]
        stretches = self._stretches()
        offered = [
            list(corner.law.branches(stretches[k], self._rate_of(k, now)))
            for k, corner in zip(joint.corners, corners, strict=True)
        ]

        if now == 0:  # what it cannot be on at first it has not left
            for corner, choices in zip(corners, offered, strict=True):
                if all(branch.name != corner.law.now for branch in choices):
                    corner.law.now = choices[0].name

        def changes(branches: tuple[Branch, ...]) -> int:
            return sum(branch.name != corner.law.now for branch, corner in zip(branches, corners, strict=True))

        for branches in sorted(product(*offered), key=changes):
            found = self._moved(joint, branches, now, step, arriving)
            if found is None:
                continue
            watched = [
                guard
                for k, corner, branch in zip(joint.corners, corners, branches, strict=True)
                for guard in corner.law.guards(branch, *found.corners[k])
            ]
            if all(sign_after(series, step) >= 0 for series in watched):
                for k, corner, branch in zip(joint.corners, corners, branches, strict=True):
                    self._on[k] = branch
                    if branch.name != corner.law.now:
                        corner.law.now = branch.name
                        self.events.append(Event(corner.place, corner.subject, corner.law.event(branch), now))
                assert len(self.events) <= self._most, "too many events"
                return found, watched
        raise Unclear(f"no choice of branches at {float(now.p) / float(now.q)}")

    def _stretches(self) -> list[arb]:
        return [
            sum((self._u[p] * arb(factor) for p, factor in corner.stretch.items()), arb(0))
            for corner in self._made.corners
        ]

    def _rate_of(self, number: int, now: fmpq) -> arb | None:
        """How fast a corner gets longer, unless that may jump."""
        total = arb(0)
        for p, factor in self._made.corners[number].stretch.items():
            if p in self._made.motion:
                total += self._given(p, now)(arb(0)) * factor
            elif self._made.mass[p] == 0:
                return None
            else:
                total += self._speed[p] * factor
        return total

    def _moved(
        self,
        joint: _Joint,
        branches: tuple[Branch, ...],
        now: fmpq,
        step: fmpq,
        arriving: Mapping[tuple[int, int], arb_poly],
    ) -> _Moved | None:
        """Order by order: velocities of points without mass, accelerations of masses, and pulls of what is held.

        None where what is held cannot be, as masses move, or where nothing says what each takes.
        """
        made = self._made
        given = {p: self._given(p, now) for p in joint.points if p in made.motion}
        light = tuple(p for p in joint.points if made.mass[p] == 0 and p not in given)
        heavy = tuple(p for p in joint.points if made.mass[p] != 0 and p not in given)
        on = dict(zip(joint.corners, branches, strict=True))
        bonds = self._bonds(light, on)
        held = tuple(bonds)
        speed_of = {p: self._speed[p] for p in heavy} | {p: series(arb(0)) for p, series in given.items()}
        if any(
            abs(sum((speed_of[p] * b for p, b in bond.items()), arb(0))) > SAME
            for number, bond in bonds.items()
            if set(made.corners[number].stretch) & set(light) and not set(bond) & set(light)
        ):
            return None
        try:
            inverse = self._inverse(heavy, light, on, bonds)
        except ZeroDivisionError:
            return None
        acting = {p: self._acting(p, now) for p in (*heavy, *light)}
        for (k, side), wave in arriving.items():
            rod = made.rods[k]
            if rod.ends[side] in acting:
                acting[rod.ends[side]] += wave * arb(2 * rod.ratios[side] * rod.impedance)
        f = {p: series.coeffs() for p, series in acting.items()}
        terms = _TERMS
        if not joint.lasting:
            terms = max([1, *(len(series.coeffs()) for series in (*acting.values(), *given.values()))])
        q = {p: [] if p in light else [self._speed[p]] for p in joint.points}
        q |= {p: [at(series.coeffs(), k) for k in range(terms + 1)] for p, series in given.items()}
        u = {p: [self._u[p]] for p in joint.points}
        pulls: dict[int, list[arb]] = {k: [] for k in held}
        stretch = {k: {p: arb(factor) for p, factor in made.corners[k].stretch.items()} for k in on}
        for k in range(terms):
            known = {p: at(f[p], k) - self._bound(p, q, u, k, light) for p in (*heavy, *light)}
            for number, branch in on.items():
                if branch.held:
                    continue
                pull = branch.rest if k == 0 else arb(0)
                for p, factor in stretch[number].items():
                    pull += branch.spring * u[p][k] * factor
                    if p not in light and branch.dashpot:
                        pull += branch.dashpot * q[p][k] * factor
                for p, factor in stretch[number].items():
                    if p in known:
                        known[p] -= pull * factor
            rows = list(known.values())
            for number in held:
                factors = bonds[number]
                if any(p in light for p in factors):
                    rows.append(-sum((q[p][k] * b for p, b in factors.items() if p not in light), arb(0)))
                else:
                    rows.append(-sum((q[p][k + 1] * (k + 1) * b for p, b in factors.items() if p in given), arb(0)))
            answer = [sum((w * r for w, r in zip(line, rows, strict=True)), arb(0)) for line in inverse]
            for p, each in zip((*heavy, *light), answer, strict=False):
                q[p].append(each if p in light else each / (k + 1))
            for number, each in zip(held, answer[len(heavy) + len(light) :], strict=True):
                pulls[number].append(each)
            for p in joint.points:
                u[p].append(q[p][k] / (k + 1))
        series = {p: arb_poly(q[p]) for p in joint.points}
        found = dict[int, tuple[arb_poly, arb_poly, arb_poly]]()
        for number, branch in on.items():
            rate = sum((series[p] * b for p, b in stretch[number].items()), _NOTHING)
            longer = sum((arb_poly(u[p]) * b for p, b in stretch[number].items()), _NOTHING)
            pull = longer * arb(branch.spring) + rate * arb(branch.dashpot) + arb_poly([branch.rest])
            found[number] = longer, rate, arb_poly(pulls[number]) if branch.held else pull
        return _Moved(series, found)

    def _bound(self, p: int, q: Mapping[int, list[arb]], u: Mapping[int, list[arb]], k: int, but: Any) -> arb:
        """C q + K u of a point, order k, without the dashpots at some points."""
        total = arb(0)
        for other, c, stiff in self._rows[p]:
            if c and other not in but:
                total += q[other][k] * c
            if stiff:
                total += u[other][k] * stiff
        return total

    def _bonds(self, light: tuple[int, ...], on: Mapping[int, Branch]) -> dict[int, dict[int, fmpq]]:
        """Of each corner that is held a sum of velocities that is 0; of points without mass they say each only once.

        So a mass that touches a joint which friction holds is at rest itself.
        """
        bonds = dict[int, dict[int, fmpq]]()
        pivots = list[tuple[int, dict[int, fmpq]]]()
        for number in (k for k, branch in on.items() if branch.held):
            bond = dict(self._made.corners[number].stretch)
            for pivot, other in pivots:
                part = bond.get(pivot, fmpq(0)) / other[pivot]
                bond = {p: bond.get(p, fmpq(0)) - part * other.get(p, fmpq(0)) for p in (*bond, *other)}
            bond = {p: factor for p, factor in bond.items() if factor != 0}
            if among := [p for p in bond if p in light]:
                pivots.append((among[0], bond))
            bonds[number] = bond
        return bonds

    def _inverse(
        self,
        heavy: tuple[int, ...],
        light: tuple[int, ...],
        on: Mapping[int, Branch],
        bonds: Mapping[int, Mapping[int, fmpq]],
    ) -> list[list[arb]]:
        """Of what accelerations of masses, velocities of points without, and pulls of what is held obey."""
        key = (heavy, light, tuple((k, branch.held, branch.dashpot) for k, branch in on.items()))
        if key not in self._inverses:
            made, free = self._made, (*heavy, *light)
            held = [k for k, branch in on.items() if branch.held]
            size = len(free) + len(held)
            rows = [[fmpq(0)] * size for _ in range(size)]
            for i, p in enumerate(free):
                if p in heavy:
                    rows[i][i] = made.mass[p]
                for j, other in enumerate(free):
                    if other in light:
                        rows[i][j] += made.damping.get((p, other), fmpq(0))
                        for k, branch in on.items():
                            factors = made.corners[k].stretch
                            rows[i][j] += branch.dashpot * factors.get(p, fmpq(0)) * factors.get(other, fmpq(0))
            for j, number in enumerate(held, len(free)):
                bond = bonds[number]
                jumping = any(p in light for p in bond)
                for i, p in enumerate(free):
                    rows[i][j] = made.corners[number].stretch.get(p, fmpq(0))
                    if not (jumping and p in heavy):
                        rows[j][i] = bond.get(p, fmpq(0))
            solved = fmpq_mat(rows).inv().tolist() if size else []
            self._inverses[key] = [[arb(each) for each in row] for row in solved]
        return self._inverses[key]

    def _acting(self, point: int, now: fmpq) -> arb_poly:
        """The loads on a point, about an instant."""
        total = _NOTHING
        for time, where, power, size in self._loads:
            if where == point and time <= now + SAME:
                total += arb_poly([arb(now - time), 1]) ** power * arb(size)
        return total

    def _given(self, point: int, now: fmpq) -> arb_poly:
        """The velocity of a point that moves as it is told."""
        kind, told = self._made.motion[point], self._acting(point, now)
        if kind == "acceleration":
            return told.integral() + self._speed[point]
        return told + arb(self._made.velocity[point])

    def _rate(self) -> float:
        """How fast anything in the chain decays or swings, at most, roughly."""
        made = self._made

        def largest(matrix: Mapping[tuple[int, int], fmpq], p: int) -> float:
            return sum((abs(int(x.p) / int(x.q)) for (i, _), x in matrix.items() if i == p), 0.0)

        rates = [1.0]
        for p in range(len(made.mass)):
            c, k = largest(made.damping, p), largest(made.stiffness, p)
            for corner in made.corners:
                factor = corner.stretch.get(p, fmpq(0))
                share = abs(factor) * sum((abs(each) for each in corner.stretch.values()), fmpq(0))
                c += float(Fraction(str(share * corner.law.damping)))
                k += float(Fraction(str(share * corner.law.stiffness)))
            mass = int(made.mass[p].p) / int(made.mass[p].q)
            rates.append(max(c / mass, (k / mass) ** 0.5) if mass else (k / c if c else 0.0))
        return 2 * max(rates)

    def _joined(self) -> Iterator[_Joint]:
        made = self._made
        leader = list(range(len(made.mass)))

        def of(point: int) -> int:
            return point if leader[point] == point else of(leader[point])

        pairs = [pair for matrix in (made.damping, made.stiffness) for pair, x in matrix.items() if x]
        pairs += [(one, other) for corner in made.corners for one in corner.stretch for other in corner.stretch]
        for one, other in pairs:
            leader[of(one)] = of(other)
        self._rows = [
            [
                (
                    j,
                    arb(made.damping[p, j]) if made.damping.get((p, j)) else None,
                    arb(made.stiffness[p, j]) if made.stiffness.get((p, j)) else None,
                )
                for j in range(len(made.mass))
                if made.damping.get((p, j)) or made.stiffness.get((p, j))
            ]
            for p in range(len(made.mass))
        ]
        self._on = [next(iter(corner.law.branches(arb(0), None))) for corner in made.corners]
        for one in sorted({of(p) for p in range(len(made.mass))}):
            points = tuple(p for p in range(len(made.mass)) if of(p) == one)
            corners = tuple(k for k, corner in enumerate(made.corners) if set(corner.stretch) & set(points))
            springs = any(made.stiffness.get((p, j)) for p in points for j in points)
            springs = springs or any(made.corners[k].law.stiffness for k in corners)
            yield _Joint(points, corners, springs or any(made.mass[p] for p in points if p not in made.motion))


def at(series: list[arb], k: int) -> arb:
    """A coefficient."""
    return series[k] if k < len(series) else arb(0)

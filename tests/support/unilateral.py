"""Any chain with contacts, from the text of its scene alone: the truth that contacts are held against.

Nothing of the package is used. Time goes on in steps for all points at once, from one instant at which anything is not
smooth to the next; in a step all that moves is a power series, with some 50 digits:

    M q' + C q + K u = sum over rod ends of 2 n Z a + F + sum of B N,      u' = q,      sent into an end: n q - a,

with a multiplier N for every contact: B q = 0 while it is closed, N = 0 while it is open. After every step the state
of contacts without a gap is the first one, of all, with which forces push and gaps grow. Two instants, and any two
numbers, are the same where they differ by less than `SAME`: nothing here is proved.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from heapq import heappop, heappush
from itertools import product
from math import ceil
from typing import Any, NamedTuple

from flint import arb, arb_poly, ctx, fmpq, fmpq_mat

from tests.support.assembly import Assembly, Contact, exact, jumps

BITS = 400
SAME = fmpq(1, 10**40)

# where what crosses 0 is as flat as this, it may only touch it
_FLAT = arb(2) ** -50

_NOTHING = arb_poly([])
# the series converge as (rate * step)^k/k!
_REACH, _TERMS = 4, 72


class Event(NamedTuple):
    """A contact opens or closes; tau to some 50 digits."""

    place: str
    kind: str
    tau: fmpq


class Unclear(AssertionError):
    """A gap or a force touches 0 for an instant, or no state of contacts would do."""


class _Piece(NamedTuple):
    """A series from `start` on, for one step."""

    start: fmpq
    series: arb_poly

    def at(self, tau: fmpq) -> arb:
        return self.series(arb(tau - self.start))

    def moved(self, start: fmpq) -> arb_poly:
        """The series about a later instant."""
        return self.series if start == self.start else self.series(arb_poly([arb(start - self.start), 1]))


@dataclass
class _History:
    """A function of time, piece by piece; before tau = 0 it is constant."""

    before: fmpq
    pieces: list[_Piece] = field(default_factory=list)
    sums: list[arb] = field(default_factory=list)
    """The integral from 0 to the start of each piece."""

    def add(self, piece: _Piece) -> None:
        last = self.pieces[-1] if self.pieces else None
        gained = last.series.integral()(arb(piece.start - last.start)) if last else arb(0)
        self.sums.append(((self.sums[-1] if self.sums else arb(0)) + gained).mid())
        self.pieces.append(piece)

    def index(self, tau: fmpq) -> int:
        """The piece that begins last of those that begin by then; -1 before all."""
        low, high = 0, len(self.pieces)
        while low < high:
            middle = (low + high) // 2
            if self.pieces[middle].start <= tau + SAME:
                low = middle + 1
            else:
                high = middle
        return low - 1

    def about(self, tau: fmpq, step: fmpq) -> arb_poly:
        """The series from tau on, which holds for a step."""
        found = self.index(tau + step / 2)
        return arb_poly([arb(self.before)]) if found < 0 else self.pieces[found].moved(tau)

    def value(self, tau: fmpq) -> arb:
        found = self.index(tau)
        return arb(self.before) if found < 0 else self.pieces[found].at(tau)

    def integral(self, tau: fmpq) -> arb:
        """From 0 to tau, which may be negative."""
        found = self.index(tau)
        if found < 0:
            return arb(self.before * tau)
        piece = self.pieces[found]
        return self.sums[found] + piece.series.integral()(arb(tau - piece.start))


def _zero(number: arb, size: arb | int = 1) -> bool:
    return bool(abs(number.mid()) <= arb(SAME) * (1 + abs(size)))


def _middle(series: arb_poly) -> arb_poly:
    """Without its radii, which grow as no error does."""
    return arb_poly([coefficient.mid() for coefficient in series.coeffs()])


def _begins(series: arb_poly, step: fmpq) -> int:
    """The sign of a series just after its start: 0 if it stays 0."""
    scale = arb(1)
    for coefficient in series.coeffs():
        if not _zero(coefficient * scale):
            return 1 if coefficient > 0 else -1
        scale *= arb(step)
    return 0


def _falls(series: arb_poly, step: fmpq) -> fmpq | None:
    """When a series that begins positive, or is 0 for long, first becomes negative; None if not within the step."""
    coefficients = series.coeffs()
    scale = arb(1)
    while coefficients and _zero(coefficients[0] * scale):
        coefficients = coefficients[1:]
        scale *= arb(step)
    if not coefficients:
        return None
    rest = arb_poly(coefficients)
    slope = rest.derivative()
    waiting = [(fmpq(0), step)]
    while waiting:
        low, high = waiting.pop()
        middle = (low + high) / 2
        there = arb(middle, (high - low) / 2)
        bent = slope(there)
        value = rest(arb(middle)) + bent * arb(0, (high - low) / 2)
        if value > 0:
            continue
        if not bent.contains(0) or high - low < SAME:
            last = rest(arb(high))
            if high - low < SAME:
                if last < 0:
                    return high
                raise Unclear("touches 0")
            if last > 0 and not _zero(last):
                continue
            if bent > 0:
                raise Unclear("negative at first")
            found = _crossing(rest, low, high)
            if abs(slope(arb(found))) < _FLAT:
                raise Unclear("touches 0")
            return found
        waiting += [(middle, high), (low, middle)]
    return None


def _crossing(series: arb_poly, low: fmpq, high: fmpq) -> fmpq:
    """By bisection."""
    if _zero(series(arb(high))):
        return high
    while high - low > SAME / 2**40:
        middle = (low + high) / 2
        if series(arb(middle)) > 0:
            low = middle
        else:
            high = middle
    return high


@dataclass(frozen=True)
class _Joint:
    """Points that springs, dashpots and contacts join; and the numbers of the contacts."""

    points: tuple[int, ...]
    contacts: tuple[int, ...]
    lasting: bool
    """Whether it has a state: a mass or a spring."""


class Unilateral:
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
        self._q = [_History(fmpq(0)) for _ in made.mass]
        self._sent = {(k, s): _History(rod.begun[1 - s]) for k, rod in enumerate(made.rods) for s in (0, 1)}
        self.open = [contact.gap > 0 for contact in made.contacts]
        self._speed = [arb(v) for v in made.velocity]
        self._u = [arb(0)] * len(made.mass)

    # what it found

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
        while now <= self.until:
            met = set()
            while knots and knots[0][0] <= now + SAME:
                met.add(heappop(knots)[1])
            self._send_on(knots, now, met, delays)
            end = min(now + longest, knots[0][0]) if knots else now + longest
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
        """One step, or a part of it up to the first thing that happens at a contact: the joints, and when."""
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
            times = [time for series in watched if (time := _falls(series, step)) is not None]
            if times:
                first[number] = min(times)
        for found in solved:
            for point, series in found.items():
                self._q[point].add(_Piece(now, _middle(series)))
        for (k, side), wave in arriving.items():
            rod = made.rods[k]
            q = solved[self._joint_of[rod.ends[side]]][rod.ends[side]]
            self._sent[k, side].add(_Piece(now, _middle(q * arb(rod.ratios[side]) - wave)))
        last = min([step, *first.values()])
        for found in solved:
            for point, series in found.items():
                self._u[point] = (self._u[point] + series.integral()(arb(last))).mid()
                self._speed[point] = series(arb(last)).mid()
        return [(number, now + last) for number, time in first.items() if time <= last + SAME]

    # contacts

    def _settled(
        self, joint: _Joint, now: fmpq, step: fmpq, arriving: Mapping[tuple[int, int], arb_poly]
    ) -> tuple[dict[int, arb_poly], list[arb_poly]]:
        """How the points of a joint move, and what has to stay positive: forces and gaps."""
        made = self._made
        apart = [self._gap(made.contacts[k]) for k in joint.contacts]
        touching = [_zero(gap) for gap in apart]
        now_open = tuple(self.open[k] for k in joint.contacts)
        tried = [now_open] if all(t or o for t, o in zip(touching, now_open, strict=True)) else []
        others = product(*[(o, not o) if t else (True,) for t, o in zip(touching, now_open, strict=True)])
        for states in [*tried, *sorted(others, key=lambda s: sum(a != b for a, b in zip(s, now_open, strict=True)))]:
            found, forces = self._moved(joint, states, now, step, arriving)
            watched = []
            for k, state, gap in zip(joint.contacts, states, apart, strict=True):
                contact = made.contacts[k]
                parting = found[contact.right] - found[contact.left] * arb(contact.ratio)
                watched.append((parting.integral() + (0 if _zero(gap) else gap)) if state else forces[k])
            if all(_begins(series, step) >= 0 for series in watched):
                for k, state in zip(joint.contacts, states, strict=True):
                    if state != self.open[k]:
                        self.open[k] = state
                        self.events.append(Event(made.contacts[k].place, "opens" if state else "closes", now))
                assert len(self.events) <= self._most, "too many events"
                return found, watched
        raise Unclear(f"no state of contacts at {float(now.p) / float(now.q)}")

    def _gap(self, contact: Contact) -> arb:
        return arb(contact.gap) + self._u[contact.right] - self._u[contact.left] * arb(contact.ratio)

    # motion

    def _moved(
        self,
        joint: _Joint,
        states: tuple[bool, ...],
        now: fmpq,
        step: fmpq,
        arriving: Mapping[tuple[int, int], arb_poly],
    ) -> tuple[dict[int, arb_poly], dict[int, arb_poly]]:
        """The velocities of the points of a joint, and the forces of its closed contacts, order by order."""
        made = self._made
        closed = [k for k, state in zip(joint.contacts, states, strict=True) if not state]
        given = {p: self._given(p, now) for p in joint.points if p in made.motion}
        light = [p for p in joint.points if made.mass[p] == 0 and p not in given]
        inverse = self._inverse(tuple(light), tuple(closed))
        acting = {p: self._acting(p, now) for p in joint.points if p not in given}
        for (k, side), wave in arriving.items():
            rod = made.rods[k]
            if rod.ends[side] in acting:
                acting[rod.ends[side]] += wave * arb(2 * rod.ratios[side] * rod.impedance)
        terms = _TERMS
        if not joint.lasting:
            terms = max([1, *(len(series.coeffs()) for series in (*acting.values(), *given.values()))])
        q = {p: [self._speed[p]] if p not in given else given[p].coeffs() for p in joint.points if p not in light}
        q |= {p: [] for p in light}
        u = {p: [self._u[p]] for p in joint.points}
        force: dict[int, list[arb]] = {k: [] for k in closed}

        def at(series: list[arb], k: int) -> arb:
            return series[k] if k < len(series) else arb(0)

        f = {p: series.coeffs() for p, series in acting.items()}
        for k in range(terms):
            rows = [at(f[p], k) - self._held(p, q, u, k, light) for p in light]
            for number in closed:
                c = made.contacts[number]
                pairs = [(c.right, arb(1)), (c.left, arb(-c.ratio))]
                rows.append(-sum((at(q[p], k) * b for p, b in pairs if p not in light), arb(0)))
            answer = [sum((w * r for w, r in zip(line, rows, strict=True)), arb(0)) for line in inverse]
            for p, each in zip(light, answer[: len(light)], strict=True):
                q[p].append(each)
            for number, each in zip(closed, answer[len(light) :], strict=True):
                force[number].append(each)
            for p in joint.points:
                if p not in light and p not in given:
                    total = at(f[p], k) - self._held(p, q, u, k, ())
                    for number in closed:
                        c = made.contacts[number]
                        total += force[number][k] * arb((c.right == p) - (c.left == p) * c.ratio)
                    q[p].append(total / (arb(made.mass[p]) * (k + 1)))
                u[p].append(at(q[p], k) / (k + 1))
        return {p: arb_poly(q[p]) for p in joint.points}, {k: arb_poly(force[k]) for k in closed}

    def _held(self, p: int, q: Mapping[int, list[arb]], u: Mapping[int, list[arb]], k: int, but: Any) -> arb:
        """C q + K u of a point, order k, without the dashpots at some points."""
        total = arb(0)
        for other, c, stiff in self._rows[p]:
            if c and other not in but and k < len(q[other]):
                total += q[other][k] * c
            if stiff:
                total += u[other][k] * stiff
        return total

    def _inverse(self, light: tuple[int, ...], closed: tuple[int, ...]) -> list[list[arb]]:
        """Of [C, -B^T; B, 0] for points without mass."""
        if (light, closed) not in self._inverses:
            made, n, size = self._made, len(light), len(light) + len(closed)
            rows = [[fmpq(0)] * size for _ in range(size)]
            for i, p in enumerate(light):
                for j, other in enumerate(light):
                    rows[i][j] = made.damping.get((p, other), fmpq(0))
                for j, number in enumerate(closed):
                    c = made.contacts[number]
                    push = fmpq(int(c.right == p)) - (c.ratio if c.left == p else 0)
                    rows[i][n + j], rows[n + j][i] = -push, push
            solved = fmpq_mat(rows).inv().tolist() if size else []
            self._inverses[light, closed] = [[arb(each) for each in row] for row in solved]
        return self._inverses[light, closed]

    def _acting(self, point: int, now: fmpq) -> arb_poly:
        """The loads on a point, about an instant."""
        total = _NOTHING
        for time, at, power, size in self._loads:
            if at == point and time <= now + SAME:
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
        heavy = [p for p in range(len(made.mass)) if made.mass[p]]

        def largest(matrix: Mapping[tuple[int, int], fmpq], p: int) -> float:
            return sum((abs(int(x.p) / int(x.q)) for (i, _), x in matrix.items() if i == p), 0.0)

        rates = [1.0]
        for p in range(len(made.mass)):
            c, k = largest(made.damping, p), largest(made.stiffness, p)
            mass = int(made.mass[p].p) / int(made.mass[p].q)
            rates.append(max(c / mass, (k / mass) ** 0.5) if p in heavy else (k / c if c else 0.0))
        return 2 * max(rates)

    def _joined(self) -> Iterator[_Joint]:
        made = self._made
        leader = list(range(len(made.mass)))

        def of(point: int) -> int:
            return point if leader[point] == point else of(leader[point])

        pairs = [pair for matrix in (made.damping, made.stiffness) for pair, x in matrix.items() if x]
        for one, other in [*pairs, *((c.left, c.right) for c in made.contacts)]:
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
        self._inverses: dict[tuple[tuple[int, ...], tuple[int, ...]], list[list[arb]]] = {}
        for one in sorted({of(p) for p in range(len(made.mass))}):
            points = tuple(p for p in range(len(made.mass)) if of(p) == one)
            contacts = tuple(k for k, c in enumerate(made.contacts) if c.left in points)
            springs = any(made.stiffness.get((p, j)) for p in points for j in points)
            yield _Joint(points, contacts, springs or any(made.mass[p] for p in points if p not in made.motion))

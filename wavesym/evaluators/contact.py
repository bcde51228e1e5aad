"""When the contacts of a collision end: the first return of a contact's strain to zero, from its exact form."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, fmpq

from wavesym.evaluators.ball import Segment, precise, segments
from wavesym.evaluators.doubles import midpoint, rational
from wavesym.evaluators.signal import Modelled, Signal, horizon, observed
from wavesym.mechanics.chain import chain
from wavesym.scene import Collision, Observable, Scene

# a zero is known to this width, and a strain that only touches zero counts from there
_WIDTH = fmpq(1, 2**80)


@dataclass(frozen=True)
class ContactEnd:
    """The contact at `x` opens at `tau`, a ball; what is computed at its neighbours later than that is formal."""

    x: int
    tau: arb

    @property
    def double(self) -> float:
        """tau rounded to double."""
        return midpoint(self.tau)

    @property
    def digits(self) -> str:
        """tau with 20 significant digits."""
        return str(self.tau.str(20, radius=False))


def contact_ends(scene: Scene) -> tuple[ContactEnd, ...]:
    """The contacts whose opening can reach an output of the scene within its horizon, from left to right."""
    if not isinstance(scene.system, Collision):
        return ()
    model = Modelled(chain(scene))
    until = rational(horizon(scene))
    ends = []
    for x in _contacts(scene, until):
        # to matter, the opening must have the time to reach the nearest output
        latest = until - min(abs(rational(output.x) - x) for output in scene.outputs)
        place = Observable("strain", Fraction(x), 0, f"strain@{x}")
        (strain,) = observed(model, (place,), scene.pieces, latest)
        tau = precise(lambda: _first_return(strain, latest))  # noqa: B023  (called at once)
        if tau.is_finite():
            ends.append(ContactEnd(x, tau))
    return tuple(ends)


def _contacts(scene: Scene, until: fmpq) -> list[int]:
    """The contacts, at even x, near enough to an output."""
    near: set[int] = set()
    for output in scene.outputs:
        x = rational(output.x)
        first, last = int((x - until).ceil()), int((x + until).floor())
        near.update(range(max(2, first + first % 2), min(scene.system.m - 2, last) + 1, 2))
    return sorted(near)


def _first_return(strain: Signal, until: fmpq) -> arb | None:
    """The first tau at which a compressed contact is compressed no more; infinite where it stays closed.

    None where the working precision does not tell.
    """
    pieces = list(segments(strain))
    ends = [piece.start for piece in pieces[1:]] + [until]
    for piece, end in zip(pieces, ends, strict=True):
        if all(polynomial.degree() < 0 for polynomial in piece.families.values()):
            continue
        start = piece.at(fmpq(0))
        if start.contains(0) and not start.is_zero():
            return None
        if start > 0:
            return arb(piece.start)
        for low, high in _not_compressed(piece, fmpq(0), end - piece.start):
            if low > 0 or start < 0:
                return arb(piece.start) + arb(low).union(arb(high))
    return arb.pos_inf()


def _not_compressed(piece: Segment, low: fmpq, high: fmpq) -> Iterator[tuple[fmpq, fmpq]]:
    """The first interval of width `_WIDTH` in which the strain is not certainly negative."""
    stack = [(low, high)]
    while stack:
        low, high = stack.pop()
        middle = (low + high) / 2
        if piece.at(arb(low).union(arb(high))) < 0:
            continue
        if high - low < _WIDTH:
            yield low, high
            return
        stack += [(middle, high), (low, middle)]

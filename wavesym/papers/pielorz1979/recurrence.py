"""The language of III.1 ... III.22: a line is a sum of terms, factor * H(...) * coefficient, for a range of indices.

Superscript k (the piece of the load) is left out; n+1 is the interval of the coefficient on the left, and a term is
`back` = 0 or 1 intervals earlier.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from flint import fmpq

from wavesym.papers.record import Slipped

Family = str
"""`c` constant, `0` linear (rate 0); `1` rate 2 kappa_1; `m` rate kappa_m."""


@dataclass(frozen=True)
class At:
    """Where a line is evaluated: the building and the indices."""

    m: int
    n: int
    j: int
    i: int
    kappa: Mapping[int, fmpq]

    @property
    def gap(self) -> fmpq:
        """2 kappa_1 - kappa_m."""
        return 2 * self.kappa[1] - self.kappa[self.m]


Count = Callable[[At], int]
Factor = Callable[[At], fmpq | int]


@dataclass(frozen=True)
class PrintedTerm:
    """factor * product of H(guard) * coefficient, e.g. -H(n-2-i) f_(m,i)^(m,n)."""

    text: str
    factor: Factor
    letter: str
    family: Family
    rod: Count
    back: int
    power: Count = lambda at: at.i
    guards: tuple[Count, ...] = ()

    def on(self, at: At) -> bool:
        """The product of the H, with H(0) = 1."""
        return all(guard(at) >= 0 for guard in self.guards)


@dataclass(frozen=True)
class PrintedTarget:
    """A coefficient on the left: for rods first(m) ... last(m), n >= start, powers top ... bottom.

    Without `top` it is a single coefficient (power 0), and no range is claimed.
    """

    letter: str
    family: Family
    first: Callable[[int], int]
    last: Callable[[int], int]
    start: int = 0
    top: Count | None = None
    bottom: int = 0

    def powers(self, at: At) -> range:
        """The powers of the line, downwards."""
        return range(self.top(at) if self.top else 0, self.bottom - 1, -1)


@dataclass(frozen=True)
class PrintedLine:
    """A printed line.

    `loads` is the constant part of III.1, by source. `strict` is the first n of the range's test. `scan`: see `Claim`.
    """

    number: int
    printed: str
    ranges: str
    targets: tuple[PrintedTarget, ...]
    terms: tuple[PrintedTerm, ...]
    loads: Mapping[tuple[str, Family], Factor] | None = None
    strict: int = 0
    scan: str | None = None


@dataclass(frozen=True)
class Correction:
    """The terms and the text of a line as it should be; `kind` and how sure."""

    kind: Slipped
    corrected: str
    line: PrintedLine
    note: str


def this_rod(shift: int = 0) -> Count:
    """Rod j, or one `shift` away."""
    return lambda at: at.j + shift


def rod(number: int) -> Count:
    """A rod with a number of its own."""
    return lambda at: number


def top_rod(shift: int = 0) -> Count:
    """Rod m, or one `shift` away."""
    return lambda at: at.m + shift


def up(at: At) -> int:
    """Power i+1."""
    return at.i + 1


def down(at: At) -> int:
    """Power i-1."""
    return at.i - 1


def zero(at: At) -> int:
    """Power 0, where a coefficient has no i."""
    return 0


def first(m: int) -> int:
    """Rods from or up to 1."""
    return 1


def second(m: int) -> int:
    """Rods from or up to 2."""
    return 2


def roof(m: int) -> int:
    """Rods from or up to m."""
    return m


def under_roof(m: int) -> int:
    """Rods up to m-1."""
    return m - 1


def plus(at: At) -> int:
    """Factor 1."""
    return 1


def minus(at: At) -> int:
    """Factor -1."""
    return -1


def n_1(at: At) -> int:
    """The argument n - 1 of H."""
    return at.n - 1


def n_2(at: At) -> int:
    """The argument n - 2 of H."""
    return at.n - 2


def visits(at: At) -> fmpq:
    """2 kappa_1 / i."""
    return 2 * at.kappa[1] / at.i


def with_terms(line: PrintedLine, place: int, term: PrintedTerm) -> PrintedLine:
    """The line with another term at `place`."""
    return replace(line, terms=(*line.terms[:place], term, *line.terms[place + 1 :]))

"""The highest powers, the paper's Tables 2, 3 and 4, as formulas in interval, rod, body and source; stated as data.

A wave that leaves node y at tau = t came from its source at node s in t steps from node to node. Every visit to the
body at node l is a factor T (`derivation.walks`), after the first one visit costs a way to a neighbour and back; so
there are at most 1 + (t - |s - l| - |l - y|)/2, and the highest power of w beside exp(-gamma_l w) is one less. What is
stated here is proved as an upper bound in `verification.powers`, by induction over the derived laws.
"""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Abs, Expr, IndexedBase, Integer, Rational, Symbol, binomial

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS
from wavesym.derivation.delay_terms import exact

INTERVAL = Symbol("n", integer=True, positive=True)
BODY = Symbol("l", integer=True, positive=True)
SOURCE = Symbol("s", integer=True, positive=True)
HIGHEST = Symbol("K", integer=True, nonnegative=True)
NODE = Symbol("y", integer=True)
IMAGE = Symbol("j", integer=True)

_m, _i, _n, _l, _s, _K, _y, _j = COUNT, INDEX, INTERVAL, BODY, SOURCE, HIGHEST, NODE, IMAGE
_HALF = Rational(1, 2)
_GAMMA, _KAPPA = IndexedBase("gamma")[BODY], SYMBOLS.kappa


@dataclass(frozen=True)
class PowerRow:
    """One kind of function, i = first, first + step, ... last, last sent by the body (or the base) `node`.

    Where it is not 0, `start` >= 0. Its increment of interval n has the family's rate up to power
    floor(`budget`/`period`), and not at all where that is below 0.
    """

    function: str
    rod: Expr
    node: Expr
    budget: Expr
    start: Expr
    first: Expr
    last: Expr
    step: int


@dataclass(frozen=True)
class PowerFamily:
    """The powers beside the `rate` of body l = first, first + step, ... last; or of all of these, where they are one.

    `subject` says it in words. `period` is what a further visit takes from the budget; `offset` the number of the body
    at x = 0. `is_merged`: whether it is of equal bodies. `smallest` is the least m that it is about. Where every step
    is a visit, T**(K + 1), K the highest power, has with 1 for other letters the number of `walks` of K steps to y
    (by reflection, a sum over images): the sum of `leading` over all whole j; a binomial with a half in it is 0.
    Where sources are numbered, `sources` are the first and the last one that the family is about.
    """

    subject: str
    rate: Expr
    first: Expr
    last: Expr
    step: int
    is_merged: bool
    period: int
    offset: int
    smallest: int
    rows: tuple[PowerRow, ...]
    walks: str = ""
    leading: Expr | None = None
    sources: tuple[Expr, Expr] = (Integer(1), COUNT + 1)


def plain(family: PowerFamily, row: PowerRow) -> Expr:
    """The budget without absolute values that the places of i and l decide."""
    budget = row.budget.subs(BODY, family.first) if family.first == family.last else row.budget
    before, after = (Symbol(name, integer=True, nonnegative=True) for name in "ab")
    known: list[dict[Symbol, Expr]] = [{COUNT: family.smallest + before}]
    for symbol, place in ((INDEX, row), (BODY, family)):
        at = place.first + place.step * before
        known.append({symbol: at, COUNT: exact(at + place.step * after - place.last + COUNT)})

    def decide(inside: Expr) -> Expr:
        for places in known:
            sign = exact(inside.xreplace(places))
            if not sign.free_symbols - {before, after} and (sign.is_nonnegative or sign.is_nonpositive):
                return inside if sign.is_nonnegative else -inside
        return Abs(inside)

    return exact(budget.replace(Abs, decide))


def _row(function: str, rod: Expr | int, node: Expr | int, budget: Expr, since: Expr, *places: Expr | int) -> PowerRow:
    first, last, step = places or (rod, rod, 1)
    return PowerRow(function, exact(rod), exact(node), budget, since, exact(first), exact(last), int(step))


def _ways(*rows: tuple[str, Expr | int, Expr, Expr, tuple[Expr | int, ...]], source: Expr) -> tuple[PowerRow, ...]:
    """Rows from the time t at which a function leaves node y, both in the numbering of bodies."""
    return tuple(
        _row(function, rod, y, t - Abs(source - _l) - Abs(_l - y), t - (Abs(source - y) if source else y), *places)
        for function, rod, t, y, places in rows
    )


# moment M_s and body l in the paper's numbers, 1 ... m + 1: f_i leaves disc i at tau = z, g_i disc i + 1 at z - 1
_DRIVE = PowerFamily(
    "disc $l$, for the moment on disc $s$",
    _GAMMA,
    Integer(1),
    exact(_m + 1),
    1,
    False,
    2,
    1,
    1,
    _ways(
        ("f", _i, _n - 1, _i, (1, _m, 1)),
        ("g", _i, _n - 2, _i + 1, (1, _m, 1)),
        source=_s,
    ),
)


def _equal_discs(moment: str, first: Expr, last: Expr, start: Expr) -> PowerFamily:
    """The inner discs of a drive of equal shafts and discs: every step is a visit but those to and from its ends."""
    early = Integer(first == last)  # the first step, from an end
    rows = (
        ("f", 1, _n - 2, Integer(1), ()),
        ("f", _i, _n - 1, _i, (2, _m, 1)),
        ("g", _i, _n - 2, _i + 1, (1, _m - 1, 1)),
        ("g", _m, _n - 3, _m + 1, ()),
    )
    apart = {Integer(1): lambda y: y - 1, exact(_m + 1): lambda y: _m + 1 - y}
    return PowerFamily(
        f"inner discs of equal shafts and discs, for the moment {moment}",
        2 * _KAPPA[1],
        Integer(2),
        _m,
        1,
        True,
        1,
        1,
        3,
        tuple(
            _row(
                function,
                rod,
                y,
                budget - early,
                budget + (0 if places else 1) - (apart[first](y) if first == last else Abs(_s - y)),
                *places,
            )
            for function, rod, budget, y, places in rows
        ),
        f"walks of $K$ steps from disc ${start}$ to disc $y$ within $2, ..., m$; $y$ is $i$ for $f_i$, $i+1$ for "
        "$g_i$, but 2 for $f_1$ and $m$ for $g_m$",
        binomial(_K, (_K + _y - start) * _HALF + _j * _m) - binomial(_K, (_K + _y + start - 2) * _HALF + _j * _m),
        (first, last),
    )


# the source is the base; floors in the paper's numbers 1 ... m
_BUILDING = PowerFamily(
    "floor $l$, or the roof $l = m$",
    _GAMMA,
    Integer(1),
    _m,
    1,
    False,
    2,
    0,
    2,
    _ways(
        ("f", _i, 2 * _n + _i - 3, _i - 1, (1, _m, 1)),
        ("g", _i, 2 * _n + _i - 4, _i, (1, _m, 1)),
        source=Integer(0),
    ),
)

# every step of a wave between equal floors is a visit
_EQUAL_FLOORS = PowerFamily(
    "equal floors, all but the roof",
    2 * _KAPPA[1],
    Integer(1),
    exact(_m - 1),
    1,
    True,
    1,
    0,
    3,
    (
        _row("f", 1, 0, 2 * _n - 4, 2 * _n - 2),
        _row("f", _i, _i - 1, 2 * _n + _i - 4, 2 * _n - 2, 2, _m, 1),
        _row("g", _i, _i, 2 * _n + _i - 5, 2 * _n - 4, 1, _m - 1, 1),
        _row("g", _m, _m, 2 * _n + _m - 6, 2 * _n - 4),
    ),
    "walks of $K$ steps from floor 1 to floor $y$ within $1, ..., m-1$; $y$ is $i-1$ for $f_i$, $i$ for $g_i$, but "
    "1 for $f_1$ and $m-1$ for $g_m$",
    binomial(_K, (_K + _y - 1) * _HALF + _j * _m) - binomial(_K, (_K + _y + 1) * _HALF + _j * _m),
)

# body l is at odd x = l. All contacts send at tau = 0, so that any body may be the first one met, at tau = 1. Each line
# has the time and the body at which a function was last sent by a body, since contacts pass waves on and free ends send
# them back; and whether it may come straight from its contact, up to two units of that time earlier.
_LAST_SENT: tuple[tuple[str, Expr | int, Expr, Expr, bool, tuple[Expr | int, ...]], ...] = (
    ("g", 1, 2 * _n - 1, Integer(1), False, ()),
    ("f", 1, 2 * _n - 3, Integer(1), False, ()),
    ("f", _i, 2 * _n - 3, _i - 1, False, (2, _m - 2, 2)),
    ("g", _i, 2 * _n - 3, _i + 1, True, (2, _m - 2, 2)),
    ("f", _i, 2 * _n - 3, _i - 2, True, (3, _m - 1, 2)),
    ("g", _i, 2 * _n - 3, _i, False, (3, _m - 1, 2)),
    ("f", _m, 2 * _n - 1, _m - 1, False, ()),
    ("g", _m, 2 * _n - 3, _m - 1, False, ()),
)


def _collision(subject: str, first: Expr | int, last: Expr, period: int, smallest: int) -> PowerFamily:
    rows = tuple(
        _row(function, rod, y, t - 1 - Abs(_l - y), t - 1 + 2 * contact, *places)
        for function, rod, t, y, contact, places in _LAST_SENT
    )
    return PowerFamily(subject, _GAMMA, exact(first), exact(last), 2, False, period, 0, smallest, rows)


_EQUAL_BODIES = PowerFamily(
    "equal bodies",
    2 * _KAPPA[1],
    Integer(1),
    exact(_m - 1),
    2,
    True,
    2,
    0,
    6,
    tuple(
        _row(function, rod, y, t - 1, t - 1 + 2 * contact, *places)
        for function, rod, t, y, contact, places in _LAST_SENT
    ),
    "walks of $K$ steps from body to body that end at the body $x = y$ that last sent the wave, for the contact at "
    "$x = s$ those from $s+1$ less those from $s-1$; at a free end the next body is the same again",
    sum(
        sign * binomial(_K, (_K + (_y + shift) * _HALF) * _HALF + _j * _m * _HALF)
        for sign, shift in ((1, -_s - 1), (1, _s + 1), (-1, 1 - _s), (-1, _s - 1))
    ),
)

_DRIVES = (
    _DRIVE,
    _equal_discs("on inner disc $s$", Integer(2), _m, _s),
    _equal_discs("on the first disc", Integer(1), Integer(1), Integer(2)),
    _equal_discs("on the last disc", exact(_m + 1), exact(_m + 1), _m),
)

POWERS: dict[str, tuple[PowerFamily, ...]] = {
    "collision": (
        _collision("the first body, $l = 1$", 1, Integer(1), 2, 4),
        _collision("the last body, $l = m - 1$", _m - 1, _m - 1, 2, 4),
        _collision("an inner body $l$", 3, exact(_m - 3), 4, 6),
        _EQUAL_BODIES,
    ),
    "drive": _DRIVES,
    "drive-ramps": _DRIVES,
    "building-force": (_BUILDING, _EQUAL_FLOORS),
    "building-ground": (_BUILDING, _EQUAL_FLOORS),
}

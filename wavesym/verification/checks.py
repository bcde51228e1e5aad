"""The checks of `verify`: the reference, and programs, against what is not derived at all.

A new one is one more `Check` in `CHECKS`.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, nextafter

import numpy as np

from wavesym.errors import CostError, ToleranceError, WavesymError
from wavesym.exact.extremes import extremes
from wavesym.exact.reference import Reference
from wavesym.numbers.doubles import rational
from wavesym.programs.making import make
from wavesym.verification.integrations import (
    collocation,
    collocation_beyond,
    corner_changes,
    differences,
    elements,
    midpoints,
)
from wavesym.verification.invariants import Balance, Balancing
from wavesym.verification.outcome import FINE, REFUSED, Check, Outcome, format_error, refused_outcomes, too_coarse
from wavesym.verification.reference import ReferenceOutputs

# balances are struck as long as that takes no more values
_MOST_VALUES = 30_000

# extremes are right to 2^-52; values are rounded once, and so is each difference
_ROUNDED = 2.0**-51


def invariants(known: ReferenceOutputs) -> list[Outcome]:
    """The balances of momentum and energy, in the reference itself and in the program, which generated NumPy is."""
    name = known.model.name

    def no_balances(reason: object) -> list[Outcome]:
        return [Outcome("momentum, energy", {"to": REFUSED}, True, f"{name}: no balances, as {reason}")]

    try:
        books = Balancing(known.model, _MOST_VALUES)
        if not books.balance_times:
            return no_balances("fronts come too often")
        exact = Reference(books.model)
        right = books.balances(lambda taus: np.array(exact.values(taus.tolist())), None)
    except CostError as error:  # all ends are watched, and not only outputs
        return no_balances(error)
    note = ""
    ours: Sequence[Balance | None] = [None] * len(right)
    try:
        program = make(books.model)
        ours = books.balances(program.evaluate, [output.bound * output.largest for output in program.outputs])
    except ToleranceError as error:
        note = str(error)
    outcomes = []
    for exactly, found in zip(right, ours, strict=True):
        cells = {"to": f"{float(books.balance_times[-1]):.4g}", "reference": format_error(exactly.error)}
        cells |= {
            "allowed": format_error(exactly.error_bound),
            "NumPy": format_error(found.error) if found else REFUSED,
        }
        cells |= {"its bound": format_error(found.error_bound)} if found else {}
        passed = all(each.error <= each.error_bound for each in (exactly, found) if each)
        coarse = "" if exactly.error_bound <= FINE else too_coarse(name, "quadrature of the balances")
        outcomes.append(Outcome(exactly.name, cells, passed, note or coarse))
    return outcomes


def peaks(known: ReferenceOutputs) -> list[Outcome]:
    """How far values lie beyond proved extremes, and how far each extreme is from the value at its instant.

    The instant is given as a double, which lies beside it: the change of values between two doubles is allowed.
    """
    try:
        found = extremes(known.model)
        near = {each.tau: _doubles(each.tau) for pair in found for each in pair}
        taus = sorted({tau for some in near.values() for tau in some})
        further = known.model.shorten(rational(max(known.until, taus[-1])))  # and just behind the horizon
        rows = Reference(further).values(taus)
    except WavesymError as refusal:
        return refused_outcomes(known, "beyond", f"no proved extremes to compare ({refusal})")
    outcomes = []
    for output, pair, row in zip(known.outputs, found, rows, strict=True):
        at = dict(zip(taus, row, strict=True))
        least, greatest = (each.value for each in pair)
        scale = max(abs(least), abs(greatest)) or output.scale
        beyond = max(0.0, least - output.values.min(), output.values.max() - greatest) / scale
        off = change = 0.0
        for each in pair:
            if each.reached:  # there may be a jump: values change between two doubles on either side of it
                earlier, before, here, after = (at[tau] for tau in near[each.tau])
                off = max(off, abs(each.value - here) / scale)
                change = max(change, (abs(before - earlier) + abs(after - here)) / scale)
        cells = {"beyond": format_error(beyond), "at": format_error(off), "allowed": format_error(_ROUNDED + change)}
        outcomes.append(Outcome(output.probe.name, cells, beyond <= _ROUNDED and off <= _ROUNDED + change))
    return outcomes


def _doubles(tau: float) -> tuple[float, float, float, float]:
    """Two before an instant of the horizon, it, and the one after it."""
    before = nextafter(tau, 0.0)
    return nextafter(before, 0.0), before, tau, nextafter(tau, inf)


CHECKS = (
    Check(
        "Damped modes: finite elements, N, 2N and 4N in the shortest rod, extrapolated. Allowed: twice the difference\n"
        "from what N and 2N extrapolate to. Differences are from the last:",
        elements,
    ),
    Check(
        "Collocation between fronts beyond what is known exactly, with N, 2N and 4N points a panel. Allowed: the\n"
        "difference from 2N, and rounding. Differences are from 4N:",
        collocation_beyond,
    ),
    Check(
        "Collocation between fronts, followed one by one, with N, 2N and 4N points a panel. Allowed at\n"
        "4N: the difference from 2N, and rounding:",
        collocation,
    ),
    Check(
        "Characteristics and the midpoint rule, links with corners a complementarity problem in each step, with N, 2N\n"
        "and 4N steps a rod, where no front is within one. Allowed: the difference from what N and 2N extrapolate to\n"
        "(fronts or outputs off the grid, or contacts: from N and 2N; laws with corners: twice that), and rounding:",
        midpoints,
    ),
    Check(
        "Central differences that pull back what went too far, where links have a law, with N, 2N and 4N cells a rod,\n"
        "where no front is within four. Allowed: twice the differences of N, 2N and 4N, and rounding:",
        differences,
    ),
    Check(
        "When laws change at corners: how far integrations are from it, and what is allowed (between fronts: the\n"
        "difference of N and 2N points; steps: those of N, 2N and 4N a rod, and four steps):",
        corner_changes,
    ),
    Check(
        "Momentum less impulse and energy less work of the whole chain at parts of the horizon: in the reference, and\n"
        "in generated NumPy. Allowed is what the errors of values come to:",
        invariants,
    ),
    Check(
        "Proved extremes: how far values at fronts, beside them and between lie beyond, and how far extremes are from\n"
        "the values at their instants. Allowed: rounding, and what values change by from one double to the next:",
        peaks,
    ),
)

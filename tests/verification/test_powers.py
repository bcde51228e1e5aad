"""The highest powers: proved as upper bounds by induction, met by the exact degrees, leading coefficients counted."""

from collections.abc import Iterator
from dataclasses import replace
from math import comb

import pytest
from flint import fmpq, fmpz_poly, nmod_poly
from sympy import Add, Rational, binomial

from wavesym.derivation.delay import COUNT, INDEX
from wavesym.derivation.symbolic import generic
from wavesym.derivation.table import Function, Rules
from wavesym.derivation.walks import Unit, departures, function_walks, letters, units, walks_until
from wavesym.documents.derivation.highest_powers import (
    BODY,
    HIGHEST,
    IMAGE,
    INTERVAL,
    NODE,
    POWERS,
    SOURCE,
    PowerFamily,
    PowerRow,
)
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Parameters
from wavesym.systems import presets
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE
from wavesym.verification.powers import steps

BY_NAME = {system.name: system for preset in presets().values() for system in (*preset.variants, *preset.companions)}
FAMILIES = [
    pytest.param(BY_NAME[name], family, id=f"{name}-{family.rate}")
    for name, families in POWERS.items()
    for family in families
]
GENERIC = [family for family in FAMILIES if not family.values[1].is_merged]

PRIME = 2**61 - 1
INTERVALS = 10


SOON = [
    family if "collision-gamma" not in family.id else pytest.param(*family.values, id=family.id, marks=pytest.mark.slow)
    for family in FAMILIES
]


@pytest.mark.quick(1)
@pytest.mark.parametrize(("system", "family"), SOON)
def test_upper_bounds_by_induction(system, family):
    proof = list(steps(system, family))
    assert proof
    assert all(step.holds for step in proof), [step for step in proof if not step.holds]
    # as low as they can be: one less anywhere, and a step that holds with nothing to spare fails
    for k, row in enumerate(family.rows):
        lower = replace(row, budget=row.budget - 1)
        wrong = replace(family, rows=(*family.rows[:k], lower, *family.rows[k + 1 :]))
        assert not all(step.holds for step in steps(system, wrong)), row


@pytest.mark.parametrize(("system", "family"), FAMILIES)
def test_the_proof_needs_every_function(system, family):
    with pytest.raises(LookupError):
        list(steps(system, replace(family, rows=family.rows[1:])))


def places(family: PowerFamily, m: int) -> Iterator[tuple[PowerRow, Function]]:
    for row in family.rows:
        first, last = (int(value.subs(COUNT, m)) for value in (row.first, row.last))
        for rod in range(first, last + 1, row.step):
            yield row, Function(row.function, rod)


def stated(family: PowerFamily, row: PowerRow, m: int, rod: int, n: int, body: int, source: int) -> int:
    """The formula's highest power, -1 for none; where an odd time is left for ways there and back, nothing arrives."""
    at = {COUNT: m, INDEX: rod, INTERVAL: n, BODY: body, SOURCE: source}
    budget, since = (int(value.xreplace(at)) for value in (row.budget, row.start))
    arrives = since >= 0 and since % 2 == 0
    return max(-1, budget // family.period) if arrives else -1


@pytest.mark.quick(1)
@pytest.mark.parametrize(("system", "family"), GENERIC)
def test_degrees_of_walk_polynomials_are_the_formulas(system, family):
    """A degree with numbers modulo a prime for the other letters is at most the true one, which the proof bounds."""
    told = 0
    for m in range(family.smallest, family.smallest + 6 * system.step, system.step):
        chain = generic(system, m).chain
        names, step = letters(chain), Rules(chain).interval
        times = departures(chain, step, INTERVALS)
        first, last = (int(value.subs(COUNT, m)) for value in (family.first, family.last))
        for body in range(first, last + 1, family.step):
            values = {name: nmod_poly([3**k + 2], PRIME) for k, name in enumerate(names.names, 1)}
            values[names.visit[body - family.offset]] = nmod_poly([0, 1], PRIME)
            degrees: dict[tuple[Function, int, int], int] = {}
            for unit in units(chain):
                sent = walks_until(chain, unit, times, names, values)
                # all contacts of an impact act together
                source = 0 if unit.name.startswith("impact") else unit.x + family.offset
                for _, function in places(family, m):
                    for n in range(1, INTERVALS + 1):
                        degree = function_walks(chain, sent, function, n, step).degree()
                        key = (function, n, source)
                        degrees[key] = max(degrees.get(key, -1), degree - 1)
            for row, function in places(family, m):
                for n, source in {(n, s) for f, n, s in degrees if f == function}:
                    power = stated(family, row, m, function.rod, n, body, source)
                    assert degrees[function, n, source] == power, (m, function, n, body, source)
                    told += power >= 0
    assert told > 500  # cases with a power to be right about


def count(family: PowerFamily, m: int, highest: int, node: int, source: int) -> int:
    """`leading` with numbers, summed over its images."""
    total = 0
    for image in range(-highest - 1, highest + 2):
        at = {COUNT: m, HIGHEST: highest, NODE: node, SOURCE: source, IMAGE: image}
        for term in Add.make_args(family.leading):
            sign, chosen = term.as_coeff_Mul()
            assert isinstance(chosen, binomial)
            below = chosen.args[1].xreplace(at)
            total += int(sign) * (comb(highest, int(below)) if below.is_integer and below >= 0 else 0)
    return total


def leading(
    chain: Chain, unit: Unit, family: PowerFamily, letter: str = "T_1"
) -> Iterator[tuple[PowerRow, Function, int, int, int]]:
    """Row, function, interval, and for one letter alone (1 for others) the highest power and its coefficient."""
    names, step = letters(chain), Rules(chain).interval
    values = {name: fmpz_poly([0, 1] if name == letter else [1]) for name in names.names}
    sent = walks_until(chain, unit, departures(chain, step, INTERVALS), names, values)
    for row, function in places(family, chain.m):
        for n in range(1, INTERVALS + 1):
            power = stated(family, row, chain.m, function.rod, n, 0, unit.x + family.offset)
            polynomial = function_walks(chain, sent, function, n, step)
            assert polynomial.degree() <= power + 1
            if power >= 0:
                yield row, function, n, power, int(polynomial[power + 1])


@pytest.mark.slow
@pytest.mark.parametrize("system", [BUILDING_FORCE, BUILDING_GROUND], ids=lambda system: system.name)
def test_leading_coefficients_between_equal_floors_count_walks(system):
    family = POWERS[system.name][1]
    fibonacci = [1, 1]
    while len(fibonacci) < 40:
        fibonacci.append(sum(fibonacci[-2:]))
    for m in range(3, 9):
        floors = {i: fmpq(1, 2) for i in range(1, m)}
        chain = Chain(system, m, Parameters({0: fmpq(1), **floors, m: fmpq(7, 3)}))
        unit = units(chain)[0]
        for row, function, _, power, coefficient in leading(chain, unit, family):
            node = max(1, min(m - 1, int(row.node.xreplace({INDEX: function.rod, COUNT: m}))))
            # a base that moves with the ground turns waves round
            assert abs(coefficient) == count(family, m, power, node, 0) > 0
            if m == 5:
                assert abs(coefficient) in fibonacci


@pytest.mark.slow
def test_leading_coefficients_between_equal_discs_count_walks():
    told = 0
    for m in range(3, 8):
        ones = {i: fmpq(1) for i in range(1, m + 2)}
        chain = Chain(DRIVE, m, Parameters({i: ones[i] for i in range(1, m + 1)}, ones))
        for family in POWERS["drive"][1:]:
            first, last = (int(value.subs(COUNT, m)) for value in family.sources)
            for unit in units(chain):
                if first <= (source := unit.x + family.offset) <= last:
                    for row, function, _, power, coefficient in leading(chain, unit, family, "T_2"):
                        node = max(2, min(m, int(row.node.xreplace({INDEX: function.rod, COUNT: m}))))
                        assert coefficient == count(family, m, power, node, source) > 0
                        told += 1
    assert told > 500


@pytest.mark.slow
def test_leading_coefficients_between_equal_bodies_count_walks():
    family = POWERS["collision"][-1]
    for m in (6, 8, 10):
        bodies = range(1, m, 2)
        velocity = {i: fmpq(-(2**i)) for i in bodies}
        chain = Chain(COLLISION, m, Parameters({i: fmpq(1, 2) for i in bodies}, velocity=velocity))
        met = set()
        for unit in units(chain):
            for row, function, n, power, coefficient in leading(chain, unit, family):
                node = int(row.node.xreplace({INDEX: function.rod, COUNT: m}))
                assert coefficient == count(family, m, power, node, unit.x)
                if coefficient:
                    met.add((function, n))
        # over all contacts every power is met
        assert met == {(f, n) for _, f, n, *_ in leading(chain, unit, family)}


def test_a_wrong_count_is_seen():
    family = POWERS["building-force"][1]
    wrong = replace(family, leading=family.leading.subs(NODE, NODE + Rational(2)))
    assert count(family, 5, 4, 1, 0) != count(wrong, 5, 4, 1, 0)

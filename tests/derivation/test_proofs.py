"""For every i, m, k and rate, not for some: the delay equations are the node law, and the printed lists solve them."""

from dataclasses import replace

import pytest
from sympy import Integer, Symbol

from wavesym.derivation.delay import COUNT, INDEX, DelayEquation, delay_equations
from wavesym.derivation.delay_terms import Line, Operator, Wave
from wavesym.derivation.recurrence import coefficient_law, recurrence
from wavesym.documents.derivation.families import solve_at_rates
from wavesym.documents.derivation.patterns import patterns, rates
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE
from wavesym.verification.proofs import node_law
from wavesym.verification.theorem import residuals

SYSTEMS = [COLLISION, DRIVE, BUILDING_FORCE, BUILDING_GROUND]
CASES = [
    pytest.param(system, pattern, id=f"{system.name}, {pattern.name}")
    for system in SYSTEMS
    for pattern in patterns(system)
]


@pytest.mark.quick(2)
@pytest.mark.parametrize("system", SYSTEMS, ids=lambda system: system.name)
def test_delay_equations_are_the_node_law(system):
    proved = list(node_law(system, delay_equations(system)))
    assert len(proved) == len(delay_equations(system))
    for wave in proved:
        assert wave.difference == 0, wave
        assert all(determinant != 0 for determinant in wave.determinants), wave


def changed(e: DelayEquation):
    """The equation with one thing turned at a time: a sign, a lag, a load and its power, the own rate."""
    waves, loads = list(e.right.waves.items()), list(e.right.loads.items())
    for wave, operator in waves[:1]:
        yield replace(e, right=e.right.drop(wave) + Line({wave: Operator(-operator.a, -operator.b)}))
    for wave, operator in waves[-1:]:
        yield replace(e, right=e.right.drop(wave) + Line({wave._replace(lag=wave.lag + 1): operator}))
    for load, value in loads[:1]:
        yield replace(e, right=e.right + Line({}, {load: value}))
        yield replace(e, right=e.right + Line({}, {load._replace(power=load.power + 1): value}))
    yield replace(e, own=Operator(e.own.a, 2 * e.own.b))


SLOW_WHERE_BODIES_STRIKE = [
    pytest.param(system, marks=pytest.mark.slow) if system.name == "collision" else system for system in SYSTEMS
]


@pytest.mark.quick(1)
@pytest.mark.parametrize("system", SLOW_WHERE_BODIES_STRIKE, ids=lambda system: system.name)
def test_every_change_of_an_equation_breaks_the_proof(system):
    equations = list(delay_equations(system))
    for place, e in enumerate(equations):
        for wrong in changed(e):
            proved = node_law(system, [*equations[:place], wrong, *equations[place + 1 :]])
            assert any(wave.difference != 0 for wave in proved), wrong


def test_an_equation_that_is_missing_is_asked_for():
    with pytest.raises(ValueError, match="0 equations for g of rod i"):
        list(node_law(DRIVE, [e for e in delay_equations(DRIVE) if e.function != "g"]))


def theorem():
    """(D + q) F = (a D + b) G, one interval earlier, with symbols throughout."""
    a, b, q = (Symbol(name) for name in "abq")
    right = Line({Wave("g", INDEX, Integer(2)): Operator(a, b)})
    return DelayEquation("f", INDEX, Operator(Integer(1), q), right, Integer(1), COUNT, 1)


def test_the_theorem_of_the_recurrences():
    e = theorem()
    lines = solve_at_rates(coefficient_law(e, 2), None)
    assert [residual == 0 for residual in residuals(e, lines, 2)] == [True] * 3


@pytest.mark.parametrize("line", range(3))
def test_a_changed_line_breaks_the_theorem(line):
    e = theorem()
    lines = list(solve_at_rates(coefficient_law(e, 2), None))
    for part in range(len(lines[line].parts)):
        parts = list(lines[line].parts)
        parts[part] = (parts[part][0] + 1, parts[part][1])
        wrong = [*lines[:line], replace(lines[line], parts=tuple(parts)), *lines[line + 1 :]]
        assert [residual == 0 for residual in residuals(e, wrong, 2)] == [place != line for place in range(3)]
    # and a closure that forgets a function
    wrong = [*lines[:2], replace(lines[2], parts=lines[2].parts[1:])]
    assert list(residuals(e, wrong, 2))[2] != 0


@pytest.mark.quick(1)
@pytest.mark.parametrize(("system", "pattern"), CASES)
def test_what_is_printed_solves_the_delay_equations(system, pattern):
    laws = recurrence(system, pattern.parameters)
    for found in (None, rates(laws.laws)):
        for e, law in zip(delay_equations(system, pattern.parameters), laws.laws, strict=True):
            left = list(residuals(e, solve_at_rates(law, found), laws.interval))
            assert left, law
            assert all(residual == 0 for residual in left), law


@pytest.mark.parametrize("system", [DRIVE, BUILDING_FORCE], ids=lambda system: system.name)
def test_a_lost_load_is_seen(system):
    laws = recurrence(system)
    for e, law in zip(delay_equations(system), laws.laws, strict=True):
        if law.loads:
            lines = [replace(line, loads=line.loads[1:]) for line in solve_at_rates(law, None)]
            assert any(residual != 0 for residual in residuals(e, lines, laws.interval))

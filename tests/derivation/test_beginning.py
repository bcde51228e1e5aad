"""How a derivation begins: quantities with dimensions, Table 1, and the conditions in waves."""

import pytest
from sympy import Integer, Rational, cancel

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS, balance, sides
from wavesym.derivation.delay_terms import exact
from wavesym.derivation.numbers import number
from wavesym.derivation.rods import rod_kinds
from wavesym.documents.derivation.dimensions import LENGTH, SPEED, UNIT, dimensions
from wavesym.mechanics.node import Parameters, System
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE

K, J, V = SYMBOLS.kappa, SYMBOLS.inertia, SYMBOLS.velocity
SYSTEMS = [COLLISION, DRIVE, BUILDING_FORCE, BUILDING_GROUND]
# Table 1, with the indices that generated/errata.md finds where the scan is unreadable: tau_0, x_0, v
TABLE_1 = {
    COLLISION: {
        (1, 1): (1, 1, V[1]),
        (2, COUNT - 2): (0, INDEX, V[INDEX - 1]),
        (3, COUNT - 1): (0, INDEX - 1, V[INDEX]),
        (COUNT, COUNT): (1, COUNT - 1, V[COUNT - 1]),
    },
    DRIVE: {(1, COUNT): (0, INDEX - 1, 0)},
    BUILDING_FORCE: {(1, COUNT): (INDEX - 1, INDEX - 1, 0)},
    BUILDING_GROUND: {(1, COUNT): (INDEX - 1, INDEX - 1, 0)},
}


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda system: system.name)
def test_rods_are_those_of_table_1(system):
    found = {(kind.first, kind.last): kind.rod for kind in rod_kinds(system)}
    assert {key: (rod.tau0, rod.x0, rod.velocity) for key, rod in found.items()} == TABLE_1[system]


@pytest.mark.parametrize("m", [4, 6, 8])
@pytest.mark.parametrize("system", SYSTEMS, ids=lambda system: system.name)
def test_every_rod_is_there_once_as_the_node_on_its_right_has_it(system, m):
    numbers = {i: Integer(100 + i) for i in range(m + 2)}
    given = Parameters(numbers, numbers, numbers)
    nodes = {
        x: family.node_at(x)
        for family in system.families(m, given)
        for x in range(int(family.first), int(family.last) + 1, family.step)
    }
    seen = []
    for kind in rod_kinds(system):
        first, last = (int(number(end, {"m": m}, None)) for end in (kind.first, kind.last))
        for i in range(first, last + 1, kind.step):
            seen.append(i)
            places = {"i": i, "m": m}
            rod = nodes[i].left
            for part in ("tau0", "x0"):
                assert number(getattr(kind.rod, part), places, None) == int(getattr(rod, part))
            velocity = kind.rod.velocity.subs({INDEX: i, COUNT: m})
            assert velocity.subs({V[j]: value for j, value in numbers.items()}) == rod.velocity
    assert sorted(seen) == list(range(1, m + 1))


def with_dimensions(system: System, expression):
    """A factor of the dimensionless conditions with what kappa stands for, and J for the inertia."""
    kappa = dimensions(system).kappa
    indices = {part.indices[0] for part in exact(expression).atoms(type(K[0])) if part.base == K}
    return exact(expression).subs({K[j]: kappa.subs(INDEX, j) for j in indices})


def body(system: System, x):
    """The number of the body at x: a drive counts its discs from 1."""
    return x + 1 if system is DRIVE else x


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda system: system.name)
def test_the_conditions_are_those_of_section_2_without_dimensions(system):
    """(2.4) divided by B c_f^2 U_0 / l^2."""
    units = dimensions(system)
    masses = 0
    for family in system.families(COUNT, SYMBOLS):
        x = exact(family.first) if exact(family.first - family.last) == 0 else INDEX
        node = family.node_at(x)
        if not node.inertia:
            continue
        masses += 1
        scale = LENGTH**2 / (units.inertia.subs(INDEX, body(system, x)) * units.speed_squared * UNIT)
        for rod, factor, i in ((node.left, node.alpha, x), (node.right, node.beta, x + 1)):
            expected = scale * units.stiffness.subs(INDEX, i) * UNIT / LENGTH if rod else 0
            assert cancel(with_dimensions(system, Rational(1, 2) * factor) - expected) == 0
        for load in node.loads:
            ((_, unit), sign) = units.load, (-1 if x == COUNT else 1)
            assert cancel(with_dimensions(system, load.coefficients[0]) - sign * unit * scale) == 0
    assert masses


def test_the_base_of_the_paper_balances_the_foundation():
    """A dU/dx = M_0 a, divided by A U_0 / l, for an acceleration in units of a_0."""
    units = dimensions(BUILDING_FORCE)
    base = BUILDING_FORCE.families(COUNT, SYMBOLS)[0].node_at(0)
    (_, unit) = units.load
    force = units.inertia.subs(INDEX, 0) * unit.subs(SPEED**2, units.speed_squared)
    expected = -force / (units.stiffness * UNIT / LENGTH)
    assert cancel(with_dimensions(BUILDING_FORCE, base.loads[0].coefficients[0]) - expected) == 0
    wrong = 2 * base.loads[0].coefficients[0]
    assert cancel(with_dimensions(BUILDING_FORCE, wrong) - expected) != 0


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda system: system.name)
def test_the_conditions_in_waves_are_differentiated_from_4_2(system):
    """The velocity and the strain at a node, against (4.2) differentiated as a function of tau and x."""
    for family in system.families(COUNT, SYMBOLS):
        x = exact(family.first) if exact(family.first - family.last) == 0 else INDEX
        node = family.node_at(x)
        for end, rod in zip(sides(node, x), (node.left, node.right), strict=True):
            if rod is None:
                assert end is None
                continue
            # at lag later than tau each argument, and d/dx of it: -1 for f, +1 for g
            lags = {"f": exact(rod.tau0 + x - rod.x0), "g": exact(rod.tau0 - x + rod.x0)}
            signs = {"f": -1, "g": 1}
            assert {w.function: (w.lag, op.b) for w, op in end.velocity.waves.items()} == {
                name: (lag, 1) for name, lag in lags.items()
            }
            assert {w.function: (w.lag, op.b) for w, op in end.strain.waves.items()} == {
                name: (lag, signs[name]) for name, lag in lags.items()
            }
            assert sum(end.velocity.loads.values()) == rod.velocity
        motion, force = balance(node, x)
        assert bool(motion.waves) == bool(node.inertia or node.damping)
        assert bool(force.waves or force.loads)

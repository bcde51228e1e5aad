"""The SymPy objects of a derivation, against the tables of scenes and against waves that move."""

from __future__ import annotations

import pytest
import sympy
from sympy import IndexedBase, Integer, KroneckerDelta, Rational

import wavesym
from wavesym.derivation.equations import COEFFICIENTS, INTERVAL, Relation
from wavesym.derivation.recurrence import POWER, RATE
from wavesym.scene import Scene
from wavesym.scene.lowering import named_chain

N = 4
M = sympy.Symbol("m", integer=True, positive=True)


def numbers(scene: Scene) -> dict[sympy.Basic, sympy.Expr]:
    """The parameters of a scene as they stand in equations."""
    chain = named_chain(scene)
    assert chain is not None
    found: dict[sympy.Basic, sympy.Expr] = {M: Integer(chain.m)}
    for letter, values in (
        ("kappa", chain.parameters.kappa),
        ("J", chain.parameters.inertia),
        ("v", chain.parameters.velocity),
    ):
        for index, value in (values or {}).items():
            found[IndexedBase(letter)[index]] = Rational(int(value.p), int(value.q))
    return found


def rods(relation: Relation, known: dict[sympy.Basic, sympy.Expr]) -> range:
    first, last = (int(sympy.sympify(end).subs(known)) for end in (relation.first, relation.last))
    return range(first, last + 1, relation.step)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "name", ["drive_m1", "building_m2", "collision_m4", pytest.param("drive_equal", marks=pytest.mark.slow)]
)
def test_tables_satisfy_the_recurrences(name: str) -> None:
    scene = Scene.from_toml(name)
    known = numbers(scene)
    (system,) = wavesym.derive(scene).equations
    table = {
        (row.function, row.rod, row.source, row.interval, row.rate, row.power): row.value
        for row in wavesym.tables(scene, N)
    }
    sources = sorted({key[2] for key in table})
    powers = range(max(key[5] for key in table) + 1)
    every = sorted({key[4] for key in table})
    i = sympy.Symbol("i", integer=True, positive=True)
    checked = 0
    for relation in system.recurrences:
        for rod in rods(relation, known):
            plain = (relation.equation.lhs - relation.equation.rhs).subs(i, rod).subs(M, known[M]).subs(known)
            for source in sources:
                unit = {
                    load: Integer(int(str(load).replace("[", "").replace("]", "") == source))
                    for load in plain.atoms(sympy.Symbol, sympy.Indexed)
                    if str(load).partition("[")[0] in ("a", "b", "M", "R", "impact")
                }
                for n in range(1, N + 1):
                    for rate in every:
                        for power in powers:
                            here = {INTERVAL: n, RATE: Rational(rate.numerator, rate.denominator), POWER: power}
                            left = plain.subs(unit).subs(here)
                            for function, letter in COEFFICIENTS.items():
                                for f in left.atoms(sympy.Indexed):
                                    if f.base == letter:
                                        r, k, _, p = (int(x) if x.is_Integer else x for x in f.indices)
                                        value = table.get((function, r, source, k, rate, p), 0)
                                        left = left.subs(f, Rational(str(value)))
                            assert sympy.expand(left.replace(KroneckerDelta, lambda a, b: Integer(int(a == b)))) == 0
                            checked += 1
    assert checked > 50


def test_a_building_has_both_bases_and_text_stays_text() -> None:
    found = wavesym.derive("building")
    assert [each.system for each in found.equations] == ["building-force", "building-ground"]
    assert found.splitlines()[0].startswith("building")
    assert all(isinstance(each.equation, sympy.Eq) for system in found.equations for each in system.delay_equations)
    assert wavesym.derive(Scene.from_toml("stepped_shaft")).equations == ()

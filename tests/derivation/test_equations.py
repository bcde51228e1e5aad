"""The SymPy objects of a derivation, against the tables of scenes and against waves that move."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import sympy
from sympy import IndexedBase, Integer, KroneckerDelta, Rational

import wavesym
from wavesym.derivation.equations import COEFFICIENTS, INTERVAL, JUMPS, RATE, Relation
from wavesym.derivation.recurrence import POWER
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


@pytest.mark.parametrize("name", ["drive_m1", "building_m2", "collision_m4"])
def test_tables_satisfy_the_closures(name: str) -> None:
    """At its own rate a body's recurrence has no factor, and leaves open what `closures` say."""
    scene = Scene.from_toml(name)
    (system,) = wavesym.derive(scene).equations
    rows = wavesym.tables(scene, N)

    def jump(of: sympy.Indexed, source: str, n: int) -> sympy.Expr:
        function = next(name for name, base in JUMPS.items() if base == of.base)
        rod, interval = (int(index.subs(INTERVAL, n)) for index in of.indices)
        place = (function, rod, source, interval, 0)
        values = (x.value for x in rows if (x.function, x.rod, x.source, x.interval, x.power) == place)
        return sum((Rational(x.numerator, x.denominator) for x in values), Integer(0))

    assert system.closures
    for closure in system.closures:
        (own,) = closure.equation.lhs.atoms(sympy.Indexed)
        function = next(name for name, base in JUMPS.items() if base == own.base)
        open_one = COEFFICIENTS[function][closure.first, INTERVAL, RATE, POWER]
        (law,) = (x for x in system.recurrences if open_one in x.equation.lhs.atoms(sympy.Indexed))
        assert law.equation.lhs.coeff(open_one).subs(RATE, closure.rate).expand() == 0
        for source in {row.source for row in rows}:
            for n in range(1, N + 1):
                difference = closure.equation.lhs - closure.equation.rhs
                values = {of: jump(of, source, n) for of in difference.atoms(sympy.Indexed)}
                assert difference.xreplace(values) == 0
    assert any(row.power == 0 and row.rate for row in rows)


def test_equations_of_one_m_are_written_out() -> None:
    """They were those of any m, whatever m was asked for."""
    for system, m in (("collision", 4), ("drive", 2), ("building", 3)):
        for any_m, one in zip(wavesym.derive(system).equations, wavesym.derive(system, m).equations, strict=True):
            for kind in ("delay_equations", "recurrences", "closures"):
                each = getattr(one, kind)
                assert not any(x.equation.free_symbols & {M, any_m.symbols["i"]} for x in each)
                assert all((x.first, x.step) == (x.last, 1) for x in each)
                places = {**dict.fromkeys((M,), Integer(m))}
                assert len(each) == sum(len(rods(x, places)) for x in getattr(any_m, kind))
            assert {int(x.first) for x in one.delay_equations} == set(range(1, m + 1))
    kappa, gamma = (any_m.symbols[name] for name in ("kappa", "gamma"))
    roof = wavesym.derive("building", 3).equations[0].recurrences[-1].equation.lhs
    assert roof.coeff(COEFFICIENTS["g"][3, INTERVAL, RATE, POWER]) == kappa[3] - gamma


def test_the_names_in_equations_are_documented() -> None:
    """Each, and no other; and what has such a name is what `symbols` has."""
    page = Path("docs/reference/python.md").read_text(encoding="utf-8")
    table = page.split("| name in Python |")[1].split("\n\n")[0]
    documented = re.findall(r"^\| `(\w+)", table, re.MULTILINE)
    systems = [each for system in ("collision", "drive", "building") for each in wavesym.derive(system).equations]
    found: dict[str, sympy.Basic] = {}
    for system in systems:
        for relation in (*system.delay_equations, *system.recurrences, *system.closures):
            expression = relation.equation
            for part in expression.atoms(sympy.Symbol, sympy.IndexedBase) | {
                f.func for f in expression.atoms(sympy.core.function.AppliedUndef)
            }:
                if isinstance(part, sympy.Symbol) and IndexedBase(part) in expression.atoms(IndexedBase):
                    continue  # the label of a base
                found[str(part)] = part
    assert sorted(documented) == sorted(found) == sorted(systems[0].symbols)
    assert all(found[name] == systems[0].symbols[name] for name in found)

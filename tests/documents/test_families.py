"""The lists that are printed family by family, run as data in exact numbers, are the exact tables."""

from collections import defaultdict
from dataclasses import replace
from functools import cache
from graphlib import TopologicalSorter

import pytest
from flint import fmpq

from wavesym.derivation.increments import integrate
from wavesym.derivation.numbers import expression, number, symbol
from wavesym.derivation.recurrence import RATE
from wavesym.derivation.symbolic import symbolic
from wavesym.derivation.table import full_table
from wavesym.documents.derivation.chain_laws import meanings, own_laws
from wavesym.documents.derivation.document import derivation
from wavesym.documents.derivation.families import integral, solve_at_rates
from wavesym.documents.derivation.patterns import GENERIC, pattern_laws, patterns, rates
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Parameters
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE

INTERVALS = 4
NOWHERE = fmpq(0)
DIFFERENT = [fmpq(1, 3), fmpq(2, 5), fmpq(7, 4), fmpq(3, 7), fmpq(5, 6), fmpq(2, 3), fmpq(8, 9)]
NEARLY = [fmpq(1, 2) + fmpq(i, 10**9) for i in range(7)]
EQUAL = [fmpq(1, 2)] * 7


class Run:
    """Solved lines run interval by interval; nothing of `coefficients` is used."""

    def __init__(self, laws, found, m, value):
        self.known = {}
        self.given = value
        self.lines = {}
        self.own = {}
        for law in laws:
            q, lines = law.own_rate, solve_at_rates(law, found)
            for rod in range(self.place(law.first, 0, m), self.place(law.last, 0, m) + 1, law.step):
                self.lines[law.function, rod] = lines
                self.own[law.function, rod] = None if q is None else value(q, {"i": rod, "m": m})
        self.m = m
        self.rates = {fmpq(0)} | {q for q in self.own.values() if q is not None}
        self.powers = range(2 * INTERVALS + m)
        self.table = {}

    def value(self, part, places):
        if part.is_Integer:
            return int(part)
        key = (part, *places.values())
        if key not in self.known:
            self.known[key] = self.given(part, places)
        return self.known[key]

    def place(self, expression, rod, m):
        return int(number(expression, {"i": rod, "m": m}, None))

    def order(self):
        graph = {
            (function, rod): [
                (c.function, self.place(c.rod, rod, self.m))
                for line in lines
                for _, c in line.parts
                if c.back == 0 and c.function + str(c.rod) != function + str(line.left.rod)
            ]
            for (function, rod), lines in self.lines.items()
        }
        return list(TopologicalSorter(graph).static_order())

    def run(self, source):
        self.table = defaultdict(fmpq)
        order = self.order()
        for n in range(1, INTERVALS + 1):
            for function in order:
                for line in self.lines[function]:
                    self.line(function, line, n, source)
        return {key: value for key, value in self.table.items() if value != 0}

    def line(self, function, line, n, source):
        rod = function[1]
        places = {"i": rod, "m": self.m}
        at = self.rates - {self.own[function]} if line.left.rate == RATE else {self.value(line.left.rate, places)}
        powers = [0] if line.left.power == 0 else self.powers[1:] if line.least else reversed(self.powers)
        for k in powers:
            for g in at:
                here = places | {"k": k, "g": g}
                total = sum(
                    (self.value(f, here) * self.coefficient(c, here, n, function) for f, c in line.parts), fmpq(0)
                )
                total /= self.value(line.divisor, here)
                for load in line.loads:
                    name = load.kind if load.number is None else f"{load.kind}{self.place(load.number, rod, self.m)}"
                    if (g, k, n, name) == (0, load.power, load.back + 1, source):
                        total += self.value(load.value, here)
                self.table[(*function, n, g, k)] = total

    def coefficient(self, c, here, n, function):
        at = (c.function, int(self.value(c.rod, here)), n - c.back)
        power = int(self.value(c.power, here))
        among = {"": lambda: {self.value(c.rate, here)}, "all": lambda: self.rates}
        summed = among.get(c.sum_range, lambda: self.rates - {self.own[function]})()
        return sum((self.table[(*at, g, power)] for g in summed), fmpq(0))


def exact(chain, source):
    rows = full_table(chain, INTERVALS, NOWHERE).rows()
    return {(r.function, r.rod, r.interval, r.rate, r.power): r.value for r in rows if r.source == source}


def chain(system, m, numbers, pattern):
    """A chain that has the pattern, with `numbers` for what it leaves free."""
    if system is COLLISION:
        kappa = dict(zip(range(1, m, 2), numbers, strict=False))
        given = Parameters(kappa, velocity={i: fmpq(-(i**2), 3) for i in kappa})
    elif system is DRIVE:
        given = Parameters(
            dict(enumerate(numbers[:m], 1)), inertia=dict(enumerate([2 - x for x in numbers[: m + 1]], 1))
        )
    else:
        given = Parameters(dict(enumerate(numbers[: m + 1])))
    for pair in pattern.equalities:
        for i in _places(pair, m):
            base = {"kappa": given.kappa, "J": given.inertia}[str(pair.left.base)]
            base[i] = number(pair.right, {"i": i, "m": m}, given)
    return Chain(system, m, given)


def _places(pair, m):
    first, last = (int(number(end, {"m": m}, None)) for end in (pair.first, pair.last))
    return range(first, last + 1, pair.step)


CASES = [
    pytest.param(system, m, pattern, numbers, id=f"{system.name}-{m}-{pattern.name}-{name}")
    for system, sizes in ((COLLISION, (4, 6)), (DRIVE, (1, 3)), (BUILDING_FORCE, (2, 4)), (BUILDING_GROUND, (3,)))
    for name, m, numbers in (("nearly", sizes[0], NEARLY), *(("different", m, DIFFERENT) for m in sizes))
    for pattern in patterns(system)
]


def runner(chain, laws, found):
    return Run(laws, found, chain.m, lambda part, places: number(part, places, chain.parameters))


@pytest.mark.quick(3)
@pytest.mark.parametrize(("system", "m", "pattern", "numbers"), CASES)
def test_lists_run_to_the_exact_tables(system, m, pattern, numbers):
    one = chain(system, m, numbers, pattern)
    laws = pattern_laws(system, pattern)
    found = rates(laws) if pattern.equalities else None
    for source in one.sources[:2]:
        assert runner(one, laws, found).run(source) == exact(one, source)


@pytest.mark.quick(1)
@pytest.mark.parametrize("system", [COLLISION, DRIVE, BUILDING_FORCE], ids=lambda system: system.name)
def test_the_general_list_holds_where_rates_are_equal_too(system):
    one = chain(system, 4, EQUAL, GENERIC)
    laws = pattern_laws(system, GENERIC)
    assert runner(one, laws, None).run(one.sources[0]) == exact(one, one.sources[0])


def wrong(line):
    """A line with half of what it gives, loads aside."""
    return replace(line, divisor=2 * line.divisor)


@pytest.mark.slow
@pytest.mark.parametrize(("system", "m"), [(COLLISION, 4), (DRIVE, 2), (BUILDING_FORCE, 2)])
def test_every_line_matters(system, m):
    """A wrong divisor in any line of the list of the first pattern changes the tables."""
    pattern = patterns(system)[0]
    one = chain(system, m, DIFFERENT, pattern)
    laws = pattern_laws(system, pattern)
    found = rates(laws)
    true = {source: exact(one, source) for source in one.sources}
    for function, lines in runner(one, laws, found).lines.items():
        for place, line in enumerate(lines):
            run = runner(one, laws, found)
            run.lines[function] = (*lines[:place], wrong(line), *lines[place + 1 :])
            assert any(run.run(source) != table for source, table in true.items()), (function, line)


def test_the_lists_are_what_is_printed(monkeypatch):
    text = derivation("building", None, "text")
    # III.19 of the paper, which distributes 1/i: f_(1,i) = -g_(1,i) + 2 kappa_1/i (g_(1,i-1) + f_(1,i-1))
    assert (
        "    f_i^n[2 kappa_1,k] = (2 kappa_1 g_i^n[2 kappa_1,k-1] - k g_i^n[2 kappa_1,k] "
        "+ 2 kappa_1 f_(i-1)^n[2 kappa_1,k-1])/k,  k = 1, 2, ...\n"
    ) in text
    assert "/(2 kappa_1 - kappa_m)\n" in text  # of III.21
    monkeypatch.setattr(
        "wavesym.documents.derivation.writer.solve_at_rates",
        lambda law, found: tuple(wrong(line) for line in solve_at_rates(law, found)),
    )
    assert derivation("building", None, "text") != text


@pytest.mark.parametrize("name", ["f", "g"])
def test_the_integral_is_the_one_of_the_evaluators(name):
    increment = {NOWHERE: [fmpq(2), fmpq(1, 3)], fmpq(1, 2): [fmpq(5)], fmpq(7, 3): [fmpq(1), fmpq(0), fmpq(-4)]}
    law = integral(name, name.upper())
    run = Run([law], None, 1, lambda part, places: number(part, places, None))
    run.rates |= set(increment)
    run.table = defaultdict(fmpq)
    for rate, powers in increment.items():
        for k, value in enumerate(powers):
            run.table[name, 1, 1, rate, k] = value
    for line in run.lines[name.upper(), 1]:
        run.line((name.upper(), 1), line, 1, "")
    found = {key[3:]: value for key, value in run.table.items() if key[0] == name.upper() and value != 0}
    true = integrate(increment)
    assert found == {(rate, k): value for rate, powers in true.items() for k, value in enumerate(powers) if value != 0}


SCENES = [
    chain(BUILDING_GROUND, 3, [fmpq(1, 2), fmpq(1, 2), fmpq(1, 2), fmpq(1)], GENERIC),  # 2 kappa_1 = kappa_m
    chain(BUILDING_FORCE, 4, DIFFERENT, GENERIC),
    chain(DRIVE, 3, EQUAL, GENERIC),
    chain(DRIVE, 3, DIFFERENT, GENERIC),
    chain(COLLISION, 6, [fmpq(1, 3), fmpq(2), fmpq(1, 3)], GENERIC),
    # the second and the third disc turn at one rate, 3
    Chain(DRIVE, 2, Parameters({1: fmpq(1), 2: fmpq(2)}, inertia={1: fmpq(5), 2: fmpq(5), 3: fmpq(10, 3)})),
    Chain(DRIVE, 2, Parameters({1: fmpq(1), 2: fmpq(2)}, inertia={1: fmpq(10), 2: fmpq(5), 3: fmpq(5, 2)})),
]


@pytest.mark.quick(1)
@pytest.mark.parametrize("one", SCENES, ids=lambda one: f"{one.system.name}-{one.m}")
def test_the_lists_of_a_scene_run_to_its_tables(one):
    symbols = symbolic(one)
    laws = own_laws(symbols.chain)
    values = {meaning.symbol: meaning.value for meaning in meanings(symbols)}

    @cache
    def told(part):
        return part.subs(values)

    def value(part, places):
        return number(told(part), places, None)

    for source in one.sources:
        assert Run(laws, rates(laws), one.m, value).run(source) == exact(one, source)


def test_the_meaning_of_the_symbols_of_a_scene():
    symbols = symbolic(SCENES[0])
    assert [str(meaning.symbol) for meaning in meanings(symbols)] == ["kappa[0]"]
    assert expression(symbols.meaning["kappa_3"]) == 2 * symbol("kappa_0")
    velocities = {str(meaning.symbol): str(meaning.stands_for) for meaning in meanings(symbolic(SCENES[4]))}
    assert velocities["u[2]"] == "v[1] - v[3]"

"""Symbolic tables against the numeric ones, and against what the paper prints."""

from fractions import Fraction
from math import prod

import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from wavesym.derivation import symbolic as symbolic_module
from wavesym.derivation.symbolic import generic, in_rates, symbolic
from wavesym.derivation.table import full_table
from wavesym.errors import SceneError
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Parameters
from wavesym.numbers.forms import Forms
from wavesym.numbers.ratio import Ratio, Ring
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE

NOWHERE = fmpq(0)
# few values, so that equal parameters and meeting rates (2 kappa_1 = kappa_m) are always among them
positive = st.one_of(
    st.sampled_from([fmpq(1, 2), fmpq(1), fmpq(2)]),
    st.fractions(min_value=Fraction(1, 9), max_value=5, max_denominator=9).map(
        lambda f: fmpq(f.numerator, f.denominator)
    ),
)


@st.composite
def chains(draw):
    system = draw(st.sampled_from([COLLISION, DRIVE, BUILDING_FORCE, BUILDING_GROUND]))
    if system is COLLISION:
        m = draw(st.sampled_from([4, 6]))
        kappa = {i: draw(positive) for i in range(1, m, 2)}
        return Chain(system, m, Parameters(kappa, velocity={i: draw(positive) for i in kappa}))
    m = draw(st.integers(system.smallest, 3))
    if system is DRIVE:
        inertia = {i: draw(positive) for i in range(1, m + 2)}
        return Chain(system, m, Parameters({i: draw(positive) for i in range(1, m + 1)}, inertia=inertia))
    return Chain(system, m, Parameters({i: draw(positive) for i in range(m + 1)}))


def numbers(table, values):
    """The rows of a symbolic table where the symbols have `values`."""

    def at(ratio):
        return ratio.evaluate(values) if isinstance(ratio, Ratio) else ratio

    rows = [row._replace(rate=at(row.rate), value=at(row.value)) for row in table.rows()]
    return {row[:-1]: row.value for row in rows if row.value != 0}


def told(table, values):
    """The same from what a reader gets, factors in the symbols of the scene."""

    def at(value):
        if not isinstance(value, Ratio):
            return value
        content, above, below = value.factorization
        point = [values[name] for name in value.ring.told.names()]
        return (
            content
            * prod((factor(*point) ** power for factor, power in above), start=fmpq(1))
            / prod((factor(*point) ** power for factor, power in below), start=fmpq(1))
        )

    return {
        row[:-1]: row.value
        for row in (row._replace(rate=at(row.rate), value=at(row.value)) for row in table.rows())
        if row.value != 0
    }


def exact(chain, intervals):
    return {row[:-1]: row.value for row in full_table(chain, intervals, NOWHERE).rows()}


@settings(deadline=None, max_examples=30)
@given(chains())
def test_numbers_in_place_of_symbols_give_the_exact_table(chain):
    expected = exact(chain, 4)
    for symbols in (symbolic(chain), in_rates(symbolic(chain))):
        table = full_table(symbols.chain, 4, NOWHERE)
        assert numbers(table, symbols.values) == expected
        assert told(table, symbols.values) == expected


def test_a_coefficient_told_wrongly_is_seen(monkeypatch):
    chain = Chain(DRIVE, 1, Parameters({1: fmpq(3)}, inertia={1: fmpq(2), 2: fmpq(7)}))
    symbols = in_rates(symbolic(chain))
    table = full_table(symbols.chain, 4, NOWHERE)
    assert told(table, symbols.values) == exact(chain, 4)
    true = Forms.tell
    monkeypatch.setattr(Forms, "tell", lambda ring, factor: (1, *true(ring, factor)[1:]))
    again = in_rates(symbolic(chain))
    assert told(full_table(again.chain, 4, NOWHERE), again.values) != exact(chain, 4)


@settings(deadline=None, max_examples=20)
@given(st.lists(positive, min_size=4, max_size=4, unique=True))
def test_one_table_serves_all_parameters(kappa):
    """Away from its poles, where two rates meet."""
    chain = Chain(BUILDING_FORCE, 3, Parameters(dict(enumerate(kappa))))
    table = full_table(generic(BUILDING_FORCE, 3).chain, 4, NOWHERE)
    values = {f"kappa_{i}": value for i, value in enumerate(kappa)}
    if len({2 * kappa[1], 2 * kappa[2], kappa[3]}) == 3:
        assert numbers(table, values) == exact(chain, 4)


def building(*kappa):
    return symbolic(Chain(BUILDING_FORCE, len(kappa) - 1, Parameters(dict(enumerate(map(fmpq, kappa))))))


def test_equal_parameters_and_meeting_rates_are_one_family():
    # equal floors, a roof of its own: 2 kappa_1 and kappa_m; a roof of half a floor's mass: 2 kappa_1 alone
    for symbols, families in ((building(3, 1, 1, 5), {"0", "2*kappa_1", "kappa_3"}), (building(3, 1, 1, 2), None)):
        rates = {str(row.rate) for row in full_table(symbols.chain, 5, NOWHERE).rows()}
        assert rates == (families or {"0", "2*kappa_1"})
    assert str(symbols.meaning["kappa_3"]) == "2*kappa_1"
    assert str(symbols.meaning["kappa_2"]) == "kappa_1"


def test_rates_that_meet_in_no_polynomial_are_one_family():
    """kappa_1 r + kappa_2 = kappa_2 r: no symbol is a polynomial in the others, but kappa_1 = kappa_2 (r - 1)/r."""
    chain = Chain(DRIVE, 2, Parameters({1: fmpq(1), 2: fmpq(2)}, inertia={1: fmpq(4), 2: fmpq(2), 3: fmpq(1)}))
    symbols = in_rates(symbolic(chain))
    assert str(symbols.meaning["kappa_1"]) == "kappa_2*(r_1 - 1)/r_1"
    table = full_table(symbols.chain, 6, NOWHERE)
    assert numbers(table, symbols.values) == exact(chain, 6)
    other = {"kappa_1": fmpq(0), "kappa_2": fmpq(3), "r_1": fmpq(5, 2)}
    numeric = Chain(
        DRIVE, 2, Parameters({1: fmpq(9, 5), 2: fmpq(3)}, inertia={1: fmpq(25, 4), 2: fmpq(5, 2), 3: fmpq(1)})
    )
    assert numbers(table, other) == exact(numeric, 6)


def test_rates_that_meet_where_no_symbol_can_be_told_are_refused(monkeypatch):
    ring = Ring(["x", "y"])
    x, y = ring.context.gens()
    assert symbolic_module._place(ring, x**2 - 2 * y**2, {"x": fmpq(1), "y": fmpq(1)}) is None
    assert symbolic_module._place(ring, x * y - 1, {"x": fmpq(1), "y": fmpq(1)}) == 0
    monkeypatch.setattr(symbolic_module, "_place", lambda *_: None)
    with pytest.raises(SceneError, match=r"x = 1 and 2 meet where 2\*kappa_1 - kappa_2 = 0"):
        symbolic(Chain(BUILDING_FORCE, 2, Parameters({0: fmpq(1), 1: fmpq(2), 2: fmpq(4)})))


def test_the_denominator_is_the_one_that_the_paper_prints():
    """f_2 and g_2 of a building of two, second interval: kappa_2/(2 kappa_1 - kappa_2) and its square."""
    rows = {row[:-1]: str(row.value) for row in full_table(generic(BUILDING_FORCE, 2).chain, 2, NOWHERE).rows()}
    rows = {(*key[:4], str(key[4]), key[5]): value for key, value in rows.items()}
    assert rows["g", 2, "a", 2, "kappa_2", 0] == "4*kappa_1/(kappa_0*(2*kappa_1 - kappa_2))"
    assert rows["f", 2, "a", 2, "kappa_2", 0] == "4*kappa_1*kappa_2/(kappa_0*(2*kappa_1 - kappa_2)**2)"


def test_equal_discs_have_no_ratio_and_bodies_that_move_together_no_jump():
    discs = Chain(DRIVE, 2, Parameters({1: fmpq(1), 2: fmpq(3)}, inertia=dict.fromkeys((1, 2, 3), fmpq(7))))
    assert symbolic(discs).ring.names == ("kappa_1", "kappa_2")
    velocity = {1: fmpq(2), 3: fmpq(2), 5: fmpq(1)}
    bodies = Chain(COLLISION, 6, Parameters(dict.fromkeys((1, 3, 5), fmpq(1)), velocity=velocity))
    assert symbolic(bodies).ring.names == ("kappa_1", "u_4")


small = st.lists(st.integers(-3, 3), min_size=3, max_size=3).filter(any)


@given(small, small, small, small)
def test_ratios_are_a_field_in_lowest_terms(a, b, c, d):
    ring = Ring(["x", "y"])
    x, y = ring.symbols().values()
    p, q, r, s = (n[0] * x + n[1] * y + n[2] for n in (a, b, c, d))
    assert p / q + r / s == (p * s + r * q) / (q * s)
    assert (p / q) * (q / p) == 1
    assert p / q - p / q == 0
    assert (p / q) ** 2 * q == p * p / q
    assert hash(p * r / (q * r)) == hash(p / q)
    assert hash(p / p) == hash(fmpq(1))
    below = q.evaluate({"x": fmpq(5, 7), "y": fmpq(11, 13)})
    if below != 0:
        point = {"x": fmpq(5, 7), "y": fmpq(11, 13)}
        assert (p / q + 1).evaluate(point) == p.evaluate(point) / below + 1


@pytest.mark.parametrize(
    ("make", "expected"),
    [
        (lambda x, y: (x + y) / 2 / x, "(x + y)/(2*x)"),
        (lambda x, y: x * (x + y) / (x - y) ** 2, "x*(x + y)/((x - y)**2)"),
        (lambda x, y: -x / y, "-x/y"),
        (lambda x, y: x * x - y * y, "(x + y)*(x - y)"),
        (lambda x, y: (x + y) / y, "(x + y)/y"),
        (lambda x, y: x - x, "0"),
    ],
)
def test_as_text(make, expected):
    ring = Ring(["x", "y"])
    assert str(make(*ring.symbols().values())) == expected

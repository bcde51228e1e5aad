"""`derive` of a chain that is written out: what is printed is what runs, and what one derives by hand."""

from __future__ import annotations

import json
from typing import Any

import pytest
from flint import fmpq
from hypothesis import given, settings
from sympy import Rational, Symbol

from tests.support.chains import chains
from wavesym.api import derive
from wavesym.cli import main
from wavesym.derivation import numbers
from wavesym.derivation.node_law import node_law
from wavesym.derivation.numbers import symbol
from wavesym.documents.derivation.joint_kinds import isolate_joint, kinds, values
from wavesym.documents.derivation.network_statement import MOST_SYMBOLIC, network_statement, symbolic_polynomial
from wavesym.documents.derivation.notation import Text
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.exact.tables.joint_response import joint_polynomial
from wavesym.mechanics.network import Bar, Link, Network, Point
from wavesym.numbers.ratio import Ring
from wavesym.scene import Scene, lower

STEP = {
    "name": "step",
    "system": {
        "type": "chain",
        "parts": [
            {"rod": 1, "velocity": 1},
            {"mass": 3, "dashpot": "1/2", "velocity": 0, "name": "collar"},
            {"rod": 1, "impedance": 5, "name": "thick"},
            {"spring": 2},
            {"rod": 1},
            "fixed",
        ],
        "branch": [{"from": "collar", "name": "side", "ratio": -2, "parts": [{"rod": 1}, {"mass": 1, "spring": 1}]}],
    },
    "output": {"until": 4, "velocity": ["collar"]},
}


def told(table: dict[str, Any] = STEP) -> list[dict[str, Any]]:
    return json.loads(derive(Scene(**table), None, "json"))["kinds"]


def joint(of: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """The laws in symbols and in numbers."""
    return next((kind["symbols"], each) for kind in told() for each in kind["joints"] if each["of"].startswith(of))


def test_an_unequal_joint_by_hand() -> None:
    """An impedance step with a mass, a dashpot and gears."""
    symbols, numbers = joint("collar, x = 1; rods 1, thick, 4")
    assert symbols["of"] == "mass, dashpot; 3 rods, geared"
    assert symbols["laws"] == ["M_1 q_1' + (Z_1 + Z_2 + Z_3 n_3^2 + c_1) q_1 = 2 Z_1 a_1 + 2 Z_2 a_2 + 2 Z_3 n_3 a_3"]
    assert symbols["sent"] == ["l_1 = q_1 - a_1", "l_2 = q_1 - a_2", "l_3 = n_3 q_1 - a_3"]
    assert symbols["polynomial"] == ["M_1 s + Z_1 + Z_2 + Z_3 n_3^2 + c_1", "g = (Z_1 + Z_2 + Z_3 n_3^2 + c_1)/M_1"]
    assert numbers["given"] == ["M_1 = 3", "c_1 = 1/2", "Z_1 = 1", "Z_2 = 5", "Z_3 = 1", "n_3 = -2"]
    assert numbers["laws"] == ["3 q_1' + 21/2 q_1 = 2 a_1 + 10 a_2 - 4 a_3"]
    assert numbers["sent"][2] == "l_3 = -2 q_1 - a_3"
    assert (numbers["polynomial"], numbers["answer"]) == (["3 s + 21/2"], ["q_1 = 1/3 s_1/(D + 7/2)"])


def test_a_spring_between_rods_by_hand() -> None:
    """Without mass: (Z_1 + k/s)(Z_2 + k/s) - (k/s)^2, times s; the force in the spring dies away as exp(-g w)."""
    symbols, numbers = joint("x = 2-, x = 2+; rods thick, 3")
    assert symbols["of"] == "1: joint; 1 rod | 2: joint; 1 rod | spring between 1 and 2"
    assert symbols["laws"] == ["Z_1 q_1 + k_1 u_1 - k_1 u_2 = 2 Z_1 a_1", "Z_2 q_2 - k_1 u_1 + k_1 u_2 = 2 Z_2 a_2"]
    assert symbols["polynomial"] == ["Z_1 Z_2 s + Z_1 k_1 + Z_2 k_1", "g = (Z_1 k_1 + Z_2 k_1)/(Z_1 Z_2)"]
    assert numbers["polynomial"] == ["5 s + 12"]
    assert numbers["answer"] == [
        "q_1 = 1/5 s_1 - 2/25 s_1/(D + 12/5) + 2/5 s_2/(D + 12/5)",
        "q_2 = 2/5 s_1/(D + 12/5) + s_2 - 2 s_2/(D + 12/5)",
    ]


def test_what_moves_as_prescribed_pushes_through_springs_and_dashpots() -> None:
    """3/2 q + u = 2 a + q_1/2 + u_1: the answer is to all of the right side, so s has to say it."""
    table = {
        "name": "shaker",
        "system": {
            "type": "chain",
            "parts": [
                {"motion": "acceleration", "name": "table"},
                {"spring": 1, "dashpot": "1/2"},
                {"rod": 1},
                {"mass": 1, "name": "mass"},
                {"spring": 1, "dashpot": 1},
                "fixed",
            ],
        },
        "output": {"until": 1, "velocity": ["mass"]},
    }
    shaken, held = (each["joints"][0] for each in told(table))
    assert shaken["answer"] == ["s_2 = 2 a_1 + 1/2 q_1 + u_1", "q_2 = 2/3 s_2 - 4/9 s_2/(D + 2/3)"]
    assert held["answer"] == ["q_1 = s_1/(D + 1) - s_1/(D + 1)^2"]  # what is fixed pushes nothing


def test_an_expression_makes_the_symbols_of_its_own_terms_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """A joint of hundreds of points has as many symbols, each of its coefficients a few."""
    made: list[str] = []
    monkeypatch.setattr(numbers, "symbol", lambda name: made.append(name) or symbol(name))
    a, b, *_ = Ring(tuple(f"k_{i}" for i in range(1, 301))).symbols().values()
    assert numbers.expression(a * a + b * 3) == symbol("k_1") ** 2 + 3 * symbol("k_2")
    assert sorted(made) == ["k_1", "k_2"]


def test_ends_and_what_does_not_split() -> None:
    assert joint("x = 3; rod 3")[0]["laws"] == ["q_1 = 0"]
    symbols, numbers = joint("x = side:1")
    assert symbols["polynomial"] == ["M_1 s^2 + Z_1 s + K_1"]
    assert numbers["polynomial"] == ["s^2 + s + 1", "(s^2 + s + 1)"]
    assert numbers["answer"] == []
    assert "does not split into factors s + g" in derive(Scene(**STEP), None)


@settings(max_examples=15)
@given(chains())
def test_the_law_in_symbols_is_that_in_numbers(table: dict[str, Any]) -> None:
    """With a joint's numbers in place of the symbols, the polynomial of its kind is its own, up to a factor."""
    network = lower(Scene(**table)).network
    found = kinds(network)
    assert sorted(number for kind in found for number in kind.numbers) == list(range(len(network.joints)))
    for kind in found:
        for number in kind.numbers:
            made = isolate_joint(network, number)
            assert made.law == JointLaw.assemble(network, network.joints[number])
            free = len(made.law.heavy) + len(made.law.light)
            if not 0 < free <= MOST_SYMBOLIC:
                continue
            put = {symbol(name): Rational(int(v.p), int(v.q)) for name, v in values(made).items()}
            shown = [c.subs(put) for c in symbolic_polynomial(kind.symbols).all_coeffs()]
            own = joint_polynomial(made.law)
            ratio = shown[0] / Rational(str(own.leading_coefficient()))
            assert shown == [ratio * Rational(str(c)) for c in reversed(own.coeffs())]


def test_of_two_rods_it_is_the_law_of_a_node() -> None:
    """(M D + C) q = s with alpha = 2 Z_1 and beta = 2 Z_2."""
    (symbols,) = (kind.symbols for kind in kinds(_plain()) if len(kind.symbols.joint.ends) == 2)
    law = node_law()
    z = {Symbol("alpha"): 2 * symbol("Z_1"), Symbol("beta"): 2 * symbol("Z_2")}
    z |= {Symbol("M"): symbol("M_1"), Symbol("c"): symbol("c_1")}
    shown = symbolic_polynomial(symbols)
    assert shown.all_coeffs() == [part.subs(z).expand() for part in law.own]


def _plain():
    parts = [{"rod": 1}, {"mass": 1, "dashpot": 2}, {"rod": 1, "impedance": 3}]
    return lower(
        Scene(name="plain", system={"type": "chain", "parts": parts}, output={"until": 1, "velocity": [0]})
    ).network


@pytest.mark.parametrize("format", ["text", "latex", "json"])
def test_all_formats(format: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["derive", "geared_drive", "--format", format]) == 0
    text = capsys.readouterr().out
    assert text.count("{") == text.count("}")
    assert text.count("$") % 2 == 0
    assert ("q_{1}'" if format == "latex" else "q_1'") in text
    assert text == derive(Scene.from_toml("geared_drive"), None, format)


def test_rods_are_told() -> None:
    read = json.loads(derive(Scene(**STEP), None, "json"))
    assert [(rod["name"], rod["between"]) for rod in read["rods"]] == [
        ("1", "x = 0 -- collar, x = 1"),
        ("thick", "collar, x = 1 -- x = 2-"),
        ("3", "x = 2+ -- x = 3"),
        ("4", "collar, x = 1 -- x = side:1"),
    ]
    assert read["rods"][0]["formulas"] == ["T = 1", "Z = 1", "c = 1", "v = 1", "e = 0"]
    assert fmpq(1) == lower(Scene(**STEP)).network.bars[0].delay


def test_a_contact_is_told_as_it_is_open() -> None:
    one = fmpq(1)
    points = tuple(Point(fmpq(0), place=str(x)) for x in range(4))
    bars = Bar(0, 1, one, one, one), Bar(2, 3, one, one, one)
    statement = network_statement("c", Network(points, bars, (Link(1, 2, contact=True, place="1"),)), Text())
    (kind,) = (kind.symbols for kind in statement.kinds if len(kind.symbols.laws) == 2)
    assert kind.of.endswith("contact (open; closed, they move as one) between 1 and 2")
    assert kind.laws == ("Z_1 q_1 = 2 Z_1 a_1", "Z_2 q_2 = 2 Z_2 a_2")

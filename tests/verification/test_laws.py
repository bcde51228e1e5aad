"""Which program rests on which law: each law is broken in a process of its own, and the numbers of programs change.

docs/architecture.md has the table.
"""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from flint import fmpq

import wavesym
from wavesym import api
from wavesym.api import tables as table_rows
from wavesym.derivation import delay, recurrence
from wavesym.derivation.node_law import NodeLaw
from wavesym.derivation.rules import JointRule, Linear, Rule, Weights
from wavesym.exact.modes.stiffness import HarmonicLaw, Stiffness
from wavesym.programs.making import make
from wavesym.programs.request import KINDS, Request
from wavesym.programs.runtime.making import runtime_program
from wavesym.scene import Scene, lower
from wavesym.targets.files import files

ARCHITECTURE = Path(wavesym.__file__).parent.parent / "docs" / "architecture.md"
RAMPS = {"times": [0, "1/2"], "ramps": [1, "-2/3"]}
NAMED = Scene(
    name="named",
    system={"type": "drive", "m": 2, "kappa": ["8/7", "2/3"], "inertia": [1, 2, 3]},
    load=[{"body": 1, **RAMPS}],
    output={"until": 3, "tolerance": "1e-4", "velocity": [0, "1/2"], "displacement": [1]},
)
CHAIN = Scene(
    name="chain",
    system={
        "type": "chain",
        "parts": [{"mass": 1, "name": "a"}, {"rod": 1}, {"rod": "1/2", "impedance": 2}, {"mass": 2, "name": "b"}],
    },
    load=[{"at": "a", **RAMPS}],
    output={"until": 3, "tolerance": "1e-4", "velocity": ["b"], "displacement": ["a"]},
)
SCENES = {"named system": NAMED, "chain": CHAIN}
FACTOR = fmpq(3, 2)


def node_law(law: NodeLaw) -> NodeLaw:
    return replace(law, left=law.left * 2)


def coefficients(rule: Rule) -> Rule:
    """What is sent back counts more."""
    terms = (
        term._replace(weights=term.weights._replace(same=Linear(FACTOR * term.weights.same.constant, fmpq(0))))
        for term in rule.terms
    )
    return replace(rule, terms=tuple(terms))


def joint(rule: JointRule) -> JointRule:
    left, right = rule.radiates
    return rule._replace(radiates=(FACTOR * left, FACTOR * right))


def factor(law: Weights) -> Weights:
    return law._replace(next_power=Linear(FACTOR * law.next_power.constant, FACTOR * law.next_power.slope))


def stiffness(law: HarmonicLaw) -> HarmonicLaw:
    return replace(law, mass=[2 * mass for mass in law.mass])


Broken = Callable[[Any], Any]
LAWS: Mapping[str, tuple[tuple[Any, ...], str, Broken]] = {
    "law of a node": ((delay, recurrence), "node_law", node_law),
    "recurrences": ((recurrence,), "_rule", coefficients),
    "M, C, K of a joint": ((recurrence,), "joint_rule", joint),
    "factors of a joint": ((recurrence,), "factor_weights", factor),
    "dynamic stiffness": ((Stiffness,), "law", stiffness),
}


def numbers(law: str | None) -> dict[str, str]:
    """The numbers of every program; with a law broken, or how that was noticed."""
    for made in (recurrence.joint_rule, recurrence.recurrence):
        made.cache_clear()
    for home in LAWS[law][0] if law else ():
        _, name, broken = LAWS[law or ""]
        right = getattr(home, name)
        setattr(home, name, lambda *given, right=right, broken=broken: broken(right(*given)))
    found = {}
    for kind, scene in SCENES.items():
        for program, read in _programs(scene).items():
            try:
                found[f"{program}, {kind}"] = read()
            except wavesym.WavesymError as error:
                found[f"{program}, {kind}"] = str(error)
    return found


def _programs(scene: Scene) -> dict[str, Callable[[], str]]:
    model = lower(scene)

    def tables(program: Any) -> str:
        return repr(sorted(program.tables.items()))

    def made(kind: str) -> Callable[[], str]:
        return lambda: tables(make(model, Request(evaluator=kind)))

    def symbolic() -> list[str]:
        return list(api.symbolic_tables(scene, 3, "csv")[1])

    name = "kappa" if scene is NAMED else "mass"
    return {
        "`tables`": lambda: repr(table_rows(scene)),
        **({"`tables --symbolic`": lambda: repr(symbolic())} if scene is NAMED else {}),
        "`run`": lambda: repr(wavesym.evaluator(scene)([0.3, 1.7, 2.9]).tolist()),
        **{kind: made(kind) for kind in KINDS},
        "runtime": lambda: repr(files(runtime_program(model, Request(runtime=(name,)), ()), "c")),
        "stream": lambda: tables(api.program(scene, Request(stream=True))),
    }


def alone(law: str | None) -> dict[str, str]:
    """In a process of its own, so that nothing of it is left."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(numbers, (law,))


@pytest.fixture(scope="module")
def right() -> dict[str, str]:
    return alone(None)


def told() -> dict[str, list[str]]:
    """The table: the programs that rest on each law."""
    text = ARCHITECTURE.read_text(encoding="utf-8").split("## Which program rests on which law\n")[1].split("\n## ")[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line[:1] == "|"]
    head, _, *body = rows
    return {law: [row[0] for row in body if row[k] == "x"] for k, law in enumerate(head) if k}


def test_the_table_has_every_program_and_every_law(right: dict[str, str]) -> None:
    text = ARCHITECTURE.read_text(encoding="utf-8")
    assert [*told()] == [*LAWS]
    assert all(f"\n| {program} |" in text for program in right)
    assert not any("system" in numbers[:10] for numbers in right.values())  # none is refused


FIRST = ("M, C, K of a joint",)


@pytest.mark.parametrize("law", [law if law in FIRST else pytest.param(law, marks=pytest.mark.slow) for law in LAWS])
def test_programs_change_with_the_laws_that_they_rest_on(law: str, right: dict[str, str]) -> None:
    found = alone(law)
    assert [program for program in right if found[program] != right[program]] == told()[law]

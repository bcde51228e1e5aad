"""Friction and springs with corners in `verify`: what is right passes, and what is not is seen by each check."""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import replace
from fractions import Fraction
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import fmpq

from tests.support.assembly import exact
from tests.support.cornered import (
    Mix,
    breaking_chain,
    damped_chain,
    engaging_chain,
    friction_beside_contacts,
    light_friction,
    sliding_chain,
    touching_chain,
)
from wavesym.exact.reference import Reference
from wavesym.mechanics.event import ContactEvent
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import fraction
from wavesym.scene import Scene, lower
from wavesym.verification import checks, integrations, link_pulls
from wavesym.verification.corner_history import CornerHistory, compare_events
from wavesym.verification.independent import independent_model
from wavesym.verification.invariants import Balancing
from wavesym.verification.midpoint import MidpointGrid
from wavesym.verification.outcome import REFUSED, Outcome
from wavesym.verification.problem import BranchChange, Change, LinkLaw, corner_problem, match_all
from wavesym.verification.reference import ReferenceOutputs, known_outputs

CHECKS = (integrations.midpoints, integrations.differences, integrations.corner_changes, checks.invariants)

# yields and engages beside friction; a mirrored chain; a mass that turns under friction; differences late by parts of
# steps that are others on each grid; springs of both sides
SEEDS = (1, 38, 8, 10, 72, 170, 288)


@pytest.fixture(autouse=True)
def fewer_steps(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without --run-slow grids are halved two times less: errors are four times as large, and so is what is allowed."""
    if not request.config.getoption("--run-slow"):
        monkeypatch.setattr(integrations, "MOST_MOVED", integrations.MOST_MOVED / 4)


def known(table: dict[str, Any], claimed: dict[str, Any] | None = None) -> ReferenceOutputs:
    """What programs say of a scene, or of another one that is `claimed` to be it."""
    scene = Scene(**table)
    return known_outputs(lower(Scene(**(claimed or table))), independent_model(scene, lower(scene)))


@cache
def drawn(seed: int) -> ReferenceOutputs:
    """What programs say of a drawn chain, which more than one test asks."""
    return known(damped_chain(seed))


def judged(outcomes: list[Outcome]) -> list[Outcome]:
    return [outcome for outcome in outcomes if outcome.cells and REFUSED not in outcome.cells.values()]


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", SEEDS)
def test_drawn_chains_pass_every_check(seed: int) -> None:
    seen = drawn(seed)
    for check in CHECKS:
        outcomes = judged(check(seen))
        assert outcomes
        assert all(outcome.passed for outcome in outcomes)


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", [30, 33])
def test_dashpots_that_act_while_springs_do_pass_every_check(seed: int) -> None:
    seen = known(engaging_chain(seed))
    for check in CHECKS:
        assert all(outcome.passed for outcome in judged(check(seen)))


def test_a_stop_that_lets_go_where_it_would_pull_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Release at no force in place of at the gap: another law, which both integrators follow here."""
    body, stop = {"mass": 1, "velocity": 1, "name": "a"}, {"spring": 4, "only": "push", "gap": "1/3", "dashpot": 2}
    parts = [{"rod": 1, "impedance": "1/2", "velocity": 1}, body, stop, "fixed"]
    output = {"until": 4, "tolerance": 1e-9, "velocity": ["a"]}
    seen = known({"name": "stopped", "system": {"type": "chain", "parts": parts}, "output": output})
    push_back = LinkLaw.push_back
    assert all(outcome.passed for outcome in judged(integrations.midpoints(seen)))

    def never_pull(law: LinkLaw, free: float, compliance: float, step: Any) -> tuple[float, float, float]:
        force, slope, middle = push_back(law, free, compliance, step)
        return (force, slope, middle) if force > 0 else (0.0, 0.0, step.share * free + step.rest)

    monkeypatch.setattr(LinkLaw, "push_back", never_pull)
    for check in (integrations.midpoints, integrations.differences):
        assert not all(outcome.passed for outcome in judged(check(seen)))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [9, 11, 23, 38])
def test_friction_that_bears_more_at_rest_passes_every_check(seed: int) -> None:
    seen = known(breaking_chain(seed))
    for check in CHECKS:
        assert all(outcome.passed for outcome in judged(check(seen)))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [16, 42])
def test_belts_that_jump_pass_every_check(seed: int) -> None:
    seen = known(sliding_chain(seed))
    for check in CHECKS:
        assert all(outcome.passed for outcome in judged(check(seen)))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [18, 30, 69])
def test_contacts_beside_springs_pass_every_check(seed: int) -> None:
    seen = known(touching_chain(seed))
    for check in CHECKS:
        assert all(outcome.passed for outcome in judged(check(seen)))


@pytest.mark.slow
@pytest.mark.parametrize(("draw", "seed"), [(friction_beside_contacts, 14), (light_friction, 2)])
def test_friction_beside_other_laws_keeps_its_balances(draw: Mix, seed: int) -> None:
    assert all(outcome.passed for outcome in judged(checks.invariants(known(draw(seed)))))


NEARLY = [
    (integrations.midpoints, friction_beside_contacts, 1),  # a load that misses all grids by 1e-9
    (integrations.corner_changes, friction_beside_contacts, 3),  # a spring with a law and friction at one mass
    (integrations.differences, light_friction, 3),  # friction of what a spring with a law holds, too
    (integrations.differences, light_friction, 6),  # springs with a law at a joint without mass swing up
    (integrations.corner_changes, light_friction, 7),  # what turns round comes to rest at once
]


@pytest.mark.quick(2)
@pytest.mark.parametrize(("check", "draw", "seed"), NEARLY)
def test_what_grids_hardly_see_is_not_said_to_be_wrong(check: Any, draw: Mix, seed: int) -> None:
    outcomes = judged(check(known(draw(seed))))
    assert outcomes
    assert all(outcome.passed for outcome in outcomes)


@pytest.mark.slow
@pytest.mark.parametrize("draw", [friction_beside_contacts, light_friction])
@pytest.mark.parametrize("seed", [1, 3, 8, 11, 24])
def test_friction_beside_other_laws_passes_every_check(draw: Mix, seed: int) -> None:
    seen = known(draw(seed))
    for check in CHECKS:
        assert all(outcome.passed for outcome in judged(check(seen)))


COMES_TO_REST = {
    "name": "rests",
    "system": {
        "type": "chain",
        "parts": [
            "absorbing",
            {"rod": "1/2"},
            {"joint": True, "name": "n1", "friction": "1/5"},
            {"contact": "1/8"},
            {"mass": 2, "name": "n2", "velocity": "-1/4"},
        ],
    },
    "output": {"until": 3, "tolerance": 1e-9, "velocity": ["n1", "n2"], "displacement": ["n2"]},
}


@pytest.mark.slow
def test_a_contact_without_force_as_both_sides_come_to_rest_is_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The midpoint rule would turn a mass back by what friction does in a step; one that is pulled off is seen."""
    seen = known(COMES_TO_REST)
    outcomes = judged(integrations.corner_changes(seen))
    assert [outcome.subject for outcome in outcomes] == ["1/2 closes", "1/2 slips", "1/2 sticks"]
    assert all(outcome.passed for outcome in outcomes)
    pulled = COMES_TO_REST | {"load": [{"at": "n2", "times": ["9/4"], "ramps": ["1/50"]}]}
    assert "1/2 opens" in [each.subject for each in integrations.corner_changes(known(pulled))]
    assert [
        each.subject for each in judged(integrations.corner_changes(known(pulled, COMES_TO_REST))) if not each.passed
    ] == ["1/2 opens"]
    monkeypatch.setattr(link_pulls, "_TURNED", 0.0)
    anew = replace(seen)
    assert [each.subject for each in integrations.corner_changes(anew) if not each.passed] == ["1/2 opens"]


def test_a_mass_comes_to_rest_on_a_joint_that_rubs() -> None:
    """It stops 1/13 of a step behind an instant of all grids: they agreed on how fast it was turned back."""
    parts = deepcopy(COMES_TO_REST["system"]["parts"])
    parts[2]["friction"] = "0.1"
    parts[3]["contact"], parts[4]["velocity"] = "0.0324422465", "-0.064884493"
    seen = known(COMES_TO_REST | {"system": {"type": "chain", "parts": parts}})
    for outcome in judged(integrations.midpoints(seen)):
        assert outcome.verdict == "PASS"
        assert float(outcome.cells["at 4N"]) < 1e-6


@pytest.mark.slow
def test_what_happens_just_at_the_end_and_what_does_at_the_start_are_not_taken_for_each_other() -> None:
    """A joint slips at once, and once more as a front comes at the end: steps see the second of these alone."""
    rubs = {"joint": True, "name": "n1", "friction": "1/4"}
    parts = [{"rod": 1}, {"mass": 1, "name": "n0", "velocity": 1}, {"friction": "2/5"}, rubs, {"rod": 1}, "absorbing"]
    table = {"name": "ends", "system": {"type": "chain", "parts": parts}}
    table["output"] = {"until": 4, "tolerance": 1e-9, "velocity": ["n0", "n1"]}
    seen = known(table)
    outcomes = judged(integrations.corner_changes(seen))
    assert [outcome.cells["tau"] for outcome in outcomes[3:]] == ["0", "1.32853791756", "2", "3.6526462432", "4"]
    assert all(outcome.passed for outcome in outcomes)
    wrong = known(*changed(table, "friction"))
    assert not all(outcome.passed for outcome in judged(integrations.corner_changes(wrong)))


def test_values_are_compared_after_what_happens_at_corners_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """On the first grid on which the same happens nothing is off fronts after tau = 2.15: a finer one is taken."""
    monkeypatch.setattr("wavesym.verification.outcome.FINE", 1e-4)
    parts: list[Any] = [{"mass": 1, "friction": "1/2", "name": "m"}, {"rod": 1}, {"mass": 1, "name": "n"}]
    loads = [{"at": "m", "times": [0], "ramps": ["1/8"]}, {"at": "n", "times": [0], "ramps": ["1/10"]}]
    system = {"type": "chain", "parts": [*parts, {"rod": "7/5"}, "fixed"]}
    table = {"name": "st", "system": system, "load": loads, "output": {"until": 5, "velocity": ["m"]}}
    seen = known(table)
    right = judged(integrations.midpoints(seen))
    assert [(each.verdict, float(each.cells["to"]) > 4.5) for each in right] == [("PASS", True)]
    assert all(each.integral is not None and each.integral.judges for each in right)

    class WrongAtLast(Reference):
        def values(self, taus: Sequence[float]) -> list[list[float]]:
            rows = super().values(taus)
            return [[value * (1.01 if tau > 4 else 1) for tau, value in zip(taus, row, strict=True)] for row in rows]

    monkeypatch.setattr(integrations, "Reference", WrongAtLast)
    assert {each.verdict for each in integrations.midpoints(seen)} == {"FAIL"}


def test_what_lasts_less_than_some_steps_of_the_coarsest_grid_counts_on_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """Finer grids saw it and coarser ones did not: what happened was not the same until the finest of all."""
    problem = corner_problem(drawn(3).model)
    tried = set[float]()

    def solve(grid: MidpointGrid, steps: int, _: Any) -> tuple[None, SimpleNamespace]:
        step = float(grid.step)
        tried.add(step)
        branches = ((0, 1, 1.0), (1, 0, 1.02), (0, 1, 2.0))
        return None, SimpleNamespace(changes=[BranchChange(0, a, b, round(tau / step)) for a, b, tau in branches])

    monkeypatch.setattr(MidpointGrid, "_solve", solve)
    found = MidpointGrid(problem, Fraction(1, 64)).resolve_changes(4.0, 1e9)
    assert found is not None
    assert [(change.tau, slack < 0.02) for change, slack in found[1]] == [(2.0, True)]
    assert tried == {1 / 64, 1 / 128, 1 / 256}
    again = MidpointGrid(problem, Fraction(1, 2048)).resolve_changes(4.0, 1e9)
    assert again is not None
    assert [change.tau for change, _ in again[1]] == pytest.approx([1, 1.02, 2], abs=1e-3)


def test_what_happens_on_grids_is_the_same_on_all() -> None:
    closes, opens = Change(0, "closes", 1.0), Change(0, "opens", 2.0)
    assert match_all([[closes, opens]] * 3) == [(closes, 0.0), (opens, 0.0)]
    assert match_all([[closes], [closes], [closes, opens]]) is None


@pytest.mark.slow
def test_what_decays_within_a_step_is_looked_at_more_closely() -> None:
    """A rod strikes a light mass: grids of 64 to 256 steps agree to 2e-11, and are all wrong by 1e-10."""
    parts: list[Any] = [{"rod": 1, "velocity": 1, "impedance": 2}, {"contact": "1/3"}, {"mass": "1/100", "name": "a"}]
    parts += [{"rod": "1/2"}, {"contact": "1/1000"}, {"rod": 1}, "fixed"]
    output = {"until": 4, "tolerance": 1e-9, "velocity": ["a"]}
    table, heavier = changed({"name": "light", "system": {"type": "chain", "parts": parts}, "output": output}, "mass")
    assert [outcome.verdict for outcome in integrations.midpoints(known(table))] == ["PASS"]
    assert [outcome.verdict for outcome in integrations.midpoints(known(table, heavier))] == ["FAIL"]


@pytest.mark.parametrize("light", [1e-2, 1e-5, 1e-8])
def test_pulls_are_found_in_a_few_rounds(light: float) -> None:
    """A mass rubs on a joint that rubs on the ground: one link after another takes some 1/light rounds."""
    compliance = [[1 + light, -1.0], [-1.0, 1.0]]
    asked = 0

    def respond(number: int, rate: float) -> tuple[float, float]:
        nonlocal asked
        asked += 1
        held, limit = rate / compliance[number][number], (0.4, 0.25)[number]
        return (held, 1 / compliance[number][number]) if abs(held) < limit else (np.copysign(limit, held), 0.0)

    # held both; the upper one slides; the lower one; both
    for rates, right in (
        ([0.1 * light, 0.0], [0.1, 0.1]),
        ([0.5, 0.1], [0.4, 0.25]),
        ([-0.15, 0.0], [(-0.15 - 0.25) / (1 + light), -0.25]),
        ([5.0, 5.0], [0.4, 0.25]),
    ):
        pulls, asked = [0.0, 0.0], 0
        link_pulls.find_pulls(compliance, rates, pulls, respond, 1e-15)
        assert pulls == pytest.approx(right, rel=1e-6)
        assert asked < 40


@pytest.mark.slow
def test_what_a_coarse_grid_does_not_decide_is_no_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    """Events that come a step late hardly move from grid to grid; a spring that is 2 % stiffer is still seen."""
    monkeypatch.setattr(integrations, "MOST_MOVED", 1.25e7)
    table = touching_chain(18)
    outcomes = integrations.midpoints(known(table))
    assert all(outcome.passed for outcome in outcomes)
    assert [outcome.subject for outcome in outcomes if outcome.verdict == "-"] == ["displacement@n2"]
    assert "FAIL" in {outcome.verdict for outcome in integrations.midpoints(known(*changed(table, "spring")))}


@pytest.mark.slow
@pytest.mark.parametrize("start", range(0, 130, 10))
def test_many_drawn_chains_pass_every_check(start: int) -> None:
    for seed in range(start, start + 10):
        if seed == 119:  # the draw joins friction to a spring: no scene
            continue
        seen = known(damped_chain(seed))
        for check in CHECKS:
            assert [outcome for outcome in check(seen) if not outcome.passed] == [], seed


STRUCK = {
    "name": "struck",
    "system": {
        "type": "chain",
        "parts": [
            {"mass": 1, "velocity": 1, "name": "a"},
            {"spring": 4, "only": "push", "gap": "1/2"},
            {"mass": 1, "name": "b"},
            {"rod": 1},
            "fixed",
        ],
    },
    "output": {"until": 3, "tolerance": 1e-9, "velocity": ["a", "b"]},
}


def changed(table: dict[str, Any], key: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """A chain, and the same with a number that is 2 % more in the first part that has it."""
    other = deepcopy(table)
    part = next(part for part in other["system"]["parts"] if key in part)
    value = part[key]
    part[key] = [more(each) for each in value] if isinstance(value, list) else more(value)
    return table, other


def more(value: Any) -> str:
    return str(fmpq(51, 50) * exact(value))


FALSE = [
    (damped_chain(10), "friction"),
    (STRUCK, "gap"),
    *(pytest.param(damped_chain(seed), key, marks=pytest.mark.slow) for seed, key in ((8, "yield"), (22, "spring"))),
]


@pytest.mark.quick(2)
@pytest.mark.parametrize("check", [integrations.midpoints, integrations.differences])
@pytest.mark.parametrize(("table", "key"), FALSE)
def test_another_law_is_seen_by_both_integrators(table: dict[str, Any], key: str, check: Any) -> None:
    assert not all(outcome.passed for outcome in check(known(*changed(table, key))))


@pytest.mark.slow
@pytest.mark.parametrize("check", [integrations.differences, integrations.midpoints])
def test_another_limit_at_rest_is_seen_by_both_integrators(check: Any) -> None:
    parts = [{"motion": "velocity", "velocity": "1/4"}, {"rod": 1}, {"mass": 1, "name": "m", "velocity": 0}]
    parts[2] |= {"friction": "1/2", "breakaway": "0.99"}
    scene = {"name": "wound", "system": {"type": "chain", "parts": parts}}
    table, other = changed(scene | {"output": {"until": 8, "tolerance": 1e-9, "velocity": ["m"]}}, "breakaway")
    assert all(outcome.passed for outcome in check(known(table)))
    assert not all(outcome.passed for outcome in check(known(table, other)))


@pytest.mark.slow
def test_an_event_that_is_told_late_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    seen, right = drawn(1), integrations.events

    def late(model: Model) -> tuple[ContactEvent, ...]:
        return tuple(replace(event, tau=event.tau + 0.1) for event in right(model))

    assert all(outcome.passed for outcome in integrations.corner_changes(seen))
    monkeypatch.setattr(integrations, "events", late)
    assert not any(outcome.passed for outcome in judged(integrations.corner_changes(seen)))


@pytest.mark.slow
@pytest.mark.parametrize(("table", "key"), FALSE)
def test_energy_that_another_law_takes_is_missed(table: dict[str, Any], key: str) -> None:
    table, other = changed(table, key)
    books = Balancing(lower(Scene(**table)), 30_000)
    wrong = lower(Scene(**other)).watching(books.model.probes).shorten(books.model.until)

    def balances(model: Model) -> dict[str, bool]:
        values = Reference(model).values
        found = books.balances(lambda taus: np.array(values(taus.tolist())), None)
        return {each.name: each.error <= each.error_bound for each in found}

    assert balances(books.model) == {"momentum": True, "energy": True}
    assert not balances(wrong)["energy"]


@pytest.mark.slow
def test_the_midpoint_rule_is_of_order_two_where_friction_turns() -> None:
    """What slides stops, and goes back, inside a step."""
    model = lower(Scene(**damped_chain(38)))
    problem = corner_problem(model)
    errors = []
    for finer in (8, 32, 128):
        grid = MidpointGrid.coarsest(problem, fraction(model.until)).finer(finer)
        instants = np.round(np.array([0.35, 0.5, 1.1, 1.6]) / float(grid.step)).astype(int)
        taus = instants * float(grid.step)
        truth = Reference(model).values(taus.tolist())
        errors.append(np.max(np.abs(problem.outputs(grid.integrate(instants)[0], taus) - truth)))
    assert errors[2] < errors[0] / 100


@pytest.mark.parametrize(
    ("events", "seen", "passed"),
    [
        ("slips 1.1, slips 1.128, sticks 1.156", "", [True] * 3),  # within less than four steps
        ("slips 1.1, slips 1.16, sticks 1.24", "", [False]),
        ("slips 1, slips 1.02, sticks 1.05, slips 2, sticks 3", "slips 2, sticks 3", [True] * 5),
        ("slips 1, sticks 2, slips 3, slips 3.02, sticks 3.05", "slips 1, sticks 2", [True] * 5),
        ("slips 1, slips 1.02, sticks 1.05", "sticks 1.06", [True] * 3),
        ("slips 0, slips 1, slips 1.02, sticks 1.05", "", [False]),  # it slides from the start, and comes to rest
    ],
)
def test_what_slips_turns_and_sticks_at_once_is_too_short_to_see(events: str, seen: str, passed: list[bool]) -> None:
    def listed(text: str) -> list[tuple[str, float]]:
        return [(kind, float(tau)) for kind, tau in (each.split() for each in text.split(", ") if each)]

    claimed: Any = [SimpleNamespace(kind=kind, double=tau) for kind, tau in listed(events)]
    found = CornerHistory([(Change(0, kind, tau), 0.05) for kind, tau in listed(seen)], 0.08)
    outcomes = list(compare_events("0", claimed, {"midpoint": found}, 4.0))
    assert [outcome.passed for outcome in outcomes][-len(passed) :] == passed

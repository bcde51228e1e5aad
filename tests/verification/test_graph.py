"""The midpoint rule and balances over any network, and faults put in on purpose, which they must find."""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from flint import fmpq

from wavesym.exact.joints.joint_law import JointLaw
from wavesym.exact.reference import Reference
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Joint, Network
from wavesym.scene import Scene, lower
from wavesym.verification.integrations import _grid, collocation, midpoints
from wavesym.verification.invariants import Balance, Balancing
from wavesym.verification.problem import corner_problem
from wavesym.verification.reference import known_outputs

GEARED = {
    "type": "chain",
    "parts": [
        {"mass": 4, "velocity": 1, "name": "hammer"},
        {"rod": 1, "strain": "1/5"},
        {"rod": "3/2", "impedance": 2, "speed": "3/2"},
        {"mass": "1/2", "dashpot": "1/10", "name": "gear"},
        {"spring": 3, "dashpot": "1/4"},
        {"joint": True, "name": "end", "spring": "1/2"},
        {"rod": "1/2"},
        "fixed",
    ],
    "branch": [{"from": "gear", "name": "a", "ratio": -2, "parts": [{"rod": 1, "impedance": "1/2"}, {"mass": 1}]}],
}
LOADS = [{"at": "hammer", "times": [0, "3/2"], "steps": [1, -1], "ramps": [0, "1/3"]}]
OUTPUT = {"until": 6, "velocity": ["hammer", "end", "a:1/2"], "strain": ["1-", "1+"], "displacement": ["gear"]}


def model(**changes: object) -> Model:
    """A chain with gears, springs, dashpots, an impedance step, initial strain and two speeds."""
    return lower(Scene(**{"name": "geared", "system": GEARED, "load": LOADS, "output": OUTPUT, **changes}))


def test_the_midpoint_rule_is_of_order_2_and_agree() -> None:
    outcomes = midpoints(known_outputs(model()))
    assert all(outcome.passed and not outcome.note for outcome in outcomes)
    assert {outcome.cells["order"] for outcome in outcomes} <= {"2.0", "-"}


def test_motion_that_is_prescribed() -> None:
    parts = [{"motion": "acceleration", "velocity": "1/2", "name": "base"}, {"rod": 1}, {"mass": 1}, {"spring": 1}]
    system = {"type": "chain", "parts": [*parts, {"motion": "velocity", "name": "top"}]}
    loads = [{"at": "base", "times": [0, 1], "steps": [1, -2]}, {"at": "top", "times": [0], "ramps": [1]}]
    output = {"until": 5, "velocity": ["base", "1-"], "displacement": ["base", "1-", "1+"]}
    moved = model(system=system, load=loads, output=output)
    assert all(
        outcome.passed and not outcome.note
        for outcome in (*midpoints(known_outputs(moved)), *collocation(known_outputs(moved)))
    )
    assert all(balance.error <= balance.error_bound < 1e-12 for balance in balances(moved))


def test_delays_without_a_reasonable_common_measure_are_refused_in_a_line_by_a_grid() -> None:
    system = {"type": "chain", "parts": [{"mass": 1, "name": "hammer"}, {"rod": 1}, {"rod": "1.414213562"}]}
    other = model(system=system, output={"until": 5, "velocity": ["hammer"]})
    (outcome,) = midpoints(known_outputs(other))
    assert outcome.passed
    assert "refused" in outcome.cells.values()
    assert "a step" in outcome.note
    assert all(outcome.passed and "at 4N" in outcome.cells for outcome in collocation(known_outputs(other)))
    assert all(balance.error <= balance.error_bound < 1e-12 for balance in balances(other))


def test_collocation_agrees_to_rounding() -> None:
    outcomes = collocation(known_outputs(model()))
    assert all(outcome.passed and not outcome.note for outcome in outcomes)
    assert all(float(outcome.cells["allowed"]) < 2e-12 for outcome in outcomes)


def test_a_grid_has_every_front_load_and_output_on_it() -> None:
    coarsest = _grid(model())
    assert coarsest.problem.measure == Fraction(1, 2)
    assert coarsest.is_aligned
    cells = [delay / coarsest.step for delay in coarsest.problem.delays]
    assert all(each.denominator == 1 for each in cells)
    assert min(cells) == coarsest.cells >= 16


def balances(right: Model, wrong: Model | None = None) -> tuple[Balance, Balance]:
    """The balances of a model, of values of another one."""
    balancing = Balancing(right, 12_000)
    assert balancing.balance_times
    exact = Reference(replace(balancing.model, network=(wrong or right).network))
    errors = [2.0**-50] * len(balancing.model.probes)
    return balancing.balances(lambda taus: np.array(exact.values(taus.tolist())), errors)


def test_momentum_and_energy_are_kept() -> None:
    assert all(balance.error <= balance.error_bound < 1e-12 for balance in balances(model()))


def squared(network: Network) -> Network:
    """A gear ratio squared."""
    bars = (replace(bar, ratios=(bar.ratios[0] ** 2, bar.ratios[1])) for bar in network.bars)
    return replace(network, bars=tuple(bars))


def swapped(network: Network) -> Network:
    """The impedances of two bars on each other's side."""
    first, second, *others = network.bars
    changed = (replace(first, impedance=second.impedance), replace(second, impedance=first.impedance))
    return replace(network, bars=(*changed, *others))


def softened(network: Network) -> Network:
    """A dashpot between points left out."""
    return replace(network, links=tuple(replace(link, damping=fmpq(0)) for link in network.links))


@pytest.mark.slow
@pytest.mark.parametrize(
    "fault", [squared, pytest.param(swapped, marks=pytest.mark.slow), pytest.param(softened, marks=pytest.mark.slow)]
)
def test_faults_of_a_network_are_found(fault: Callable[[Network], Network], monkeypatch: pytest.MonkeyPatch) -> None:
    right = model()
    wrong = replace(right, network=fault(right.network))
    assert any(balance.error > balance.error_bound for balance in balances(right, wrong))
    monkeypatch.setattr("wavesym.verification.integrations.Reference", lambda _: Reference(wrong))
    assert not all(outcome.passed for outcome in midpoints(known_outputs(right)))
    assert not all(outcome.passed for outcome in collocation(replace(known_outputs(wrong), model=right)))


def test_the_sign_of_a_spring_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    law_of = JointLaw.assemble

    def wrong(network: Network, joint: Joint) -> JointLaw:
        law = law_of(network, joint)
        rows = (tuple(k if a == b else -k for b, k in enumerate(row)) for a, row in enumerate(law.stiffness))
        return replace(law, stiffness=tuple(rows))

    monkeypatch.setattr(JointLaw, "assemble", wrong)
    right = model()
    assert any(balance.error > balance.error_bound for balance in balances(right))
    assert not all(outcome.passed for outcome in midpoints(known_outputs(right)))
    assert not all(outcome.passed for outcome in collocation(known_outputs(right)))


def test_the_matrices_are_those_of_the_engine_less_the_bars() -> None:
    network = model().network
    made = corner_problem(model())
    for joint in network.joints:
        law = JointLaw.assemble(network, joint)
        rows = np.ix_(joint.points, joint.points)
        assert made.stiffness[rows].tolist() == [[float(k.p) / float(k.q) for k in row] for row in law.stiffness]

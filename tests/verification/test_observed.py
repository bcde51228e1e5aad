"""Integrators judge sums from their own strains and motions: right ones pass, a wrong factor in one does not."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from flint import fmpq

from wavesym.mechanics.gauge import ReadingTerm, Sum, readings
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.mechanics.probe import Probe
from wavesym.scene import Scene, lower
from wavesym.verification import integrations
from wavesym.verification.reference import known_outputs

DRIVE = {
    "name": "drive",
    "system": {"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, "1/2"]},
    "load": [{"body": 2, "times": [0, "1/2"], "steps": [1, "-1/2"]}],
    "output": {"until": 3, "tolerance": "1e-6", "acceleration": [1], "force": ["1/2"], "drift": [2]},
}
STRUCK = {
    "name": "struck",
    "system": {
        "type": "chain",
        "parts": [
            {"motion": "velocity", "name": "base"},
            {"rod": 1, "impedance": 2},
            {"mass": 1, "name": "post", "dashpot": "1/5"},
            {"rod": 1},
            "contact",
            {"mass": 2, "name": "ram", "velocity": -1, "spring": 1},
        ],
    },
    "load": [{"at": "base", "times": [0], "steps": ["1/3"]}, {"at": "ram", "times": ["1/2"], "steps": [-1]}],
    "output": {
        "until": 3,
        "tolerance": "1e-6",
        "acceleration": ["post", "ram"],
        "force": ["1-"],
        "drift": [1],
        "relative": ["ram"],
    },
}
JUDGES = [
    (DRIVE, integrations.collocation),
    (DRIVE, integrations.midpoints),
    (STRUCK, integrations.midpoints),
    (STRUCK, integrations.collocation),
]
EACH = pytest.mark.parametrize(
    ("scene", "judge"), JUDGES, ids=["fronts of a drive", "grid of a drive", "grid of a chain", "fronts of a chain"]
)


def model(scene: dict[str, Any]) -> Model:
    """Its outputs with factors, as those of physical scenes have."""
    made = lower(Scene(**scene))
    return made.watching(replace(probe, factor=fmpq(-(10**6) * (k + 1), 7)) for k, probe in enumerate(made.probes))


@pytest.mark.quick(1)
@EACH
def test_what_is_right_passes(scene: dict[str, Any], judge: Any) -> None:
    outcomes = judge(known_outputs(model(scene)))
    assert len(outcomes) == len(model(scene).probes)
    assert all(outcome.passed for outcome in outcomes)
    assert any("at 4N" in outcome.cells for outcome in outcomes)


@pytest.mark.quick(1)
@EACH
def test_a_term_that_is_a_little_wrong_is_seen(
    scene: dict[str, Any], judge: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In each output the last term, whatever it is: a strain, a velocity, a displacement or a load."""

    def wrong(network: Network, probe: Probe) -> Sum:
        *terms, (weight, gauge) = readings(network, probe)
        return (*terms, ReadingTerm(weight * fmpq(1001, 1000), gauge))

    for module in ("mechanics.model", "exact.tables.signal"):
        monkeypatch.setattr(f"wavesym.{module}.readings", wrong)
    assert not any(outcome.passed for outcome in judge(known_outputs(model(scene))))

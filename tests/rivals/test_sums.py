"""Rivals of outputs that are sums: what they solve for, added up, is what wavesym has."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from flint import fmpq

from wavesym.exact.reference import Reference
from wavesym.rivals import characteristics, elements, modes
from wavesym.rivals.problem import Rival
from wavesym.rivals.sums import summing
from wavesym.scene import Scene, lower

DRIVE = Scene(
    name="drive",
    system={"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, "1/2"]},
    load=[{"body": 2, "times": [0, "1/2"], "steps": [1, "-1/2"]}],
    output={"until": 5, "velocity": [1], "acceleration": [1, 2], "force": ["1/2"], "drift": [2]},
)


@pytest.mark.parametrize(
    ("rival", "resolution", "allowed"),
    [(characteristics.FOURTH, 100, 1e-6), (modes.RIVAL, 300, 2e-2), (elements.RIVAL, 160, 5e-2)],
    ids=["characteristics", "modes", "elements"],
)
def test_sums_of_what_rivals_solve_for(rival: Rival[Any], resolution: float, allowed: float) -> None:
    """Away from fronts, where all of them are as good as they are; times factors, as in physical scenes."""
    model = lower(DRIVE)
    model = model.watching(replace(probe, factor=fmpq(10**k)) for k, probe in enumerate(model.probes))
    reference = Reference(model)
    taus = np.linspace(0.1, 4.9, 97)
    fronts = np.array(reference.breakpoints())
    taus = taus[np.min(np.abs(taus[:, np.newaxis] - fronts), axis=1) > 0.1]
    exact = np.array(reference.values(taus.tolist()))
    method = summing(rival)
    stated = method.states(model)
    assert not stated.plain
    found = method.prepare(stated, resolution)(taus)
    assert np.all(np.abs(found - exact) <= allowed * np.max(np.abs(exact), axis=1, keepdims=True))


def test_what_is_read_as_it_is_costs_nothing_more() -> None:
    model = lower(DRIVE)
    assert summing(modes.RIVAL).states(model.watching(model.probes[:1])).plain

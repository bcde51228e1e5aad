"""Modes of which all points rest while rods swing between them: none is missed beside dashpots and springs."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pytest

import wavesym
from wavesym.exact.modes import damped_modes
from wavesym.scene import Scene

MASS = {"mass": 1, "name": "a"}


def modes(parts: list[Any], count: int = 6, branch: Any = (), **more: Any) -> wavesym.Modes:
    system = {"type": "chain", "parts": parts, "branch": list(branch)}
    return wavesym.modes(Scene(name="s", system=system, output={"until": 1, "velocity": ["a"]}), count, **more)


def test_rods_ring_on_beside_a_dashpot_between_their_ends() -> None:
    """(2 cot w - w + i c) sin w = 0: every other mode is undamped, and was left out."""
    found = modes(["fixed", {"rod": 1, "dashpot": "2/5"}, MASS, {"rod": 1}, "fixed"], 9)
    assert (len(found), found.complete) == (9, True)
    assert [mode.omega for mode in found if mode.damping == 0] == pytest.approx([pi, 2 * pi, 3 * pi, 4 * pi], rel=1e-15)
    w = np.array([complex(mode.frequency) for mode in found.exact if not mode.amplitudes])
    assert np.abs(2 / np.tan(w) - w + 0.4j).max() < 1e-9
    assert all(mode.shape["a"] == 0 for mode in found if mode.damping == 0)


def test_rods_ring_on_beside_a_branch_that_damps() -> None:
    """The same where the dashpot is on a branch, which the node at rest holds: Newton's method left for other modes."""
    branch = {"from": "a", "name": "b", "parts": [{"spring": 2, "dashpot": "3/10"}, {"mass": 1}]}
    found = modes([{"motion": "velocity", "name": "g"}, {"rod": 1}, MASS, {"rod": 1}, "fixed"], 8, [branch])
    assert (len(found), found.complete) == (8, True)
    assert [mode.omega for mode in found if mode.damping == 0] == pytest.approx([pi, 2 * pi, 3 * pi], rel=1e-15)


@pytest.mark.parametrize("link", ["spring", "dashpot"])
def test_shapes_balance_at_nodes_and_effective_masses_are_closed_forms(link: str) -> None:
    """Rods of delays 1 and 2: sin pi s on one, -(Z1/Z2) sin pi s on the other; the mass of the first moves alone."""
    first, second = 3.0, 0.5
    parts = ["fixed", {"rod": 1, "impedance": 3, link: 2}, MASS, {"rod": 2, "impedance": "1/2"}, "fixed"]
    found = modes(parts, 8, points=9)
    assert found.complete
    number = next(k for k, mode in enumerate(found) if abs(mode.omega - pi) < 1e-12)
    (line,) = found.line_shapes
    shape = line.displacements[number]
    turns = np.where(line.x <= 1, second * np.sin(pi * line.x), first * np.sin(pi * line.x)) / first
    assert np.abs(np.abs(shape) - np.abs(turns)).max() < 1e-15
    assert shape[4].real * shape[11].real < 0, "rods pull the node both ways"
    if link == "spring":
        size = second / first  # of the first rod's amplitude
        mass = first * size**2 / 2 + second
        moved, whole = first * size * 2 / pi, 1 + first + 2 * second
        assert found[number].effective_mass == pytest.approx(moved**2 / mass / whole, rel=1e-14)


def test_of_a_star_of_equal_rods_all_are_found_and_at_right_angles() -> None:
    """Three rods from one node to supports: two modes at each k pi, one beside a dashpot that is at rest."""
    branch = [{"from": "a", "name": name, "parts": [{"rod": 1, "impedance": 2}, "fixed"]} for name in "bc"]
    found = modes(["fixed", {"rod": 1, "dashpot": 1}, MASS], 8, branch)
    assert (len(found), found.complete) == (8, True)
    assert sum(abs(mode.omega - pi) < 1e-12 for mode in found) == 2
    one, other = (mode.amplitudes for mode in found.exact if abs(complex(mode.frequency) - pi) < 1e-12)
    z = [1, 2, 2]
    assert abs(float(sum(z[n] * one[n] * other.get(n, 0) for n in one))) < 1e-15
    for amplitudes in (one, other):  # the first rod ends at the node, and turns by pi; the others begin there
        assert abs(float(sum(z[n] * a for n, a in amplitudes.items()))) < 1e-15


def test_without_them_it_is_said_that_modes_are_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(damped_modes, "resting_modes", lambda *_, **__: [])
    found = modes(["fixed", {"rod": 1, "dashpot": "2/5"}, MASS, {"rod": 1}, "fixed"])
    assert not found.complete
    assert not any(mode.damping == 0 for mode in found)


def test_what_is_near_such_a_mode_but_none_is_told_from_it() -> None:
    """A rod that is longer by 1e-7 does not resonate with the other: no mode is at pi, but one near it."""
    found = modes(["fixed", {"rod": 1, "dashpot": "2/5"}, MASS, {"rod": "1.0000001"}, "fixed"], 3)
    assert found.complete
    near = found[1]
    assert near.omega == pytest.approx(pi, rel=1e-6)
    assert near.omega != pytest.approx(pi, rel=1e-9)
    assert near.damping > 0

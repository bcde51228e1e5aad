"""Which outputs waves can have reached: what numbers that cancel leave of them does not matter."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.march.plan import LEFT, LOAD, RIGHT
from wavesym.programs.runtime.arrays.laws import ArrayLaws
from wavesym.programs.runtime.arrays.tables import ArrayTables, Ints

Bools = NDArray[np.bool_]


def reached(tables: ArrayTables, law: ArrayLaws) -> Bools:
    """Of each output and set (outputs, sets), whether anything can be felt there up to the horizon, as waves are sent
    from window to window.
    """
    sizes, (nodes, sets) = tables.sizes, law["alpha"].shape
    body, on = tables.ints("is_body")[:, None] > 0, tables.ints("force_on")
    left, right = law["alpha"] != 0, law["beta"] != 0
    beside = np.where(left, law["rod"][:-1], law["rod"][1:])
    stirred = left & right & (law["rod"][:-1] != law["rod"][1:]) | body & (law["motion"] != beside)
    lit = np.zeros((2, 3, sizes["panels"], nodes + 2, sets), bool)
    pushed = np.zeros((sizes["forces"] + 1, sets), bool)  # the last one: a node without a load
    found = np.zeros((tables.outputs, sets), bool)
    begins, panels = tables.ints("event_window"), tables.ints("event_panel")
    for window in range(sizes["windows"]):
        now, before = window % 2, 1 - window % 2
        for panel in range(sizes["panels"]):
            for event in np.flatnonzero((begins == window) & (panels == panel)):
                pushed[tables.ints("event_force")[event]] |= law["load"][tables.ints("event_load")[event]] != 0
            lit[now, LOAD, panel, : sizes["forces"]] = pushed[:-1]
            a, b = lit[before, RIGHT, panel, :-2], lit[before, LEFT, panel, 2:]
            stirred = stirred | pushed[on] | body & (a & left | b & right)
            lit[now, LEFT, panel, 1:-1] = stirred | b & right | a & (law["alpha"] != 1)
            lit[now, RIGHT, panel, 1:-1] = stirred | a & left | b & (law["beta"] != 1)
        found |= _heard(tables, law, lit, window)
    return found


def _heard(tables: ArrayTables, law: ArrayLaws, lit: Bools, window: int) -> Bools:
    """What of that outputs hear on a window."""
    found = np.zeros((tables.outputs, lit.shape[-1]), bool)
    first = tables.ints("first_term")
    for section in range(tables.sizes["sections"]):
        if window + tables["from"][section] > tables.tau_max:
            break
        for output in range(tables.outputs):
            for strand in tables.strands(section, output):
                for term in range(first[strand], first[strand + 1]):
                    way, panel, sender, back, heard = (
                        int(tables.ints(f"term_{name}")[term]) for name in ("way", "panel", "sender", "back", "heard")
                    )
                    found[output] |= lit[(window + back) % 2, way, panel, sender] & (law["gain"][heard] != 0)
    return found


def heard_since(tables: ArrayTables, since: Ints) -> Bools:
    """Of each output and set, whether it hears a track from that panel on, counted through all windows, from which
    something is sent into it: (tracks, sets).
    """
    found = np.zeros((tables.outputs, since.shape[1]), bool)
    first, panels = tables.ints("first_term"), tables.sizes["panels"]
    track, back, panel = (tables.ints(f"term_{name}") for name in ("track", "back", "panel"))
    for window in range(tables.sizes["windows"]):
        begun, phase = float(tables.begins(np.array(window))), window % tables.cycle
        for section, output in np.ndindex(tables.sizes["sections"], tables.outputs):
            if begun + tables.section(phase, section)[0] <= tables.tau_max:
                for strand in tables.strands(section, output):
                    terms = slice(first[strand], first[strand + 1])
                    when = (window - back[terms]) * panels + panel[terms]
                    found[output] |= np.any(when[:, None] >= since[track[terms]], axis=0)
    return found

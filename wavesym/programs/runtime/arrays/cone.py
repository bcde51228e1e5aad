"""Which outputs waves can have reached: what numbers that cancel leave of them does not matter.

The first row of what is asked is of values, the others of their derivatives by each parameter.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.runtime.arrays.laws import ArrayLaws
from wavesym.programs.runtime.arrays.tables import ArrayTables, Ints
from wavesym.programs.runtime.line import LEFT, LOAD, RIGHT

Bools = NDArray[np.bool_]


def reached(tables: ArrayTables, law: ArrayLaws, slope: ArrayLaws | None) -> Bools:
    """Of each output and set (rows, outputs, sets), whether anything can be felt there up to the horizon, as waves are
    sent from window to window.
    """
    sizes, (nodes, sets) = tables.sizes, law["alpha"].shape
    every = {name: np.concatenate([law[name][None], *([slope[name]] if slope else [])]) for name in law}
    rows, rod = len(every["rod"]), every["rod"]
    body, on = tables.ints("is_body")[:, None] > 0, tables.ints("force_on")
    left, right = law["alpha"] != 0, law["beta"] != 0
    beside = np.where(left, rod[:, :-1], rod[:, 1:])
    stirred = left & right & (rod[:, :-1] != rod[:, 1:]) | body & (every["motion"] != beside)
    turned = np.any([every[name] != 0 for name in ("alpha", "beta", "rate")], axis=0)  # nodes that answer otherwise
    turned[0] = False
    lit = np.zeros((2, 3, sizes["panels"], rows, nodes + 2, sets), bool)
    pushed = np.zeros((rows, sizes["forces"] + 1, sets), bool)  # the last one: a node without a load
    found = np.zeros((rows, tables.outputs, sets), bool)
    begins, panels = tables.ints("event_window"), tables.ints("event_panel")
    for window in range(sizes["windows"]):
        now, before = window % 2, 1 - window % 2
        for panel in range(sizes["panels"]):
            for event in np.flatnonzero((begins == window) & (panels == panel)):
                load = every["load"][:, tables.ints("event_load")[event]]
                strength = every["strength"][:, tables.ints("event_strength")[event]]
                acts = (load[0] != 0) & (strength != 0) | (load != 0) & (strength[0] != 0)
                acts[0] = load[0] != 0
                pushed[:, tables.ints("event_force")[event]] |= acts
            lit[now, LOAD, panel, :, : sizes["forces"]] = pushed[:, :-1]
            a, b = lit[before, RIGHT, panel, :, :-2], lit[before, LEFT, panel, :, 2:]
            stirred = stirred | pushed[:, on] | body & (a & left | b & right)
            more = turned & (stirred | a | b)[0]
            stirred |= body & more
            lit[now, LEFT, panel, :, 1:-1] = stirred | more | b & right | a & (law["alpha"] != 1)
            lit[now, RIGHT, panel, :, 1:-1] = stirred | more | a & left | b & (law["beta"] != 1)
        found |= _heard(tables, every["gain"] != 0, lit, window)
    return found


def _heard(tables: ArrayTables, weighs: Bools, lit: Bools, window: int) -> Bools:
    """What of that outputs hear on a window."""
    found = np.zeros((len(weighs), tables.outputs, lit.shape[-1]), bool)
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
                    wave = lit[(window + back) % 2, way, panel, :, sender]
                    found[:, output] |= wave & weighs[0, heard] | wave[0] & weighs[:, heard]
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

"""Central differences in space and time at Courant number 1, where they are exact inside a rod.

At a node U_tt + ... takes the strains beside it from half a cell with its own inertia,

    (inertia + (alpha + beta) h/4) (U+ - 2 U + U-)/h^2 + damping (U+ - U-)/(2 h)
        = (beta/2) (U_right - U)/h - (alpha/2) (U - U_left)/h + loads,

which is of order 2, and for alpha = beta and no inertia the same as inside a rod.
"""

from __future__ import annotations

import numpy as np

from wavesym.rivals.line import stated
from wavesym.rivals.mesh import Mesh
from wavesym.rivals.problem import Array, Evaluate, Problem, Rival


def _prepare(problem: Problem, resolution: float) -> Evaluate:
    mesh = Mesh(problem, int(resolution))
    h, nodes = mesh.h, mesh.nodes
    mass = problem.inertia / h + (problem.alpha + problem.beta) / 4
    ahead, behind = mass + problem.damping / 2, mass - problem.damping / 2
    to_left, to_right = problem.alpha / 2 / ahead, problem.beta / 2 / ahead
    to_self = (2 * mass - (problem.alpha + problem.beta) / 2) / ahead
    to_past = behind / ahead
    # the velocity is the same on both sides of tau = 0
    first = 1 / (1 + np.where(mass > 0, to_past, 0.0))
    loads = mesh.loads * h / ahead
    told = np.flatnonzero(mass == 0)  # a ground that moves as it is told

    def evaluate(taus: Array) -> Array:
        seen = mesh.seen
        history = np.empty((mesh.steps + 2, len(seen)))
        history[0] = 0.0
        past, now = np.zeros(mesh.size), h * mesh.velocity
        now[nodes] = first * (2 * h * mesh.velocity[nodes] * to_past + loads[0])
        now[nodes][told] = mesh.moved[1, told]
        spread = np.zeros(mesh.size + 2)  # the field between two zeros
        for step in range(1, mesh.steps + 2):
            history[step] = now[seen]
            spread[1:-1] = now
            past, now = now, spread[:-2] + spread[2:] - past
            # `past` is by now the present, and what lies one step back went into `now`
            here = past[nodes]
            beside_left, beside_right = spread[:-2][nodes], spread[2:][nodes]
            before = beside_left + beside_right - now[nodes]
            load = loads[min(step, mesh.steps)]
            now[nodes] = to_left * beside_left + to_right * beside_right + to_self * here - to_past * before + load
            now[nodes][told] = mesh.moved[min(step + 1, mesh.steps), told]
        velocity = np.empty_like(history)
        velocity[0] = mesh.velocity[seen]
        velocity[1:-1] = (history[2:] - history[:-2]) / (2 * h)
        return mesh.outputs(history[:-1], velocity[:-1], taus)

    return evaluate


RIVAL = Rival("central differences", "NumPy", "cells per rod", (10, 20, 50, 100, 200, 500, 1000), stated, _prepare)

"""Scenes for tests of modes."""

from fractions import Fraction

import numpy as np

from wavesym.methods.elements import Elements
from wavesym.methods.network_problem import undamped_problem
from wavesym.scene import Scene, lower


def building(kappa, load=(), base="ground", system=(), **output):
    """The model of a building with these kappa."""
    table = {"type": "building", "m": len(kappa) - 1, "kappa": list(kappa), "base": base, **dict(system)}
    return lower(Scene(name="b", system=table, load=list(load), output={"until": 10, "velocity": [1], **output}))


def chain(parts, load=(), branch=(), system=(), **output):
    """The model of a chain that is written out."""
    table = {"type": "chain", "parts": list(parts), "branch": list(branch), **dict(system)}
    output = {"until": 10, **(output or {"velocity": ["0"]})}
    return lower(Scene(name="c", system=table, load=list(load), output=output))


def by_elements(model, resolution):
    """Consistent mass and stiffness of linear elements, about so many to a unit of delay: of all, then of what is free.

    The points come first.
    """
    problem = undamped_problem(model)
    cells = np.maximum(np.rint(problem.delay * resolution), 4).astype(int)
    elements = Elements(problem, cells)
    free = np.setdiff1d(np.arange(elements.size), problem.prescribed_points)
    mass, stiffness = (matrix.toarray() for matrix in (elements.mass, elements.stiffness))
    return mass[free], mass[np.ix_(free, free)], stiffness[np.ix_(free, free)]


def samples(count, seed=0, spacing="7/10"):
    """A load that is linear between random integers and begins and ends at 0."""
    drawn = np.random.default_rng(seed).integers(-9, 10, count)
    return {"spacing": spacing, "samples": [0, *drawn.tolist(), 0]}


def near(number, by="1e-9"):
    """A number hardly more."""
    return str(Fraction(number) * (1 + Fraction(by)))


NASTY = {
    "one storey": building(["1", "3/5"]),
    "nearly equal": building(["1", "1/4", near("1/4"), near("1/4", "-1e-12"), "1/4"]),
    "heavy": building(["1e-4"] * 6),
    "light": building(["1e4"] * 6),
    "far apart": building(["1", "1e-4", "1e4", "1e-4", "1"]),
    "a short rod": chain(
        ["fixed", {"rod": 1}, {"mass": 1}, {"rod": "1/1000"}, {"mass": 2}, {"rod": "1.3", "impedance": 3}, "free"]
    ),
    "springs": chain(
        [
            {"mass": 1, "spring": 2},
            {"spring": 5},
            {"mass": "1/2"},
            {"rod": 1, "spring": 3},
            {"mass": "1/3"},
            {"rod": "3/4", "speed": 2},
            "fixed",
        ],
        velocity=["0-"],
    ),
    "a branch with gears": chain(
        [{"mass": 1}, {"rod": 1}, {"mass": "1/2", "name": "gear"}, {"rod": "3/2"}, {"mass": 1}],
        branch=[{"from": "gear", "name": "side", "ratio": -2, "parts": [{"rod": "1/2"}, {"mass": "1/4"}]}],
    ),
    "a node at rest in the middle": chain(
        [
            {"motion": "acceleration"},
            {"rod": 1},
            {"mass": 1, "name": "g"},
            {"rod": "1/2", "impedance": 2},
            "fixed",
        ],
        branch=[{"from": "g", "name": "a", "ratio": -2, "parts": [{"rod": "1/3"}, {"mass": "1/2", "spring": 1}]}],
    ),
    "symmetric, nothing holds it": chain([{"mass": 1}, {"rod": 1}, {"mass": 2}, {"rod": 1}, {"mass": 1}]),
    "bare, nothing holds it": chain(["free", {"rod": 1}, {"rod": 1, "impedance": 2}, "free"]),
    "bare, held at both ends": chain(["fixed", {"rod": 1}, {"rod": 1}, {"rod": 1}, "fixed"]),
}

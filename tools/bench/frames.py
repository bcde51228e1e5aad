"""Damped frames whose storeys have numbers of their own under El Centro: modes of all of them, and how wrong they are.

Errors are those of the worst output of each frame, of its largest value at the samples, against proved modes to a
thirtieth of the tolerance.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np

from wavesym.numbers.arrays import Array
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.mode_sets.parameters import ModeParameters, mode_parameters, names_of
from wavesym.programs.modes.evaluator import modes
from wavesym.running.mode_sets import ModalSets
from wavesym.scene import Scene, lower

STOREYS = 10
HEAD = ("frames", "s of processor", "frames a second", "largest estimate", "error over estimate")
_SETS, _HELD = (1000, 10_000), 8
_FINER = 30


def frame(records: Path) -> Scene:
    """Ten storeys and 31 outputs, 5 % of damping in all modes, to 1e-3."""
    storey = {"height": "3.5 m", "stiffness": "678 MN/m", "column_mass": "10.871 t", "floor_mass": "350 t"}
    floors = list(range(1, STOREYS + 1))
    return Scene(
        name="frame",
        units={},
        system={"type": "building", "base": "ground", "damping": "1/20", "storey": [{**storey, "count": STOREYS}]},
        load=[{"record": str(records / "elcentro_1940_ns_peknold.at2"), "start": "0.02 s"}],
        output={
            "until": "31.18 s",
            "tolerance": "1e-3",
            "acceleration": floors,
            "force": [0],
            "drift": floors,
            "relative": floors,
        },
    )


def rows(records: Path) -> Iterator[Sequence[str]]:
    """In C, once it is compiled."""
    parameters = _parameters(records)
    engine = ModalSets(parameters)
    for sets in _SETS:
        given = _draw_sets(parameters, sets)
        engine.peaks(given[:1])
        begun = process_time()
        found = engine.peaks(given)
        taken = process_time() - begun
        over = _errors(parameters, given[:_HELD], engine) / found.estimate[:_HELD]
        yield f"{sets}", f"{taken:.2f}", f"{sets / taken:.0f}", f"{found.estimate.max():.1e}", f"{over.max():.2f}"


def _parameters(records: Path) -> ModeParameters:
    model = lower(frame(records))
    return mode_parameters(model, names_of(model), ())


def _draw_sets(parameters: ModeParameters, sets: int) -> Array:
    """Sets whose numbers are up to a third larger or smaller than the frame's own."""
    own = np.array([float(value) for field in parameters.fields for value in field.values])
    return np.asarray(own * np.exp(np.random.default_rng(28).uniform(-0.3, 0.3, (sets, len(own)))))


def _errors(parameters: ModeParameters, given: Array, engine: ModalSets) -> Array:
    """Of each set the worst error."""
    model = parameters.model
    taus = np.linspace(0.0, model.horizon(), 3119)
    values = engine.values(given, taus).values[:, 0]
    worst = []
    for row, found in zip(given, values, strict=True):
        exact = replace(parameters.exact(row), tolerance=model.tolerance / _FINER)
        true = modes(exact, DOUBLE).scheme.evaluate(taus)
        worst.append(float((np.abs(found - true).max(axis=1) / np.abs(true).max(axis=1)).max()))
    return np.array(worst)

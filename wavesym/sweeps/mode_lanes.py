"""Columns of a sweep that are numbers of modes times a factor: known without making the scene of each case.

Stiffnesses and masses of storeys and of parts of a chain, a damping ratio, and the scale of a record or the amplitude
of a shape: nothing else of a scene depends on them. Which numbers a column is, and with what factor, is seen from two
scenes with other values of it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from wavesym.errors import WavesymError
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.programs.mode_sets.parameters import ModeParameters, mode_parameters, names_of
from wavesym.programs.runtime.network import RuntimeField
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import amplitudes
from wavesym.scene.paths import replace_at_path
from wavesym.sweeps.batches import Place
from wavesym.sweeps.dimension import Column
from wavesym.sweeps.plan import SweepPlan

_PATHS = re.compile(
    r"system\.(damping|storey\[\d+\]\.(stiffness|column_mass|floor_mass)|(branch\[\d+\]\.)?parts\[\d+\]\.(mass|spring))"
    r"|load\[\d+\]\.(scale|amplitude)"
)
_PROBES = (Fraction(5, 4), Fraction(3, 2))  # times the first value of a column
_SAME = 1e-13


@dataclass(frozen=True)
class ModeLanes:
    """The numbers of modes of a sweep: those of the first case, and the `places` and `factors` of each column."""

    own: Array
    places: dict[str, Any]
    factors: dict[str, Array]

    def rows(self, plan: SweepPlan, places: Sequence[Place]) -> Array:
        """The numbers of cases, a row for each."""
        rows = np.tile(self.own, (len(places), 1))
        for axis, dimension in enumerate(plan.dimensions):
            chosen = [place[axis] for place in places]
            for column in dimension.columns:
                values = np.array(column.coordinate)[chosen]
                rows[:, self.places[column.path]] = values[:, None] * self.factors[column.path]
        return rows


def mode_lanes(plan: SweepPlan, first: ModeParameters, bare: SweepPlan) -> ModeLanes | None:
    """Those of a sweep whose first case has these; `bare` is the sweep with next to no samples in its loads."""
    columns = [column for dimension in plan.dimensions for column in dimension.columns]
    if not all(_PATHS.fullmatch(column.path) and isinstance(column.coordinate[0], float) for column in columns):
        return None
    own = own_numbers(first.fields)
    places, factors, taken = dict[str, Any](), dict[str, Array](), set[int]()
    for column in columns:
        try:
            sizes, *probes = [_probe(bare, column, times) for times in (Fraction(1), *_PROBES)]
        except WavesymError:
            return None
        ratios = [probe / np.where(sizes == 0, 1.0, sizes) for probe in probes]
        (varied,) = np.nonzero(np.abs(ratios[0] - 1) > _SAME)
        expected = np.ones(len(own))
        for ratio, times in zip(ratios, _PROBES, strict=True):
            expected[varied] = float(times)
            if np.any(np.abs(np.where(sizes == 0, 1.0, ratio) - expected) > _SAME):
                return None
        if not len(varied) or taken & set(varied.tolist()):
            return None
        taken |= set(varied.tolist())
        places[column.path], factors[column.path] = varied, own[varied] / float(column.coordinate[0])
    return ModeLanes(own, places, factors)


def own_numbers(fields: Sequence[RuntimeField]) -> Array:
    """All numbers of fields, in the units of the scene."""
    return np.array([float(value) for field in fields for value in field.values])


def structure_parameters(scene: Scene) -> ModeParameters:
    """All numbers of a scene's modes, the factors of its loads last."""
    scene = scene.in_lines
    model = lower(scene)
    names = (*names_of(model), *(["load"] if model.loads else []))
    return mode_parameters(model, names, amplitudes(scene))


def _sizes(parameters: ModeParameters, column: Column) -> Array:
    """The numbers, for a column of a load times the first change of each load: the factor of samples is always 1."""
    sizes = own_numbers(parameters.fields)
    if column.path.startswith("load"):
        weights = [nearest(load.changes[0].weight) if load.changes else 0.0 for load in parameters.amplitudes]
        sizes[len(sizes) - len(weights) :] *= weights
    return sizes


def _probe(plan: SweepPlan, column: Column, times: Fraction) -> Array:
    """The sizes of the first case's numbers with another value of a column."""
    value = times * Fraction(column.coordinate[0])
    text = f"{value} {column.unit}" if column.unit else str(value)
    return _sizes(structure_parameters(Scene(**replace_at_path(plan.fields, column.path, text))), column)

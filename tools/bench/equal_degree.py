"""The generated C of a scene against that of another at equal degree: what rods that differ, springs and events cost.

Nothing but the tables differs, so that what is left is how many samples there are on a piece.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from flint import fmpq

from tools.bench.harness import SAMPLES, many
from wavesym.lab.timing import medians
from wavesym.mechanics.model import Model
from wavesym.programs.choice import choose
from wavesym.programs.making import program
from wavesym.programs.piece_grid import Pieces
from wavesym.scene import Scene, lower
from wavesym.targets.files import sources

_DIGITS = range(4, 15)


@dataclass(frozen=True)
class FittedPieces:
    """A scene's pieces at some tolerance, whatever its own is."""

    scene: Scene
    model: Model
    form: Pieces

    @cached_property
    def degree(self) -> float:
        """Of the piece that a tau is on, in the mean over all tau and outputs."""
        total = 0.0
        for grid in self.form.grids:
            for (start, end), polynomials in zip(pairwise(grid.starts), grid.powers, strict=True):
                total += (end - start) * sum(len(powers) - 1 for powers in polynomials)
        return total / self.form.tau_max / len(self.form.outputs)

    @property
    def count(self) -> int:
        """How many pieces an output has, in the mean."""
        return sum(len(grid.centres) * len(grid.outputs) for grid in self.form.grids) // len(self.form.outputs)

    @cached_property
    def c(self) -> dict[str, str]:
        """The C by file name."""
        return sources(program(self.model, self.form), "c")


def fit_pieces(scene: Scene, tolerance: fmpq) -> FittedPieces:
    """The pieces of a scene at a tolerance."""
    model = lower(scene).tolerating(tolerance)
    form = choose(model, "pieces").evaluator
    assert isinstance(form, Pieces)
    return FittedPieces(scene, model, form)


def at_degree(scene: Scene, degree: float) -> FittedPieces:
    """The pieces of a scene at that tolerance of 1e-4, 1e-5, ... 1e-14 at which their degree is nearest."""
    return min((fit_pieces(scene, fmpq(1, 10**digits)) for digits in _DIGITS), key=lambda one: abs(one.degree - degree))


def ratios(one: FittedPieces, other: FittedPieces, flags: tuple[str, ...]) -> Iterator[float]:
    """Time a value over time a value of the `other`: with as many samples, and with as many on a piece."""
    per_piece = SAMPLES * one.count // other.count
    calls = [
        many(each.scene, each.c, flags, samples=samples)
        for each, samples in ((other, SAMPLES), (one, SAMPLES), (one, per_piece))
    ]
    base, same, denser = medians(calls)
    outputs = len(one.scene.outputs) / len(other.scene.outputs)
    yield same / base / outputs
    yield denser / base / outputs * SAMPLES / per_piece

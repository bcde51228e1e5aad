"""Pieces as a form: polynomials on grids of pieces, how large they are, what they cost, and their program."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from flint import fmpq

from wavesym.numbers.reals import Real
from wavesym.programs.form import Form
from wavesym.programs.program import ProgramOutput
from wavesym.programs.tables import Tables, firsts

# The numbers from 0 on that C has for the widest vectors (templates/c/pieces/pieces.c).
_OFFSETS = 16
# Fast is what takes little time for three calls of `sample`, of so many samples each.
_CALLS = (300, 1000, 10_000)
# In multiplications of vectors, measured: what begins on a piece, and what a vector takes besides.
_PIECE, _VECTOR, _LANES = 22, 2, 8


@dataclass(frozen=True)
class PieceGrid:
    """Pieces that some outputs share: piece p is for starts[p] <= tau < starts[p + 1].

    `powers[p][j]` are the coefficients of output `outputs[j]` in w = tau - centres[p], lowest first; as many for each
    output, so that one loop is for all of them. `first[b]` is the piece at tau = b / scale; from there at most `steps`
    more are to be tried.
    """

    outputs: tuple[int, ...]
    starts: tuple[float, ...]
    centres: tuple[float, ...]
    powers: tuple[tuple[tuple[float, ...], ...], ...]
    scale: float
    first: tuple[int, ...]
    steps: int


@dataclass(frozen=True)
class Pieces(Form):
    """Polynomial pieces for the outputs of a scene on [0, tau_max]."""

    KERNEL = "pieces"

    outputs: tuple[ProgramOutput, ...]
    tau_max: float
    real: Real
    grids: tuple[PieceGrid, ...]
    per_unit: int

    @cached_property
    def degrees(self) -> tuple[int, int]:
        """The lowest and the highest degree of a piece."""
        degrees = [len(powers) - 1 for grid in self.grids for piece in grid.powers for powers in piece]
        return min(degrees), max(degrees)

    @cached_property
    def bytes(self) -> int:
        """The size of the tables in C."""
        numbers, indices = _OFFSETS, 0
        for grid in self.grids:
            numbers += len(grid.starts) + len(grid.centres) + sum(len(p) for piece in grid.powers for p in piece)
            indices += len(grid.first) + len(grid.powers) + 1
        return numbers * self.real.bytes + indices * 4

    @cached_property
    def work(self) -> float:
        """About how many operations a value takes: the mean degree, and finding the place."""
        degrees = [len(powers) - 1 for grid in self.grids for piece in grid.powers for powers in piece]
        return 4 + sum(degrees) / len(degrees)

    @cached_property
    def cost(self) -> float:
        """About how long three calls of `sample` take, of few samples, more and many."""
        return sum(self._sampling_cost(samples) for samples in _CALLS)

    def _sampling_cost(self, samples: int) -> float:
        total = 0.0
        for grid in self.grids:
            for (start, end), polynomials in zip(pairwise(grid.starts), grid.powers, strict=True):
                on_it = samples * (end - start) / self.tau_max
                values = len(polynomials) * (len(polynomials[0]) - 1)
                total += min(1.0, on_it) * (_PIECE + math.ceil(on_it / _LANES) * (_VECTOR + values))
        return total

    @property
    def summary(self) -> str:
        """What it is, in a few words."""
        low, high = self.degrees
        return f"pieces, degree {low}..{high}, {-(-self.bytes // 1024)} KiB, bound {self.error_bound:g}"

    def shortfall(self, tolerance: fmpq) -> str:
        """Why it does not meet a tolerance."""
        return f"pieces: rounding leaves a bound of {self.worst.bound:g} for {self.worst.name}"

    @cached_property
    def check_points(self) -> list[float]:
        """For the self-test: the start of every piece, the last number before it, and one in the middle."""
        points = {0.0, self.tau_max}
        for grid in self.grids:
            for start, end, centre in zip(grid.starts, grid.starts[1:], grid.centres, strict=False):
                points |= {start, centre, self.real.next_after(end, 0.0)}
        return sorted(points)

    @property
    def tables(self) -> Tables:
        """Of grid g its outputs first_member[g] ..., and pieces; at first_piece[g] + g their starts and the last end.

        The polynomials of piece p of all grids start at first_power[p] in `coefficient`: highest power first, of each
        power those of all members. To find tau's piece: from part[first_part[g] + int(tau * scale[g])] at most `steps`
        on.
        """
        grids = self.grids
        pieces = [piece for grid in grids for piece in grid.powers]
        return {
            "first_member": firsts(len(grid.outputs) for grid in grids),
            "member": tuple(k for grid in grids for k in grid.outputs),
            "first_piece": firsts(len(grid.centres) for grid in grids),
            "start": tuple(start for grid in grids for start in grid.starts),
            "centre": tuple(centre for grid in grids for centre in grid.centres),
            "first_part": firsts(len(grid.first) for grid in grids),
            "scale": tuple(grid.scale for grid in grids),
            "part": tuple(piece for grid in grids for piece in grid.first),
            "first_power": firsts(sum(map(len, piece)) for piece in pieces),
            "coefficient": tuple(
                c for piece in pieces for power in reversed([*zip(*piece, strict=True)]) for c in power
            ),
        }

    @property
    def constants(self) -> dict[str, float]:
        """How many grids, how many pieces are tried at most, and the numbers up to which whole ones are exact."""
        return {
            "grids": len(self.grids),
            "steps": max(grid.steps for grid in self.grids),
            "exact": self.real.nearest(1 / self.real.roundoff),
        }

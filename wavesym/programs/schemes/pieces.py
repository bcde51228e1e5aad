"""Pieces in NumPy."""

import numpy as np

from wavesym.numbers.arrays import Array
from wavesym.programs.schemes.scheme import Scheme


class PiecesScheme(Scheme):
    """Pieces: for start[p] <= tau < start[p + 1] an output is one polynomial in w = tau - centre[p].

    Outputs that may jump or bend at the same times share a grid of pieces.
    """

    def _read(self, tables: dict[str, tuple[float, ...]], constants: dict[str, float]) -> None:
        real = self.real
        member, first_member, first_piece, first_power = (
            [int(place) for place in tables[name]] for name in ("member", "first_member", "first_piece", "first_power")
        )
        start, centre, coefficient = (np.array(tables[name], real) for name in ("start", "centre", "coefficient"))
        self.outputs = len(member)
        self._grids = []
        for g in range(len(first_piece) - 1):
            members = member[first_member[g] : first_member[g + 1]]
            low, high = first_piece[g], first_piece[g + 1]
            ends = first_power[low : high + 1]
            # (pieces, degree + 1, outputs), lowest power first, 0 above the degree of each piece
            powers = np.zeros((high - low, int(np.diff(ends).max()) // len(members), len(members)), real)
            for rows, before, after in zip(powers, ends, ends[1:], strict=False):
                of_piece = coefficient[before:after].reshape(-1, len(members))
                rows[: len(of_piece)] = of_piece[::-1]
            self._grids.append((members, start[low + g : high + g + 1], centre[low:high], powers))

    def _values(self, tau: Array) -> Array:
        out = np.empty((self.outputs, tau.size), self.real)
        for outputs, starts, centres, powers in self._grids:
            out[outputs] = self._on_pieces(tau, starts, centres, powers)
        return out

    def _on_pieces(self, tau: Array, starts: Array, centres: Array, powers: Array) -> Array:
        """Outputs at sorted tau inside the grid: (outputs, tau.size). All samples of a piece are one matrix product.

        Where samples lie unevenly, pieces that have about as many, from half to all of a power of 2, go together.
        """
        edges = np.searchsorted(tau, starts)
        counts = np.diff(edges)
        pieces, _, outputs = powers.shape
        even = pieces * counts.max() <= 2 * tau.size + 64
        sizes = np.ones(pieces, int) if even else np.frexp(counts)[1]
        out = np.empty((outputs, tau.size), self.real)
        for size in sorted({*sizes.tolist()} - {0}):
            some = np.flatnonzero(sizes == size)
            along = np.arange(counts[some].max())
            places = np.minimum(edges[some, None] + along, tau.size - 1)
            values = self._product(tau[places] - centres[some, None], powers[some])
            there = along < counts[some, None]
            if even:
                return values[there].T
            out[:, places[there]] = values[there].T
        return out

    def _product(self, w: Array, powers: Array) -> Array:
        """The polynomials `powers` (pieces, degree + 1, outputs) at w (pieces, samples): (pieces, samples, outputs)."""
        size = powers.shape[1]
        basis = np.empty((*w.shape, size - 1), self.real)
        for k in range(size - 1):
            np.multiply(basis[..., k - 1] if k else 1, w, out=basis[..., k])
        return basis @ powers[:, 1:] + powers[:, :1]

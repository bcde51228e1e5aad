"""What is watched: a quantity at a place on a rod, in its two waves."""

from __future__ import annotations

from dataclasses import dataclass

from flint import fmpq

_ONE = fmpq(1)


@dataclass(frozen=True)
class Probe:
    """An output: `quantity` on rod `rod`, `place` rod lengths from its left node (0 <= place <= 1).

    The right-going wave has come so far from that node, the left-going one 1 - place from the other.
    A `point` that no rod shows is watched itself (`rod` is 0 then). What users get is `factor` times the dimensionless
    value, in `unit`.
    """

    name: str
    quantity: str
    rod: int
    place: fmpq
    point: int | None = None
    factor: fmpq = _ONE
    unit: str = ""

    @property
    def x(self) -> fmpq:
        """How far it is from the left end of the chain, in rod lengths."""
        return self.rod - 1 + self.place

    @property
    def weights(self) -> tuple[int, int]:
        """What the right-going and the left-going wave, each as a velocity, count in dU/dx or dU/dtau."""
        return (-1, 1) if self.quantity == "strain" else (1, 1)

    @property
    def order(self) -> int:
        """0 for a velocity or a strain, -1 for the integral of a velocity: a displacement."""
        return -1 if self.quantity == "displacement" else 0

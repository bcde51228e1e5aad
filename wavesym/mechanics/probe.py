"""What is watched: a quantity at a place on a rod, or of a point."""

from __future__ import annotations

from dataclasses import dataclass

from flint import fmpq

from wavesym.mechanics.quantities import QUANTITIES

_ONE = fmpq(1)


def with_unit(name: str, unit: str) -> str:
    """The name of a quantity, with its unit in brackets where it has one."""
    return f"{name} [{unit}]" if unit else name


@dataclass(frozen=True)
class Probe:
    """An output: `quantity` on rod `rod`, `place` rod lengths from its left node (0 <= place <= 1).

    A `point` that no rod shows is watched itself (`rod` is 0 then). A drift is that of the whole rod. What users get is
    `factor` times the dimensionless value, in `unit`. `title` is its name for people. gauge.py has what it is a sum of.
    An `incidental` one is computed beside what the scene wants: its error need not meet the scene's tolerance.
    """

    name: str
    quantity: str
    rod: int
    place: fmpq
    point: int | None = None
    factor: fmpq = _ONE
    unit: str = ""
    title: str = ""
    incidental: bool = False

    @property
    def computed_quantity(self) -> str:
        """What it is `factor` times of: a stress is so many times a force."""
        return QUANTITIES[self.quantity].multiple_of or self.quantity

    @property
    def label(self) -> str:
        """What people are shown: its title, or its name."""
        return self.title or self.name

    @property
    def heading(self) -> str:
        """Its name, with its unit in brackets where it has one."""
        return with_unit(self.name, self.unit)

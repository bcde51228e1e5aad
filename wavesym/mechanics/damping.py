"""Damping of the modes of a chain, as ratios to critical damping."""

from __future__ import annotations

from dataclasses import dataclass

from flint import fmpq

from wavesym.numbers.doubles import nearest


@dataclass(frozen=True)
class Damping:
    """Of mode n = 1, 2, ... with strain `ratios[n - 1]`, the last one for all higher modes.

    Or, with `modes` = (i, j), that of Rayleigh: (a/w + b w)/2 at frequency w, such that modes i and j have `ratios[0]`.
    """

    ratios: tuple[fmpq, ...]
    modes: tuple[int, int] | None = None

    @property
    def acts(self) -> bool:
        """Whether any mode is damped: then all of the chain acts on all of it at once, and there is no light cone."""
        return any(self.ratios)

    @property
    def in_words(self) -> str:
        """For people: in per cent of what is critical."""
        ratios = ", ".join(f"{100 * nearest(ratio):g} %" for ratio in self.ratios)
        if self.modes:
            return f"{ratios} of critical in modes {self.modes[0]} and {self.modes[1]}, Rayleigh"
        return f"{ratios} of critical in every mode" if len(self.ratios) == 1 else f"{ratios} of critical, mode by mode"

    @property
    def description(self) -> str:
        """In a line."""
        ratios = ", ".join(map(str, self.ratios))
        return f"{ratios} in modes {self.modes[0]} and {self.modes[1]}, Rayleigh" if self.modes else ratios

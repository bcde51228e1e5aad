"""Time as a picture tells it: in tau, or in the unit of a physical scene."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest


@dataclass(frozen=True)
class Timescale:
    """One tau is `per_tau` of the `unit`, which is empty for tau itself."""

    per_tau: float = 1.0
    unit: str = ""

    @property
    def title(self) -> str:
        """Of an axis."""
        return f"t in {self.unit}" if self.unit else "tau = c t / l (dimensionless)"

    @property
    def symbol(self) -> str:
        """What time is called in a sentence."""
        return "t" if self.unit else "tau"

    def format(self, tau: float) -> str:
        """A tau as a sentence writes it: `tau = 8.902`, `t = 2.04 s`."""
        return f"{self.symbol} = {self.time_text(tau)}"

    def time_text(self, tau: float) -> str:
        """The same without its name."""
        return f"{tau * self.per_tau:.4g}{self.unit and ' '}{self.unit}"


def timescale(model: Model) -> Timescale:
    """That of a model's clock."""
    clock = model.clock
    return Timescale(nearest(clock.per_tau), clock.unit) if clock else Timescale()

"""What happens at a contact, and when: it opens, or it closes; what rubs slips, or sticks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from flint import arb

from wavesym.numbers.doubles import midpoint


class KnownInstant:
    """An instant as far as it is known."""

    tau: arb

    @property
    def double(self) -> float:
        """tau rounded to double."""
        return midpoint(self.tau)

    @property
    def digits(self) -> str:
        """tau with 20 significant digits."""
        return str(self.tau.str(20, radius=False))


@dataclass(frozen=True)
class ContactEvent(KnownInstant):
    """The contact at a place (as the scene calls it) opens or closes at `tau`, a ball; what rubs there slips or sticks.

    A contact that is closed from the start is no event.
    """

    x: str
    kind: Literal["opens", "closes", "slips", "sticks"]
    tau: arb

    @property
    def subject(self) -> str:
        """What it happens to."""
        return f"friction at x = {self.x}" if self.kind in ("slips", "sticks") else f"contact at x = {self.x}"

"""What happens at a link whose law has a corner, and when."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from flint import arb

from wavesym.numbers.doubles import midpoint

Happening = Literal["opens", "closes", "slips", "sticks", "engages", "releases", "yields", "holds"]
LAW_OF: dict[str, str] = {"opens": "contact", "closes": "contact", "slips": "friction", "sticks": "friction"}
LAW_OF |= dict.fromkeys(("engages", "releases", "yields", "holds"), "spring")
"""The law whose corner it is that something happens at."""


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

    A spring that acts on one side engages and releases; one that yields does so until it holds again. What is closed,
    engaged, held or stuck from the start is no event: the first is that it leaves that, at 0 where it does so at once.
    `link` is its number in the network.
    """

    x: str
    kind: Happening
    tau: arb
    link: int = -1

    @property
    def subject(self) -> str:
        """What it happens to."""
        return f"{LAW_OF[self.kind]} at x = {self.x}"

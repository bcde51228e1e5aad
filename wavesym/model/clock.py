"""Time as users of a physical scene read it."""

from __future__ import annotations

from dataclasses import dataclass

from flint import fmpq


@dataclass(frozen=True)
class Clock:
    """One tau is `seconds` long, and `per_tau` of the `unit` that results are told in."""

    seconds: fmpq
    per_tau: fmpq
    unit: str = "s"

"""NAME.h as every evaluator has it."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.emission.description import Description
from wavesym.emission.rendering import render


@dataclass(frozen=True)
class Header:
    """templates/c/header.h.j2."""

    scene: Description


def common_header(scene: Description) -> str:
    """The interface that all evaluators share."""
    return render("c/header.h.j2", Header(scene))

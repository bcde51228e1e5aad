"""NAME.h as every evaluator has it."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.rendering import render
from wavesym.targets.description import Description


@dataclass(frozen=True)
class Header:
    """templates/c/header.h.j2."""

    scene: Description


def common_header(scene: Description) -> str:
    """The interface that all evaluators share."""
    return render("c/header.h.j2", Header(scene))

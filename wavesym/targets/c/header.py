"""NAME.h: what every program declares."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.rendering import render
from wavesym.targets.description import Description


@dataclass(frozen=True)
class CHeader:
    """templates/c/header.h.j2; `more` is what a kind of program declares besides.

    A stream has no functions of tau; its bound holds `under` certain loads. What takes parameters is not `bounded`.
    """

    scene: Description
    more: str
    under: str
    bounded: bool


def header(scene: Description, more: str = "", *, under: str = "", bounded: bool = True) -> str:
    """The interface that all programs share, and more."""
    return render("c/header.h.j2", CHeader(scene, more, under, bounded))

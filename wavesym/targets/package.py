"""What makes a package of generated C: a CMake project that builds, tests and installs it, and a pkg-config file."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.programs.program import Program
from wavesym.rendering import render
from wavesym.targets.description import Description

_MATH = frozenset({"closed", "mode_sets"})
"""Kernels that call functions of <math.h>."""


@dataclass(frozen=True)
class CMakeProject:
    """templates/package/CMakeLists.txt.j2; `math` where functions of <math.h> are called."""

    scene: Description
    math: bool
    tested: bool


@dataclass(frozen=True)
class PkgConfig:
    """templates/package/pkgconfig.pc.in.j2; `about` is the system in a line."""

    scene: Description
    about: str
    math: bool


def package(scene: Description, program: Program) -> dict[str, str]:
    """Text by file name: CMakeLists.txt and NAME.pc.in, which CMake fills with the places of an installation."""
    math = program.kernel in _MATH
    project = CMakeProject(scene, math, tested=program.reference is not None)
    return {
        "CMakeLists.txt": render("package/CMakeLists.txt.j2", project),
        f"{scene.name}.pc.in": render("package/pkgconfig.pc.in.j2", PkgConfig(scene, scene.model[0], math)),
    }

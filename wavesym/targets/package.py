"""What makes a package of generated C: a CMake project that builds, tests and installs it, and a pkg-config file."""

from __future__ import annotations

from wavesym.programs.program import Program
from wavesym.rendering import render
from wavesym.targets.description import Description

_MATH = frozenset({"closed", "mode_sets"})
"""Kernels that call functions of <math.h>."""


def package(scene: Description, program: Program) -> dict[str, str]:
    """Text by file name: CMakeLists.txt and NAME.pc.in, which CMake fills with the places of an installation."""
    math = program.kernel in _MATH
    tested = program.reference is not None
    return {
        "CMakeLists.txt": render("package/CMakeLists.txt.j2", scene=scene, math=math, tested=tested),
        f"{scene.name}.pc.in": render("package/pkgconfig.pc.in.j2", scene=scene, about=scene.model[0], math=math),
    }

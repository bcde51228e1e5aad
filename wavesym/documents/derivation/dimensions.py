"""What the quantities of section 2 are in each system, and how section 4 makes them dimensionless.

With x in rods of length l, tau = c_f t / l and U in units of U_0, (2.4) at a body of inertia B, divided by
B c_f^2 U_0 / l^2, has the factor A l / (c_f^2 B) at the strain of a rod of stiffness A.
"""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Expr, IndexedBase, Symbol, cancel

from wavesym.derivation.delay import INDEX, SYMBOLS
from wavesym.mechanics.node import System
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE, DRIVE_RAMPS

LENGTH, SPEED, UNIT = Symbol("l"), Symbol("c_f"), Symbol("U_0")
_DENSITY, _SHEAR, _YOUNG = Symbol("rho"), Symbol("G"), Symbol("E")
_MASS, _POLAR = IndexedBase("M"), IndexedBase("I")


@dataclass(frozen=True)
class Dimensions:
    """A system's column of Table 1 with the A_i and B_i of (2.4); `inertia` is that of the body that kappa_i is of.

    `load` is the unit of the load, with its letter; `legend` says what letters are, `note` how loads act, both with
    their mathematics between dollars.
    """

    displacement: str
    speed_squared: Expr
    stiffness: Expr
    inertia: Expr
    legend: tuple[tuple[Expr, str], ...]
    note: str
    load: tuple[Expr, Expr] | None = None

    @property
    def kappa(self) -> Expr:
        """kappa_i = A_i l / (c_f^2 B_i)."""
        return cancel(self.stiffness * LENGTH / (self.speed_squared * self.inertia))


def _storeys(note: str) -> Dimensions:
    columns, section, correction, ground = Symbol("n"), Symbol("A"), Symbol("k'"), Symbol("a_0")
    return Dimensions(
        displacement="y",
        speed_squared=correction * _SHEAR / _DENSITY,
        stiffness=columns * section * correction * _SHEAR,
        inertia=_MASS[INDEX],
        legend=(
            (columns, "number of columns between two floors"),
            (section, "section of a column"),
            (correction, "its shear coefficient"),
            (_SHEAR, "shear modulus"),
            (_DENSITY, "density"),
            (_MASS[INDEX], "mass of floor $i$; 0 is the foundation, $m$ the roof"),
            (ground, "unit of the ground's acceleration"),
        ),
        note=f"The ground's acceleration is a step $a$ and a ramp $b$ from the start on: a piece of (3.2). {note}",
        load=(ground, SPEED**2 * UNIT / LENGTH**2),
    )


def _shafts(note: str) -> Dimensions:
    return Dimensions(
        displacement="theta",
        speed_squared=_SHEAR / _DENSITY,
        stiffness=_SHEAR * _POLAR[INDEX],
        inertia=SYMBOLS.inertia[INDEX],
        legend=(
            (_SHEAR, "shear modulus"),
            (_DENSITY, "density"),
            (_POLAR[INDEX], "polar moment of the section of shaft $i$"),
            (SYMBOLS.inertia[INDEX], "inertia of disc $i$, at $x = i - 1$"),
            (Symbol("S_0"), "unit of the moments"),
        ),
        note=f"{note} the last one counts against positive rotation.",
        load=(Symbol("S_0"), _SHEAR * _POLAR[1] * UNIT / LENGTH),
    )


_DIMENSIONS = {
    COLLISION: Dimensions(
        displacement="u",
        speed_squared=_YOUNG / _DENSITY,
        stiffness=_YOUNG * Symbol("F"),
        inertia=_MASS[INDEX],
        legend=(
            (_YOUNG, "Young's modulus"),
            (_DENSITY, "density"),
            (Symbol("F"), "section of a rod"),
            (_MASS[INDEX], "mass of the body at $x = i$, for odd $i$"),
            (SYMBOLS.velocity[INDEX], "its velocity before the collision, and that of the rods fixed to it"),
        ),
        note="Rods touch at even $x$. There is no load.",
    ),
    DRIVE: _shafts("Moments are steps from the start on;"),
    DRIVE_RAMPS: _shafts("Moments are steps $M$ and ramps $R$ from the start on;"),
    BUILDING_FORCE: _storeys("At the base it loads the columns with the inertia of the foundation, as in (4.5)."),
    BUILDING_GROUND: _storeys("At the base the columns have the velocity of the ground, in place of (2.4)."),
}


def dimensions(system: System) -> Dimensions | None:
    """The dimensional quantities of a system; None where only its dimensionless form is known."""
    return _DIMENSIONS.get(system)

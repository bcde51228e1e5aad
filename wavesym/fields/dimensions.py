"""The dimensions of quantities in a scene, by name: what they are made of, and an example for messages.

Powers are those of length, mass, time and angle. The radian has no dimension in SI, but it tells a frequency in hertz
from an angular velocity; where `angle` is None, a unit may say "per radian" or leave it out.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple


class Dimension(NamedTuple):
    """The powers of metre, kilogram, second and radian, and an example of a quantity."""

    length: int
    mass: int
    time: int
    example: str
    angle: int | None = 0


DIMENSIONS: Mapping[str, Dimension] = {
    "length": Dimension(1, 0, 0, "3.5 m"),
    "time": Dimension(0, 0, 1, "20 ms"),
    "frequency": Dimension(0, 0, -1, "2 Hz"),
    "mass": Dimension(0, 1, 0, "350 t"),
    "velocity": Dimension(1, 0, -1, "5 m/s"),
    "acceleration": Dimension(1, 0, -2, "0.3 g"),
    "jerk": Dimension(1, 0, -3, "2 m/s^3"),
    "force": Dimension(1, 1, -2, "12 kN"),
    "force rate": Dimension(1, 1, -3, "5 kN/s"),
    "stiffness": Dimension(0, 1, -2, "678 MN/m"),
    "damping constant": Dimension(0, 1, -1, "40 kN*s/m"),
    "area": Dimension(2, 0, 0, "8 cm^2"),
    "second moment of area": Dimension(4, 0, 0, "57680 cm^4"),
    "modulus": Dimension(-1, 1, -2, "210 GPa"),
    "stress": Dimension(-1, 1, -2, "200 MPa"),
    "density": Dimension(-3, 1, 0, "7850 kg/m^3"),
    "angle": Dimension(0, 0, 0, "2 deg", 1),
    "angular velocity": Dimension(0, 0, -1, "1500 rpm", 1),
    "angular acceleration": Dimension(0, 0, -2, "3 rad/s^2", 1),
    "angular jerk": Dimension(0, 0, -3, "3 rad/s^3", 1),
    "rate of twist": Dimension(-1, 0, 0, "2 deg/m", 1),
    "moment": Dimension(2, 1, -2, "15 kN*m"),
    "moment rate": Dimension(2, 1, -3, "15 kN*m/s"),
    "moment of inertia": Dimension(2, 1, 0, "12 kg*m^2"),
    "rotational stiffness": Dimension(2, 1, -2, "80 kN*m/rad", None),
    "rotational damping constant": Dimension(2, 1, -1, "3 N*m*s/rad", None),
}


def fits(powers: Mapping[str, int], dimension: Dimension) -> bool:
    """Whether what has these powers of m, kg, s and rad is of a dimension."""
    length, mass, time, angle = (powers.get(base, 0) for base in ("m", "kg", "s", "rad"))
    if (length, mass, time) != dimension[:3]:
        return False
    return angle in (0, -1) if dimension.angle is None else angle == dimension.angle


def dimension_name(powers: Mapping[str, int]) -> str:
    """What has these powers, as a message names it: "a force", or its units."""
    for name, dimension in DIMENSIONS.items():
        if fits(powers, dimension):
            return with_article(name)
    found = [(base, powers.get(base, 0)) for base in ("m", "kg", "s", "rad")]
    return "*".join(base if power == 1 else f"{base}^{power}" for base, power in found if power) or "a plain number"


def with_article(name: str) -> str:
    """ "a force", "an area"."""
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"

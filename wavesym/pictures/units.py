"""Units as people write them."""

from __future__ import annotations

import re

RAISED = str.maketrans("-0123456789", "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079")


def unit_text(unit: str) -> str:
    """A unit with raised powers and dots.

    >>> unit_text("kg*m^2/s^2")
    'kg\u00b7m\u00b2/s\u00b2'
    """
    return re.sub(r"(?:\^|\*\*)(-?\d+)", lambda power: power[1].translate(RAISED), unit).replace("*", "\u00b7")

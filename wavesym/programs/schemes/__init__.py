"""The arithmetic of programs in NumPy: run here on a program's tables, and written into generated Python as it stands.

So the files of this folder need nothing but NumPy, and to know what an `Array` is. What stands above their first class
is left out in what is generated. Each scheme is made from tables and single numbers, of which it reads what it needs,
tau_max, and the type of all values: np.float64 or np.float32.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

import numpy as np

from wavesym.programs.schemes.closed_form import ClosedScheme
from wavesym.programs.schemes.hats import HatScheme
from wavesym.programs.schemes.march import MarchScheme
from wavesym.programs.schemes.march_joints import MarchNumbers
from wavesym.programs.schemes.modes import ModesScheme
from wavesym.programs.schemes.pieces import PiecesScheme
from wavesym.programs.schemes.scheme import Scheme

SCHEMES: dict[str, type[Scheme]] = {
    "closed": ClosedScheme,
    "pieces": PiecesScheme,
    "march": MarchScheme,
    "hats": HatScheme,
    "modes": ModesScheme,
}

PARTS: dict[str, tuple[type, ...]] = {
    "march": (MarchNumbers,),
    "hats": (MarchNumbers, MarchScheme),
}
"""A class of each other file that a scheme is made of, in order, below `Scheme`."""

Value = TypeVar("Value")


class _Noting(dict[str, Value]):
    """Numbers by name, and the names that somebody reads."""

    def __init__(self, numbers: Mapping[str, Value]) -> None:
        super().__init__(numbers)
        self.read: set[str] = set()

    def __getitem__(self, name: str) -> Value:
        self.read.add(name)
        return super().__getitem__(name)


def names_read(
    scheme: type[Scheme], tables: Mapping[str, tuple[float, ...]], constants: Mapping[str, float], tau_max: float
) -> tuple[list[str], list[str]]:
    """The tables and the single numbers that a scheme reads, in their order."""
    noting = _Noting(tables), _Noting(constants)
    scheme(*noting, tau_max, np.float64)
    of_tables, of_constants = ([name for name in each if name in each.read] for each in noting)
    return of_tables, of_constants

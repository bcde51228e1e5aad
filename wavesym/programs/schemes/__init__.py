"""The arithmetic of programs in NumPy: run here on a program's tables, and written into generated Python as it stands.

So the files of this folder import nothing but NumPy. What stands above their first class is left out in what is
generated. Each scheme is made from the tables and single numbers that it names, tau_max, and the type of all values:
np.float64 or np.float32.
"""

from __future__ import annotations

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

"""Other packages as rivals: rows that are there when the extra `peers` is installed."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

from wavesym.rivals import delays
from wavesym.rivals.problem import Rival

PEERS: tuple[Rival[Any], ...] = (delays.RIVAL,) if find_spec("jitcdde") else ()

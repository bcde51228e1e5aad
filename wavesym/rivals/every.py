"""The list of rivals, in the order of a chart."""

from __future__ import annotations

from typing import Any

from wavesym.rivals import characteristics, differences, elements, laplace, modal_elements, modes, steps
from wavesym.rivals.peers import PEERS
from wavesym.rivals.problem import Rival

RIVALS: tuple[Rival[Any], ...] = (
    characteristics.SECOND,
    characteristics.FOURTH,
    differences.RIVAL,
    elements.RIVAL,
    modal_elements.RIVAL,
    modes.RIVAL,
    steps.RIVAL,
    laplace.RIVAL,
    *PEERS,
)

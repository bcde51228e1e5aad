"""The list of other methods, in the order of a chart."""

from __future__ import annotations

from wavesym.methods import characteristics, differences, discrete, elements, laplace
from wavesym.methods.problem import Method

METHODS: tuple[Method, ...] = (
    characteristics.SECOND,
    characteristics.FOURTH,
    differences.METHOD,
    elements.NEWMARK,
    discrete.MODAL,
    laplace.METHOD,
)

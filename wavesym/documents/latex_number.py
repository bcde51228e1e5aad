"""Exact numbers as LaTeX: fractions, and rational functions of the parameters."""

from __future__ import annotations

import re

from flint import fmpq

from wavesym.numbers.ratio import Ratio


def latex_number(value: object) -> str:
    """A fraction, or a rational function, in math mode."""
    if isinstance(value, fmpq):
        size = abs(value)
        text = str(size.p) if size.q == 1 else rf"\tfrac{{{size.p}}}{{{size.q}}}"
        return f"-{text}" if value < 0 else text
    above, below = value.factorization.parts if isinstance(value, Ratio) else (str(value), "1")
    above, below = (re.sub(r"_(\w+)", r"_{\1}", each.replace("**", "^").replace("*", r"\,")) for each in (above, below))
    above, below = (each.replace("kappa", r"\kappa") for each in (above, below))
    return above if below == "1" else rf"\frac{{{above}}}{{{below}}}"

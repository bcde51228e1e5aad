"""How a derivation's formulas are written: for the terminal, and in LaTeX."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

from sympy import Add, Expr, Indexed
from sympy.printing.latex import LatexPrinter
from sympy.printing.str import StrPrinter

from wavesym.derivation.line import exact
from wavesym.derivation.recurrence import RATE


class _TextPrinter(StrPrinter):  # type: ignore[misc]  # SymPy is untyped
    printmethod = "_wavesym"  # Indexed brings a printer of its own for the usual one

    def _print_Indexed(self, expression: Indexed) -> str:
        return f"{expression.base}_{Text().subscript(expression.indices[0])}"

    def _print_Add(self, expression: Add, order: object = None) -> str:
        # positive terms first, so that no sum starts with a minus that it need not have
        parts = sorted(expression.as_ordered_terms(), key=Expr.could_extract_minus_sign)
        return Text().joined((part, "") for part in parts)

    def _print_Mul(self, expression: Expr) -> str:
        return str(super()._print_Mul(expression)).replace("*", " ")


class Text:
    """Formulas as one line of ASCII."""

    indent: ClassVar[str] = "  "

    def expression(self, expression: Expr | int) -> str:
        """An expression, with kappa_i for kappa[i]."""
        return str(_TextPrinter().doprint(exact(expression)))

    def subscript(self, index: Expr | int) -> str:
        """An index, in brackets unless it is one word."""
        written = self.expression(index).replace(" ", "")
        return written if written.isalnum() else f"({written})"

    def indexed(self, name: str, index: Expr | int) -> str:
        """f_i."""
        return f"{name}_{self.subscript(index)}"

    def joined(self, terms: Iterable[tuple[Expr, str]]) -> str:
        """A sum of factor times name, with signs as people write them; 0 where it is empty."""
        written = ""
        for factor, name in terms:
            negative = not isinstance(factor, Add) and factor.could_extract_minus_sign()
            size = -factor if negative else factor
            bracketed = f"({self.expression(size)})" if isinstance(size, Add) and name else self.expression(size)
            term = name if size == 1 and name else f"{bracketed} {name}".rstrip()
            written += (" - " if negative else " + ") + term
        return ("-" if written.startswith(" - ") else "") + written[3:] or "0"

    def clock(self, lag: Expr | int) -> str:
        """(z - lag)."""
        return "(z)" if lag == 0 else f"(z-{self.expression(lag)})"

    def power(self, base: str, power: int) -> str:
        """A factor base**power with its space."""
        return "" if power == 0 else f" {base}" if power == 1 else f" {base}^{power}"

    def motion(self, rod: Expr, by: str) -> str:
        """A derivative of the displacement U of a rod: `by` "tau", "tau2" or "x"."""
        order = "d2U" if by == "tau2" else "dU"
        return f"{self.indexed(order, rod)}/d{by}"

    def coefficient(self, function: str, rod: Expr, back: int, rate: str, power: str) -> str:
        """A coefficient of a function's increment `back` intervals ago."""
        interval = "n" if back == 0 else f"(n-{back})"
        return f"{self.indexed(function, rod)}^{interval}[{rate},{power}]"

    def total(self, coefficient: str) -> str:
        """The sum over all rates."""
        return f"sum_g {coefficient}"

    def gain(self, interval: int, power: int, value: str) -> str:
        """What a load adds to the right side."""
        return f"plus, in interval {interval} at [0,{power}]: {value}"

    def at_least(self, m: int) -> str:
        """m >= a number."""
        return f"m >= {m}"

    def place(self, first: Expr | int, second: Expr | int | None, last: Expr | int) -> str:
        """i = first, second, ..., last."""
        between = "" if second is None else f" {self.expression(second)},"
        return f",  i = {self.expression(first)},{between} ..., {self.expression(last)}"


class _LatexPrinter(LatexPrinter):  # type: ignore[misc]
    printmethod = "_wavesym"

    def _print_Indexed(self, expression: Indexed) -> str:
        return f"{self._print(expression.base.label)}_{{{self._print(expression.indices[0])}}}"

    def _print_Symbol(self, expression: Expr, style: str = "plain") -> str:
        # g is a wave; rates are gamma
        return r"\gamma" if expression == RATE else str(super()._print_Symbol(expression, style))


class Latex(Text):
    """Formulas in LaTeX."""

    def expression(self, expression: Expr | int) -> str:
        return str(_LatexPrinter().doprint(exact(expression)))

    def subscript(self, index: Expr | int) -> str:
        return f"{{{self.expression(index)}}}"

    def motion(self, rod: Expr, by: str) -> str:
        order, variable = {"tau": ("", r"\tau"), "tau2": ("^2", r"\tau^2"), "x": ("", "x")}[by]
        return rf"\frac{{\partial{order} U_{self.subscript(rod)}}}{{\partial {variable}}}"

    def power(self, base: str, power: int) -> str:
        return super().power(r"\tau" if base == "tau" else base, power)

    def coefficient(self, function: str, rod: Expr, back: int, rate: str, power: str) -> str:
        interval = "n" if back == 0 else f"n-{back}"
        greek = rate.replace("g", r"\gamma")
        return rf"{function}^{{({interval})}}_{{{self.expression(rod)};\,{greek},{power}}}"

    def total(self, coefficient: str) -> str:
        return rf"\sum_\gamma {coefficient}"

    def gain(self, interval: int, power: int, value: str) -> str:
        return rf"\text{{plus, for }} n = {interval},\ \gamma = 0,\ k = {power}:\quad {value}"

    def at_least(self, m: int) -> str:
        return rf"m \geq {m}"

    def place(self, first: Expr | int, second: Expr | int | None, last: Expr | int) -> str:
        between = "" if second is None else f" {self.expression(second)},"
        return rf",\quad i = {self.expression(first)},{between} \ldots, {self.expression(last)}"

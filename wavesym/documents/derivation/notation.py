"""How a derivation's formulas are written: for the terminal, and in LaTeX."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

from sympy import Add, Expr, Indexed
from sympy.printing.latex import LatexPrinter
from sympy.printing.str import StrPrinter

from wavesym.derivation.delay_terms import exact
from wavesym.derivation.recurrence import RATE


def _positive_first(expression: Add) -> list[Expr]:
    """The terms of a sum, a positive one first: no sum starts with a minus that it need not have."""
    terms = expression.as_ordered_terms()
    first = next((term for term in terms if not term.could_extract_minus_sign()), terms[0])
    return [first, *(term for term in terms if term is not first)]


class _TextPrinter(StrPrinter):  # type: ignore[misc]  # SymPy is untyped
    printmethod = "_wavesym"  # Indexed brings a printer of its own for the usual one

    def _print_Indexed(self, expression: Indexed) -> str:
        return f"{expression.base}_{Text().subscript(expression.indices[0])}"

    def _print_Add(self, expression: Add, order: object = None) -> str:
        return Text().sum_terms((term, "") for term in _positive_first(expression))

    def _print_Mul(self, expression: Expr) -> str:
        return str(super()._print_Mul(expression)).replace("**", "^").replace("*", " ")

    def _print_Abs(self, expression: Expr) -> str:
        return f"|{self._print(expression.args[0])}|"

    def _print_Pow(self, expression: Expr, rational: bool = False) -> str:
        return str(super()._print_Pow(expression, rational)).replace("**", "^")


@cache  # the same few expressions stand in many formulas
def _text(expression: Expr | int) -> str:
    return str(_TextPrinter().doprint(exact(expression)))


class Text:
    """Formulas as one line of ASCII."""

    def word(self, word: str) -> str:
        """Running text, which has its mathematics between dollars."""
        return word.replace("$", "")

    def expression(self, expression: Expr | int) -> str:
        """An expression, with kappa_i for kappa[i]."""
        return _text(expression)

    def subscript(self, index: Expr | int) -> str:
        """An index, in brackets unless it is one word."""
        written = self.expression(index).replace(" ", "")
        return written if written.isalnum() else f"({written})"

    def with_index(self, name: str, index: Expr | int) -> str:
        """f_i."""
        return f"{name}_{self.subscript(index)}"

    def sum_terms(self, terms: Iterable[tuple[Expr, str]]) -> str:
        """A sum of factor times name, with signs as people write them; 0 where it is empty."""
        written = ""
        for factor, name in terms:
            negative = all(part.could_extract_minus_sign() for part in Add.make_args(factor))
            size = -factor if negative else factor
            bracketed = f"({self.expression(size)})" if isinstance(size, Add) and name else self.expression(size)
            term = name if size == 1 and name else f"{bracketed} {name}".rstrip()
            written += (" - " if negative else " + ") + term
        return ("-" if written.startswith(" - ") else "") + written[3:] or "0"

    def balance(self, left: Iterable[tuple[Expr, str]], right: Iterable[tuple[Expr, str]]) -> str:
        """An equation of two sums of factor times name, without the terms whose factor is 0."""
        return " = ".join(self.sum_terms(term for term in side if term[0] != 0) for side in (left, right))

    def clock(self, lag: Expr | int) -> str:
        """(z - lag)."""
        return "(z)" if lag == 0 else f"(z-{self.expression(lag)})"

    def argument(self, argument: Expr) -> str:
        """An argument in brackets."""
        return f"({self.expression(argument)})"

    def quotient(self, above: Iterable[tuple[Expr, str]], below: Expr) -> str:
        """A sum of factor times name, divided by `below`."""
        terms = list(above)
        if all(part.could_extract_minus_sign() for part in Add.make_args(below)):
            terms, below = [(-factor, name) for factor, name in terms], -below
        return self.sum_terms(terms) if below == 1 else self.fraction(self.sum_terms(terms), len(terms) > 1, below)

    def fraction(self, above: str, is_sum: bool, below: Expr) -> str:
        """Something divided by something that is not 1."""
        written = self.expression(below)
        return f"{f'({above})' if is_sum else above}/{written if below.is_Atom or below.is_Indexed else f'({written})'}"

    def power_fraction(self, above: str, below: str, power: int) -> str:
        """Something divided by (below)**power."""
        return f"{above}/({below})" + (f"^{power}" if power > 1 else "")

    def coefficient_name(self, name: str, place: str) -> str:
        """A coefficient at a rate and a power, as they are written."""
        return f"{name}[{place}]"

    def power(self, base: str, power: int) -> str:
        """A factor base**power with its space."""
        return "" if power == 0 else f" {base}" if power == 1 else f" {base}^{power}"

    def motion(self, rod: Expr, by: str) -> str:
        """A derivative of the displacement U of a rod: `by` "tau", "tau2" or "x"."""
        order = "d2U" if by == "tau2" else "dU"
        return f"{self.with_index(order, rod)}/d{by}"

    def coefficient(self, function: str, rod: Expr, back: int, rate: Expr, power: Expr) -> str:
        """A coefficient of a function's increment `back` intervals ago."""
        interval = "n" if back == 0 else f"(n-{back})"
        return f"{self.with_index(function, rod)}^{interval}[{self.expression(rate)},{self._short(power)}]"

    def term(self, name: str, power: Expr) -> str:
        """The coefficient of a power of time."""
        return f"{name}[{self._short(power)}]"

    def _short(self, power: Expr) -> str:
        return self.expression(power).replace(" ", "")

    def constants(self, number: Expr, tau0: Expr, x0: Expr, velocity: Expr) -> str:
        """The constants of Table 1."""
        values = (self.expression(value) for value in (tau0, x0, velocity))
        place = self.subscript(number)
        names = (f"tau_0{place}", f"x_0{place}", "v")
        return ",  ".join(f"{name} = {value}" for name, value in zip(names, values, strict=True))

    def where(self, x: Expr) -> str:
        """At x."""
        return f"  at x = {self.expression(x)}"

    def total(self, coefficient: str, but: Expr | None = None) -> str:
        """The sum over all rates, or over all but one."""
        over = "g" if but is None else f"(g != {self.expression(but)})"
        return f"sum_{over} {coefficient}"

    def unless(self, rate: Expr) -> str:
        """g != a rate."""
        return f",  g != {self.expression(rate)}"

    def upwards(self, power: int) -> str:
        """k = a number and upwards."""
        return f",  k = {power}, {power + 1}, ..."

    def gain(self, interval: int, power: int, value: str) -> str:
        """What a load adds to the right side."""
        return f"plus, in interval {interval} at [0,{power}]: {value}"

    def whole(self, written: str) -> str:
        """The largest whole number in something."""
        return f"floor({written})"

    def even(self, number: str) -> str:
        """A number that is 0, 2, ..."""
        return f",  {number} = 0, 2, ..."

    def lower_limit(self, m: int) -> str:
        """m >= a number."""
        return f"m >= {m}"

    def place(self, first: Expr | int, last: Expr | int, step: int) -> str:
        """i = first, first + step, ..., last."""
        return ",  i = " + ", ".join(self._list_range(first, last, step, "..."))

    def _list_range(self, first: Expr | int, last: Expr | int, step: int, between: str) -> list[str]:
        start = [self.expression(place) for place in ((first, first + step) if step > 1 else (first,))]
        return [*(start[:1] if exact(last - first) == step else [*start, between]), self.expression(last)]


class _LatexPrinter(LatexPrinter):  # type: ignore[misc]
    printmethod = "_wavesym"

    def _as_ordered_terms(self, expression: Add, order: object = None) -> list[Expr]:
        return _positive_first(expression)

    def _print_Indexed(self, expression: Indexed) -> str:
        return f"{self._print(expression.base.label)}_{{{self._print(expression.indices[0])}}}"

    def _print_Symbol(self, expression: Expr, style: str = "plain") -> str:
        # g is a wave; rates are gamma
        return r"\gamma" if expression == RATE else str(super()._print_Symbol(expression, style))


@cache
def _latex(expression: Expr | int) -> str:
    return str(_LatexPrinter().doprint(exact(expression)))


class Latex(Text):
    """Formulas in LaTeX."""

    def word(self, word: str) -> str:
        return word.replace("_", r"\_")

    def expression(self, expression: Expr | int) -> str:
        return _latex(expression)

    def subscript(self, index: Expr | int) -> str:
        return f"{{{self.expression(index)}}}"

    def motion(self, rod: Expr, by: str) -> str:
        order, variable = {"tau": ("", r"\tau"), "tau2": ("^2", r"\tau^2"), "x": ("", "x")}[by]
        return rf"\frac{{\partial{order} U_{self.subscript(rod)}}}{{\partial {variable}}}"

    def power(self, base: str, power: int) -> str:
        return super().power(r"\tau" if base == "tau" else base, power)

    def fraction(self, above: str, is_sum: bool, below: Expr) -> str:
        # a product, which can be broken over lines where a fraction cannot
        return rf"\frac{{1}}{{{self.expression(below)}}} " + (rf"\bigl( {above} \bigr)" if is_sum else above)

    def power_fraction(self, above: str, below: str, power: int) -> str:
        return rf"\frac{{{above}}}{{({below})^{{{power}}}}}" if power > 1 else rf"\frac{{{above}}}{{{below}}}"

    def coefficient_name(self, name: str, place: str) -> str:
        return f"{name}_{{{place.replace('g', self.expression(RATE))}}}"

    def coefficient(self, function: str, rod: Expr, back: int, rate: Expr, power: Expr) -> str:
        interval = "n" if back == 0 else f"n-{back}"
        place = rf"{self.expression(rod)};\,{self.expression(rate)},{self._short(power)}"
        return rf"{function}^{{({interval})}}_{{{place}}}"

    def term(self, name: str, power: Expr) -> str:
        return f"{name}_{{{self._short(power)}}}"

    def constants(self, number: Expr, tau0: Expr, x0: Expr, velocity: Expr) -> str:
        values = (self.expression(value) for value in (tau0, x0, velocity))
        place = self.expression(number)
        names = (rf"\tau_{{0,{place}}}", f"x_{{0,{place}}}", "v")
        return r",\quad ".join(f"{name} = {value}" for name, value in zip(names, values, strict=True))

    def where(self, x: Expr) -> str:
        return rf"\quad\text{{at }} x = {self.expression(x)}"

    def total(self, coefficient: str, but: Expr | None = None) -> str:
        over = r"\gamma" if but is None else rf"\gamma \neq {self.expression(but)}"
        return rf"\sum_{{{over}}} {coefficient}"

    def unless(self, rate: Expr) -> str:
        return rf",\quad \gamma \neq {self.expression(rate)}"

    def upwards(self, power: int) -> str:
        return rf",\quad k = {power}, {power + 1}, \ldots"

    def gain(self, interval: int, power: int, value: str) -> str:
        return rf"\text{{plus, for }} n = {interval},\ \gamma = 0,\ k = {power}:\quad {value}"

    def whole(self, written: str) -> str:
        return rf"\left\lfloor {written} \right\rfloor"

    def even(self, number: str) -> str:
        return rf",\quad {number} = 0, 2, \ldots"

    def lower_limit(self, m: int) -> str:
        return rf"m \geq {m}"

    def place(self, first: Expr | int, last: Expr | int, step: int) -> str:
        return r",\quad i = " + ", ".join(self._list_range(first, last, step, r"\ldots"))

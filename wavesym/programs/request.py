"""What a program is asked to be: the options of `generate` that decide it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from flint import fmpq

from wavesym.errors import ToleranceError, WavesymError
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import REALS

KINDS = ("closed", "pieces", "march", "modes")
AIMS = ("speed", "size")


@dataclass(frozen=True)
class Request:
    """`evaluator` is a kind of program or "auto"; `windows` is for a march that is driven by hand.

    `optimize` says of programs that meet the tolerance which is best: the fastest ("speed"), or the one with the least
    tables ("size"). Unless it is said the fastest kind is taken; in single precision, which is for small machines, with
    small tables. `runtime` names the parameters that are given at run time. `target` is what a stream is wrapped for.
    """

    evaluator: str = "auto"
    precision: str = "double"
    windows: int | None = None
    optimize: str | None = None
    runtime: tuple[str, ...] = ()
    stream: bool = False
    step: fmpq | None = None
    target: str = ""

    @property
    def options(self) -> str:
        """Those that differ from what is usual, as they are typed."""
        options = "" if self.evaluator == "auto" else f" --evaluator {self.evaluator}"
        options += "" if self.precision == "double" else f" --precision {self.precision}"
        options += "" if self.windows is None else f" --windows {self.windows}"
        options += "" if self.optimize is None else f" --optimize {self.optimize}"
        options += " --stream" if self.stream and not self.target else ""
        options += f" --target {self.target}" if self.target else ""
        options += "" if self.step is None else f" --step {self.step}"
        return options + (f" --runtime {','.join(self.runtime)}" if self.runtime else "")

    def refuse_unknown(self) -> None:
        """WavesymError for a word that is none of those there are."""
        for option, word, known in (
            ("evaluator", self.evaluator, ("auto", *KINDS)),
            ("precision", self.precision, REALS),
            ("optimize", self.optimize or AIMS[0], AIMS),
        ):
            refuse_unknown(option, word, known)


def refuse_unknown(option: str, word: str, known: Iterable[str]) -> None:
    """WavesymError for a word that is none of those there are."""
    if word not in (names := tuple(known)):
        *others, last = names
        raise WavesymError(f"{option}: {word} given, {', '.join(others)} or {last} expected")


def unmet(tolerance: fmpq, why: str) -> ToleranceError:
    """The error that says that a tolerance cannot be met."""
    return ToleranceError(f"output.tolerance: {nearest(tolerance):g} cannot be met: {why}")

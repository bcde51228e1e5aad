"""What a program is asked to be: the options of `generate` that decide it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from flint import fmpq

from wavesym.errors import ToleranceError, WavesymError, did_you_mean
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import REALS

KINDS = ("closed", "pieces", "march", "modes")
AIMS = ("speed", "size")
PARTS = ("peaks", "gradients", "batch", "misfit", "bound")
"""What C with parameters at run time may have besides values and the estimate of their errors."""


@dataclass(frozen=True)
class Request:
    """`evaluator` is a kind of program or "auto".

    `optimize` says of programs that meet the tolerance which is best: the fastest ("speed"), or the one with the least
    tables ("size"). Unless it is said the fastest kind is taken; in single precision, which is for small machines, with
    small tables. `runtime` names the parameters that are given at run time, `parts` what their C has besides values;
    `kappa_max` is the largest kappa that it is made for, None for ten times the scene's own. `target` is what a stream
    is wrapped for.
    """

    evaluator: str = "auto"
    precision: str = "double"
    optimize: str | None = None
    runtime: tuple[str, ...] = ()
    stream: bool = False
    step: fmpq | None = None
    target: str = ""
    parts: tuple[str, ...] = ()
    kappa_max: fmpq | None = None

    @property
    def options(self) -> str:
        """Those that differ from what is usual, as they are typed."""
        options = "" if self.evaluator == "auto" else f" --evaluator {self.evaluator}"
        options += "" if self.precision == "double" else f" --precision {self.precision}"
        options += "" if self.optimize is None else f" --optimize {self.optimize}"
        options += " --stream" if self.stream and not self.target else ""
        options += f" --target {self.target}" if self.target else ""
        options += "" if self.step is None else f" --step {self.step}"
        options += f" --runtime {','.join(self.runtime)}" if self.runtime else ""
        options += f" --with {','.join(self.parts)}" if self.parts else ""
        return options + ("" if self.kappa_max is None else f" --kappa-max {self.kappa_max}")

    @property
    def every_part(self) -> tuple[str, ...]:
        """The parts that are asked for and those that they need, in order: misfits are those of a batch."""
        return tuple(part for part in PARTS if part in self.parts or (part == "batch" and "misfit" in self.parts))

    def refuse_unknown(self) -> None:
        """WavesymError for a word that is none of those there are, and for what is of parameters at run time alone."""
        for option, word, known in (
            ("evaluator", self.evaluator, ("auto", *KINDS)),
            ("precision", self.precision, REALS),
            ("optimize", self.optimize or AIMS[0], AIMS),
        ):
            refuse_unknown(option, word, known)
        refuse_others("--with", self.parts, PARTS)
        streamed = f"with --target {self.target}" if self.target else "with --stream" if self.stream else ""
        where = streamed if self.runtime else "without --runtime"
        for option, given in (("--with", ",".join(self.parts)), ("--kappa-max", self.kappa_max)):
            if given and where:
                raise WavesymError(f"{option}: {given} given {where}, nothing expected")


def refuse_others(option: str, names: Sequence[str], known: Sequence[str]) -> None:
    """WavesymError for a name that is none of those there are, and for one that is given twice."""
    for place, name in enumerate(names):
        if name not in known:
            expected = f"{_one_of(known)} expected. {did_you_mean(name, known)}".rstrip(". ")
            raise WavesymError(f"{option}: {name or 'nothing'} given, {expected}")
        if name in names[:place]:
            raise WavesymError(f"{option}: {name} given twice, once expected")


def refuse_unknown(option: str, word: str, known: Iterable[str]) -> None:
    """WavesymError for a word that is none of those there are."""
    if word not in (names := tuple(known)):
        raise WavesymError(f"{option}: {word} given, {_one_of(names)} expected")


def _one_of(names: Sequence[str]) -> str:
    *others, last = names
    return f"{', '.join(others)} or {last}" if others else last


def unmet(tolerance: fmpq, why: str) -> ToleranceError:
    """The error that says that a tolerance cannot be met."""
    return ToleranceError(f"output.tolerance: {nearest(tolerance):g} cannot be met: {why}")

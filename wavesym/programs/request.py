"""What a program is requested to be: the options of `generate`, made once by the door and passed whole."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from wavesym.errors import CostError, MeasureError, ToleranceError, WavesymError, did_you_mean

if TYPE_CHECKING:
    from flint import fmpq

    from wavesym.mechanics.clock import Clock
    from wavesym.mechanics.model import Model

KINDS = ("closed", "pieces", "march", "modes")
EVALUATORS = ("auto", *KINDS)
PRECISIONS = ("double", "single")
AIMS = ("speed", "size")
TARGETS = ("c", "numpy")
"""The languages. Each is the name of a folder of `wavesym/targets`; a new one is a name more."""
LANGUAGES = (*TARGETS, "all")
SIMULATORS = ("fmu2", "fmu3")
"""Versions of FMI, of which a stream may be the one file."""
PARTS = ("peaks", "gradients", "batch", "misfit", "bound")
"""What C with parameters at run time may have besides values and the estimate of their errors."""
OF_MODES = {
    "stiffness": "changes how long a wave takes through a rod",
    "rod_mass": "changes how long a wave takes through a rod",
    "damping": "is that of modes",
}
"""The parameters at run time that modes alone have, and what of them no march can take."""
_OF_TRAVEL_TIMES = frozenset({"length", "height", "speed", "E", "G", "I", "EI", "GJ", "EA", "GA", "rho"})
_OF_SECTIONS = frozenset({"A", "J", "diameter", "bore"})
POSITIVE = frozenset({"kappa", "inertia", "mass", "dashpot", "spring", "impedance"})
"""The parameters at run time that have to be positive, and that a largest rate is about."""

_HELPS = re.compile(r" \([^()]* help(s)?\)$")
_FIGURES = 12  # of a number that people read
_OTHERS = re.compile(r" \(take [^()]*\)$")


@dataclass(frozen=True)
class Request:
    """The options that decide what is generated.

    `evaluator` is a kind of program or "auto". `optimize` says which is best of the programs that meet the tolerance:
    the fastest ("speed"), or the one with the smallest tables ("size"), for pictures what is made soonest
    ("making"); None is the fastest kind, in single precision, which is for small machines, with small tables.
    `runtime` names the parameters that are given at run time, `parts` what their C has besides values; `kappa_max`
    is the largest kappa that it is made for, None for ten times the scene's own. A `stream` takes loads sample by
    sample, best at multiples of `step`; `target` is what it is wrapped for. `language` and `package` say which
    files there are, not what they compute.
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
    language: str = "c"
    package: bool = False

    @classmethod
    def from_options(
        cls,
        *,
        step: Fraction | None = None,
        kappa_max: Fraction | None = None,
        runtime: Sequence[str] = (),
        parts: Sequence[str] = (),
        **options: Any,
    ) -> Request:
        """A request of options that go together.

        Args:
            step, kappa_max: exact numbers, dimensionless.
            runtime, parts: lists of names.
            options: all others, as they are kept; None for what is usual.

        Raises:
            WavesymError: for a word that there is not, and for options that exclude each other.
        """
        from wavesym.numbers.doubles import rational

        every, largest = (None if number is None else rational(number) for number in (step, kappa_max))
        chosen = {name: value for name, value in options.items() if value is not None}
        chosen["stream"] = chosen.get("stream", False) or bool(chosen.get("target"))
        request = cls(step=every, kappa_max=largest, runtime=tuple(runtime), parts=tuple(parts), **chosen)
        request.refuse_unknown()
        request._refuse_contradictions()
        return request

    def options(self, model: Model | None = None) -> str:
        """Those that change what is generated and differ from what is usual, as they are typed for a scene."""
        options = "" if self.evaluator == "auto" else f" --evaluator {self.evaluator}"
        options += "" if self.precision == "double" else f" --precision {self.precision}"
        options += "" if self.optimize is None else f" --optimize {self.optimize}"
        options += " --stream" if self.stream and not self.target else ""
        options += f" --target {self.target}" if self.target else ""
        options += "" if self.step is None else f" --step {_step_text(self.step, model.clock if model else None)}"
        options += f" --runtime {','.join(self.runtime)}" if self.runtime else ""
        options += f" --with {','.join(self.parts)}" if self.parts else ""
        return options + ("" if self.kappa_max is None else f" --kappa-max {self.kappa_max}")

    @property
    def every_part(self) -> tuple[str, ...]:
        """The parts that are requested and those that they need, in order: misfits are those of a batch."""
        return tuple(part for part in PARTS if part in self.parts or (part == "batch" and "misfit" in self.parts))

    def is_of_modes(self, model: Model) -> bool:
        """Whether a stream is stepped by modes, not by waves: where they are requested, or are damped."""
        return self.stream and (self.evaluator == "modes" or (self.evaluator == "auto" and model.damping is not None))

    def is_of_mode_sets(self, model: Model) -> bool:
        """Whether parameters at run time are numbers of modes: where modes are requested, are damped, or alone can."""
        alone = model.damping is not None or not model.network.bars or not OF_MODES.keys().isdisjoint(self.runtime)
        return self.evaluator == "modes" or alone

    def refuse_unknown(self) -> None:
        """WavesymError for a word that is none of those there are, and for what is of parameters at run time alone."""
        for option, word, known in (
            ("evaluator", self.evaluator, EVALUATORS),
            ("precision", self.precision, PRECISIONS),
            ("optimize", self.optimize or AIMS[0], AIMS),
            ("language", self.language, LANGUAGES),
            ("target", self.target or SIMULATORS[0], SIMULATORS),
        ):
            refuse_unknown(option, word, known)
        refuse_others("--with", self.parts, PARTS)
        streamed = f"with --target {self.target}" if self.target else "with --stream" if self.stream else ""
        without = f"does not go {streamed}" if streamed else "" if self.runtime else "goes with --runtime only"
        for option, given in (("--with", ",".join(self.parts)), ("--kappa-max", self.kappa_max)):
            if given and without:
                raise WavesymError(f"{option}: {given} {without}; leave {option} out")

    def _refuse_contradictions(self) -> None:
        """WavesymError for options that exclude each other."""
        modes = self.evaluator == "modes"
        if self.step is not None and not self.stream:
            raise WavesymError(f"--step: {readable_step(self.step)} tau is that of a stream; write --stream too")
        if self.kappa_max is not None and self.kappa_max <= 0:
            raise WavesymError(f"--kappa-max: {self.kappa_max} is not positive; write a number above 0")
        if self.kappa_max is not None and POSITIVE.isdisjoint(self.runtime):
            chosen = f"--kappa-max: {self.kappa_max} with --runtime {','.join(self.runtime)}"
            raise WavesymError(f"{chosen}: bodies stay as heavy as they are; leave --kappa-max out")
        if self.target:
            refuse_beside(
                "--target",
                (
                    ("language", self.language, "c"),
                    ("precision", self.precision, "double"),
                    ("--package", self.package, False),
                ),
            )
            return
        if self.package and self.language not in ("c", "all"):
            raise WavesymError(f"language: {self.language}, but --package builds C with CMake; write c or all")
        only_c = "--stream" if self.stream and not modes else "--runtime" if self.runtime and not self.stream else ""
        if only_c and self.language != "c":
            raise WavesymError(f"language: {only_c} makes C, not {self.language}; write c")


def why_constant(name: str, known: Sequence[str]) -> str:
    """Why a quantity of rods is no parameter at run time, and what varies it; nothing for what is none."""
    if name in ("kappa", "inertia") and "mass" in known:
        others = "modes have" if "stiffness" in known else "a chain of unlike rods has"
        return f"{name} is of waves in a named system whose rods are alike; {others} mass in its place"
    if name not in _OF_TRAVEL_TIMES | _OF_SECTIONS:
        return ""
    sweep = "`wavesym sweep` varies keys of rods, by their paths under [vary]"
    if "stiffness" in known:
        return f"{name} is in the stiffness or the mass of a rod: write stiffness or rod_mass; or {sweep}"
    if name in _OF_SECTIONS and "impedance" in known:
        return f"{name} is in the impedance of a rod: write that; or {sweep}"
    modes = "modes take stiffness and rod_mass at run time, where no load jumps and no dashpot acts"
    if name in _OF_SECTIONS:
        return f"{name} changes the impedance of a rod, which stays here; {sweep}; {modes}"
    return f"{name} changes travel times of a march, which stay at run time; {sweep}; {modes}"


def refuse_others(
    option: str, names: Sequence[str], known: Sequence[str], why: Callable[[str, Sequence[str]], str] | None = None
) -> None:
    """WavesymError for a name that is none of those there are, with `why`, and for one that is given twice."""
    for place, name in enumerate(names):
        if name not in known:
            choice = f"{alternatives(known)}. {did_you_mean(name, known)}".rstrip(". ")
            if why and (reason := why(name, known)):
                choice = f"{alternatives(known)} ({reason})"
            raise WavesymError(f"{option}: {name or 'an empty name'} is unknown; write {choice}")
        if name in names[:place]:
            raise WavesymError(f"{option}: {name} stands twice; write it once")


def refuse_beside(other: str, options: Iterable[tuple[str, object, object]]) -> None:
    """WavesymError for options that do not go with another: each its name, its value, and the usual one."""
    for option, value, usual in options:
        if value != usual:
            remedy = f"write {usual}" if usual else "leave it out"
            raise WavesymError(f"{option}: {value} does not go with {other}; {remedy}")


def refuse_unknown(option: str, word: str, known: Iterable[str]) -> None:
    """WavesymError for a word that is none of those there are."""
    if word not in (names := tuple(known)):
        raise WavesymError(f"{option}: {word} is unknown; write {alternatives(names)}")


def alternatives(names: Sequence[str]) -> str:
    """Names of which one is to be taken, as a sentence has them."""
    *others, last = names
    return f"{', '.join(others)} or {last}" if others else last


def readable_step(step: fmpq) -> str:
    """A step in tau as a decimal, to six figures where it is none or a long one."""
    from wavesym.fields.numbers import decimal_text
    from wavesym.numbers.doubles import fraction, nearest

    exact = decimal_text(fraction(step))
    return exact if len(exact) <= _FIGURES and "/" not in exact else f"{nearest(step):.6g}"


def _step_text(step: fmpq, clock: Clock | None) -> str:
    """A step as people write it: in tau, or in seconds where the scene has units and that is shorter."""
    from wavesym.fields.numbers import decimal_text
    from wavesym.numbers.doubles import fraction

    seconds = decimal_text(fraction(step * clock.seconds)) if clock else ""
    return f'"{seconds} s"' if seconds and len(seconds) < len(str(step)) else str(step)


def unmet_tolerance(tolerance: fmpq, refusals: Mapping[str, str], bound: float) -> ToleranceError:
    """The error that says that a tolerance cannot be met, which can, and why each kind of program is refused.

    Args:
        tolerance: that of the scene.
        refusals: a sentence for each kind of program.
        bound: the least of their errors, relative to an output's largest value; 1 or more where there is none.
    """
    from wavesym.numbers.doubles import nearest

    remedy = f"; write {2 * bound:.0e} or more" if bound < 0.1 else ""
    # what would help one kind of program alone is no news where a tolerance helps
    # and what else could be taken has been tried, too
    tried = ((kind, re.sub(_OTHERS, "", refusal)) for kind, refusal in refusals.items())
    why = (f"{kind}: {re.sub(_HELPS, '', refusal) if remedy else refusal}" for kind, refusal in tried)
    message = f"output.tolerance: {nearest(tolerance):g} cannot be met{remedy} ({'; '.join(why)})"
    return ToleranceError(message, "; ".join(refusals.values()), bound)


def stream_refusal(model: Model, cost: CostError) -> CostError:
    """The error that says that a stream of waves costs too much for a horizon, and what steps for hours instead."""
    modes = "--evaluator modes" if model.network.loses else 'damping = "0.5 %" under [system], say'
    remedy = (
        f"a shorter horizon, after which a stream goes on; or, for hours, {modes}: that makes a stream of modes, which "
        "takes a tolerance of 1e-6 best"
    )
    return type(cost)(f"{re.sub(_HELPS, '', str(cost))} (write {remedy})")


def unfollowed_waves(model: Model, measure: MeasureError, refusals: Mapping[str, str]) -> ToleranceError:
    """The error that says that no program follows the waves of a model, and what gives travel times a common measure.

    Args:
        model: whose travel times have none.
        measure: what a march says of them.
        refusals: a sentence for each other kind of program that a change of the scene could make serve.
    """
    from wavesym.numbers.doubles import nearest

    others = "; ".join(f"{kind}: {refusal}" for kind, refusal in refusals.items())
    message = (
        f"system: no program follows these waves to tau = {nearest(model.until):g}, as travel times of the rods have "
        f"no common measure; write {measure.helps} under [system], which changes speeds of waves by that or less and "
        f"keeps impedances, or a shorter horizon{others and f' ({others})'}"
    )
    return ToleranceError(message, f"{'; '.join([*refusals.values(), str(measure)])}")

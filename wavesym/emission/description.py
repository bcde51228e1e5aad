"""What every generated file says of itself: the scene it was made from and what was proved for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from textwrap import wrap

import numpy as np
from flint import fmpq

from wavesym.emission.literals import c_literal, literal
from wavesym.evaluators.choice import Evaluator
from wavesym.evaluators.contact import ContactEnd
from wavesym.evaluators.doubles import nearest, rational
from wavesym.evaluators.reals import DOUBLE, Real
from wavesym.mechanics.chain import chain
from wavesym.mechanics.cone import felt
from wavesym.scene import Building, Scene

_WIDTH = 110


@dataclass(frozen=True)
class Output:
    """An output's name and its proved bound, relative to its largest value."""

    name: str
    bound: str


@dataclass(frozen=True)
class Contact:
    """The end of a contact: its place for identifiers, tau as a literal of C and of Python, and with 20 digits."""

    position: str
    c_tau: str
    tau: str
    digits: str


@dataclass(frozen=True)
class Description:
    """Strings for the templates. `prefix` is the name in capitals, `model` the scene in lines of text.

    `real` and `numpy_real` are the type of all values in C and in NumPy; numbers that C reads have its suffix.
    """

    name: str
    prefix: str
    model: tuple[str, ...]
    real: str
    numpy_real: str
    reason: str
    tolerance: str
    outputs: tuple[Output, ...]
    output_count: str
    tau_max: str
    c_tau_max: str
    error_bound: str
    c_error_bound: str
    contacts: tuple[Contact, ...]


def describe(scene: Scene, evaluator: Evaluator, reason: str, contacts: Sequence[ContactEnd]) -> Description:
    """The description of a scene and of the evaluator chosen for it."""
    real = evaluator.real
    bound = _not_below(evaluator.error_bound, real)
    return Description(
        name=scene.name,
        prefix=scene.name.upper(),
        model=tuple(line for part in _model(scene) for line in wrap(part, _WIDTH, subsequent_indent="  ")),
        real="double" if real is DOUBLE else "float",
        numpy_real="float64" if real is DOUBLE else "float32",
        reason=reason,
        tolerance=_tolerance(scene),
        outputs=tuple(Output(output.name, literal(_not_below(output.bound, DOUBLE))) for output in evaluator.outputs),
        output_count=str(len(evaluator.outputs)),
        tau_max=literal(evaluator.tau_max),  # a double in Python: the shortest text of a float may lie below it
        c_tau_max=c_literal(evaluator.tau_max, real),
        error_bound=literal(bound, real),
        c_error_bound=c_literal(bound, real),
        contacts=tuple(_contact(end, real) for end in contacts),
    )


def _not_below(value: float, real: Real) -> float:
    """The smallest number not below a bound; the largest for an infinite one, which no program can write down."""
    largest = float(np.finfo(np.float64 if real is DOUBLE else np.float32).max)
    return real.not_below(rational(value)) if value <= largest else largest


def _contact(end: ContactEnd, real: Real) -> Contact:
    tau = real.nearest(rational(end.double))
    return Contact(str(end.x), c_literal(tau, real), literal(tau, real), end.digits)


def parameters(scene: Scene) -> dict[str, dict[int, fmpq]]:
    """The parameters that can matter to an output within the horizon, by name and index."""
    return felt(chain(scene), scene.outputs, scene.output.until)


def _model(scene: Scene) -> list[str]:
    parts = scene.system
    lines = [f"{parts.type}, as far as the light cone of the outputs reaches"]
    if isinstance(parts, Building):
        lines.append(f"base = {parts.base}")
    for name, numbers in parameters(scene).items():
        if numbers:
            lines.append(", ".join(f"{name}_{index} = {value}" for index, value in numbers.items()))
    loads = ", ".join(f"{p.weight} {p.source} at {p.time}" for p in scene.pieces if p.source != "impact")
    if loads:
        lines.append(f"unit loads: {loads}")
    return [*lines, f"until = {scene.output.until}, tolerance = {_tolerance(scene)}"]


def _tolerance(scene: Scene) -> str:
    return literal(nearest(rational(Fraction(scene.output.tolerance))))

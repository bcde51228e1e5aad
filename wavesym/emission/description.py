"""What every generated file says of itself: the scene it was made from and what was proved for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from textwrap import wrap

from wavesym.emission.literals import literal
from wavesym.evaluators.closed import ClosedForm
from wavesym.evaluators.contact import ContactEnd
from wavesym.evaluators.doubles import nearest, rational
from wavesym.scene import Building, Collision, Drive, Scene

_WIDTH = 110


@dataclass(frozen=True)
class Output:
    """An output's name and its proved bound, relative to its largest value."""

    name: str
    bound: str


@dataclass(frozen=True)
class Contact:
    """The end of a contact: its place for identifiers, tau as a double literal and with 20 digits."""

    position: str
    tau: str
    digits: str


@dataclass(frozen=True)
class Description:
    """Strings for the templates. `prefix` is the name in capitals, `model` the scene in lines of text."""

    name: str
    prefix: str
    model: tuple[str, ...]
    evaluator: str
    reason: str
    outputs: tuple[Output, ...]
    output_count: str
    tau_max: str
    error_bound: str
    contacts: tuple[Contact, ...]


def describe(scene: Scene, form: ClosedForm, reason: str, contacts: Sequence[ContactEnd]) -> Description:
    """The description of a scene and of the evaluator chosen for it."""
    return Description(
        name=scene.name,
        prefix=scene.name.upper(),
        model=tuple(line for part in _model(scene) for line in wrap(part, _WIDTH, subsequent_indent="  ")),
        evaluator="closed",
        reason=reason,
        outputs=tuple(Output(output.name, literal(output.bound)) for output in form.outputs),
        output_count=str(len(form.outputs)),
        tau_max=literal(form.tau_max),
        error_bound=literal(form.error_bound),
        contacts=tuple(Contact(str(end.x), literal(end.double), end.digits) for end in contacts),
    )


def _model(scene: Scene) -> list[str]:
    parts = scene.system
    lines = [f"{parts.type}, m = {parts.m}", f"kappa = {_listed(parts.kappa)}"]
    match parts:
        case Collision():
            lines.append(f"velocity = {_listed(parts.velocity)}")
        case Drive():
            lines.append(f"inertia = {_listed(parts.inertia)} (ratios)")
        case Building():
            lines.append(f"base = {parts.base}")
    loads = ", ".join(f"{piece.weight} {piece.source} at {piece.time}" for piece in scene.pieces)
    if loads and not isinstance(parts, Collision):
        lines.append(f"unit loads: {loads}")
    tolerance = literal(nearest(rational(scene.output.tolerance)))
    return [*lines, f"until = {scene.output.until}, tolerance = {tolerance}"]


def _listed(numbers: Sequence[Fraction]) -> str:
    return ", ".join(map(str, numbers))

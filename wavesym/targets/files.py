"""The files of a scene: the evaluator that meets its tolerance, in the languages asked for, and the manifest.

Only this file talks to the folders of languages: a new one is a folder beside it, and a name in __init__.py.
"""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from pathlib import Path

from wavesym.errors import WavesymError
from wavesym.exact.contact import contact_ends
from wavesym.model.model import Model
from wavesym.numbers.reals import REALS
from wavesym.programs.assembly import assemble
from wavesym.programs.choice import MAKERS, Made, choose
from wavesym.targets import LANGUAGES, TARGETS
from wavesym.targets.description import describe
from wavesym.targets.manifest import manifest
from wavesym.targets.reference import reference_values
from wavesym.targets.target import Target

MARKS = (b": made by wavesym", b'"generator": "wavesym"')
EVALUATORS = ("auto", *MAKERS)


def _refuse_unknown(**options: tuple[str, Iterable[str]]) -> None:
    for option, (word, known) in options.items():
        if word not in (names := tuple(known)):
            *others, last = names
            raise WavesymError(f"{option}: {word} given, {', '.join(others)} or {last} expected")


def is_ours(path: Path) -> bool:
    """Whether a file says in its first lines that wavesym wrote it."""
    with path.open("rb") as file:
        start = file.read(1000)
    return any(mark in start for mark in MARKS)


def files(
    model: Model,
    language: str = "c",
    evaluator: str = "auto",
    precision: str = "double",
    windows: int | None = None,
) -> dict[str, str]:
    """What `generate` writes, by file name.

    ToleranceError where no evaluator, or not the one asked for, meets the model's tolerance; CostError where the one
    asked for would cost too much.
    """
    _refuse_unknown(language=(language, LANGUAGES), evaluator=(evaluator, EVALUATORS), precision=(precision, REALS))
    name, chosen, reason = choose(model, evaluator, precision, windows)
    options = "" if evaluator == "auto" else f" --evaluator {evaluator}"
    options += "" if precision == "double" else f" --precision {precision}"
    options += "" if windows is None else f" --windows {windows}"
    program = assemble(chosen, reason)
    targets = [_target(name) for name in (TARGETS if language == "all" else (language,))]
    reference = reference_values(model, chosen) if any(target.tested for target in targets) else None
    description = describe(model, chosen, reason, contact_ends(model, chosen.real), options, reference)
    made = {f"{model.name}.json": manifest(model, description, chosen, name)}
    for target in targets:
        made |= target.files(description, program)
    return dict(sorted(made.items()))


def program_files(model: Model, evaluator: Made, language: str, *, tested: bool = False) -> dict[str, str]:
    """The program of an evaluator in a language, by file name, whatever its bound; with its self-test if `tested`."""
    reference = reference_values(model, evaluator) if tested else None
    description = describe(model, evaluator, evaluator.summary, (), reference=reference)
    return _target(language).files(description, assemble(evaluator))


def numpy_text(model: Model, evaluator: Made) -> str:
    """The same as the text of one Python module."""
    (text,) = program_files(model, evaluator, "numpy").values()
    return text


def _target(name: str) -> Target:
    """The language of a folder."""
    target: Target = import_module(f"wavesym.targets.{name}").TARGET
    return target

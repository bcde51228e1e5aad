"""The files of a scene: the evaluator that meets its tolerance, in the languages asked for, and the manifest."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from wavesym.errors import WavesymError
from wavesym.exact.contact import contact_ends
from wavesym.model.model import Model
from wavesym.numbers.reals import REALS
from wavesym.programs.choice import choose
from wavesym.targets import closed, march, pieces
from wavesym.targets.description import describe
from wavesym.targets.manifest import manifest
from wavesym.targets.selftest import selftest

MARKS = (b": made by wavesym", b'"generator": "wavesym"')
LANGUAGES = {"c": ("c",), "numpy": ("numpy",), "all": ("c", "numpy")}
EMITTERS = {"closed": closed, "pieces": pieces, "march": march}
EVALUATORS = ("auto", *EMITTERS)


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
    description = describe(model, chosen, reason, contact_ends(model, chosen.real), options)
    emitter = EMITTERS[name]
    made = {f"{model.name}.json": manifest(model, description, chosen, name)}
    if "c" in LANGUAGES[language]:
        made[f"{model.name}.h"] = emitter.c_header(description, chosen)
        made[f"{model.name}.c"] = emitter.c_source(description, chosen)
        made[f"{model.name}_selftest.c"] = selftest(model, description, chosen)
    if "numpy" in LANGUAGES[language]:
        made[f"{model.name}.py"] = emitter.numpy_source(description, chosen)
    return dict(sorted(made.items()))

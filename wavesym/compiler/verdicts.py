"""Ways to verdicts: on programs, on the derivation, on the paper, and on simpler models of a scene."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from wavesym.errors import WavesymError
from wavesym.scene import Scene, lower

if TYPE_CHECKING:
    from wavesym.mechanics.node import System
    from wavesym.papers.entries import PaperEntry


def verify(
    scenes: Iterable[Scene],
    evaluator: str | None = None,
    precision: str | None = None,
    runtime: str | None = None,
    *,
    stream: bool = False,
) -> tuple[str, bool]:
    """Compare programs of scenes with direct integration of what the scenes state, and with exact values.

    Args:
        scenes: each is verified by itself.
        evaluator: "auto", "closed", "pieces", "march" or "modes".
        precision: "double" or "single".
        runtime: names of parameters that come at run time, with commas between.
        stream: whether loads come sample by sample.
            Without any of these four every program that serves a scene is compared, else those that are meant.

    Returns:
        Tables of errors, and whether all of them are allowed and every output of every scene was seen.

    Raises:
        WavesymError: for a word that there is not, or options that exclude each other.
    """
    from wavesym.programs.request import KINDS, Request
    from wavesym.verification.report import verify as report

    names = tuple(name.strip() for name in runtime.split(",")) if runtime is not None else ()
    kinds = [evaluator] if evaluator else ["auto"] if names or stream else KINDS
    requests = [Request(kind, precision or "double", runtime=names, stream=stream) for kind in kinds]
    for request in requests:
        request.refuse_unknown()
    some = any((evaluator, precision, names, stream))
    return report(((scene, lower(scene)) for scene in scenes), requests if some else None)


def derived(watch: Callable[[list[System]], Iterable[System]] = iter) -> tuple[str, bool]:
    """The proofs of the derivation and other routes to its tables, with their arguments, and whether all of them hold.

    `watch` goes through the systems as they are proved.
    """
    from wavesym.verification.derived import derived as report

    return report(watch)


def published(
    format: str = "text",
    names: Sequence[str] = (),
    reproduce: bool = False,
    watch: Callable[[Sequence[PaperEntry]], Iterable[PaperEntry]] = iter,
) -> tuple[str, bool]:
    """A verdict on every formula of the paper, or on those that `names` ask for, and whether all could be tested.

    As text, json, markdown, html or latex; `reproduce` adds a scene that shows each counterexample. `watch` goes
    through the records as they are judged. WavesymError for a name that the paper does not have.
    """
    from wavesym.papers.published import published as report

    return report(names, format, reproduce, watch)


def advise(scene: Scene, tolerance: float = 0.01, format: str = "text") -> str:
    """Which model of a scene is enough, massless springs, consistent mass or waves, as text or json.

    WavesymError for a tolerance that is not between 0 and 1; ToleranceError, CostError where nothing could be generated
    either.
    """
    from wavesym.rivals.advice import advise as advice

    if not 0 < tolerance < 1:
        raise WavesymError(f"--tolerance: {tolerance:g} given, a number between 0 and 1 expected")
    found = advice(lower(scene), tolerance)
    return found.json() if format == "json" else found.text()

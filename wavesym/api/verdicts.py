"""What is known of a scene and of the paper: inspections, verdicts, and which model is enough."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from wavesym.errors import WavesymError
from wavesym.programs.request import KINDS, Request
from wavesym.scene import Scene, lower

if TYPE_CHECKING:
    from wavesym.documents.advice import Advice
    from wavesym.mechanics.node import System
    from wavesym.papers.entries import PaperEntry


def verify(
    scenes: Scene | Iterable[Scene],
    evaluator: str | None = None,
    precision: str | None = None,
    runtime: Sequence[str] = (),
    *,
    stream: bool = False,
) -> tuple[str, bool]:
    """Compare programs of scenes with direct integration of what the scenes state, and with exact values.

    Args:
        scenes: each is verified by itself.
        evaluator: "auto", "closed", "pieces", "march" or "modes".
        precision: "double" or "single".
        runtime: names of parameters that come at run time.
        stream: whether loads come sample by sample.
            Without any of these four every program that serves a scene is compared, else those that are meant.

    Returns:
        Tables of errors, and whether all of them are allowed and every output of every scene was seen.

    Raises:
        WavesymError: for a word that there is not, or options that exclude each other.

    >>> import wavesym
    >>> text, passed = wavesym.verify(wavesym.Scene.from_toml("drive_m1"), "march")
    >>> passed
    True
    """
    from wavesym.verification.report import verify as verify_scenes

    each = [scenes] if isinstance(scenes, Scene) else scenes
    kinds = [evaluator] if evaluator else ["auto"] if runtime or stream else KINDS
    requests = [
        Request.from_options(evaluator=kind, precision=precision, runtime=runtime, stream=stream) for kind in kinds
    ]
    some = any((evaluator, precision, runtime, stream))
    in_lines = (scene.in_lines for scene in each)  # as integrators take them
    return verify_scenes(((scene, lower(scene)) for scene in in_lines), requests if some else None)


def verify_derivation(watch: Callable[[list[System]], Iterable[System]] = iter) -> tuple[str, bool]:
    """The proofs of the derivation and other routes to its tables, with their arguments, and whether all of them hold.

    `watch` goes through the systems as they are proved.
    """
    from wavesym.verification.derivation_report import derivation_report

    return derivation_report(watch)


def verify_published(
    format: str = "text",
    names: Sequence[str] = (),
    reproduce: bool = False,
    watch: Callable[[Sequence[PaperEntry]], Iterable[PaperEntry]] = iter,
    only: Sequence[str] = (),
) -> tuple[str, bool]:
    """A verdict on every formula of the paper, or on some.

    Args:
        format: "text", "json", "markdown", "html", "latex", or "fragment": LaTeX to be \\input.
        names: ids of formulas, tables or sections; empty for all.
        reproduce: whether each counterexample comes with a scene that shows it.
        watch: goes through the records as they are judged.
        only: verdicts ("misprint"): no other records are shown; empty for all.

    Returns:
        The text, and whether all could be tested.

    Raises:
        WavesymError: for a name that the paper does not have, and a verdict that there is not.
    """
    from wavesym.papers.verdict_page import verdict_page

    return verdict_page(names, format, reproduce, watch, only)


def advise(scene: Scene, tolerance: float = 0.01) -> Advice:
    """Which model of a scene is enough: massless springs, consistent mass or waves.

    Args:
        scene: what is compared, over its horizon.
        tolerance: what histories may differ by, relative to the largest value of each output.

    Returns:
        `enough`, and the differences of each model in each output; `text()` and `json()` write them.

    Raises:
        WavesymError: for a tolerance that is not between 0 and 1.
        ToleranceError, CostError: where nothing could be generated either.
    """
    from wavesym.methods.advice import advise as advice

    if not 0 < tolerance < 1:
        raise WavesymError(f"--tolerance: {tolerance:g} is not between 0 and 1; write 0.01 for one percent")
    return advice(lower(scene), tolerance)


def inspect(scene: Scene, stage: str | None = None, format: str = "text") -> str:
    """What a stage makes of a scene, or a summary of all of them, as text or json; refusals are part of it.

    Args:
        scene: what is looked at.
        stage: "scene", "model", "laws", "table", "program", or "summary" (None).
        format: "text" or "json".
    """
    from wavesym.documents.inspection.document import SUMMARY, inspection

    return inspection(scene, stage or SUMMARY, format)


def inspect_lines(scene: Scene, stage: str | None, format: str) -> Iterator[str]:
    """The same in parts, as they are known: what the model is before programs are tried."""
    from wavesym.documents.inspection.document import SUMMARY, inspection_lines

    return inspection_lines(scene, stage or SUMMARY, format)

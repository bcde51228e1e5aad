"""The files of a scene: the evaluator that meets its tolerance, in the languages asked for, and the manifest."""

from __future__ import annotations

from collections.abc import Sequence

from wavesym.emission.closed import Reference, c_files, numpy_files
from wavesym.emission.description import describe
from wavesym.emission.manifest import manifest
from wavesym.evaluators.ball import evaluate, largest
from wavesym.evaluators.closed import ClosedForm, closed_form, refuse_beyond
from wavesym.evaluators.contact import contact_ends
from wavesym.evaluators.doubles import above, rational
from wavesym.evaluators.signal import Signal, horizon, signals
from wavesym.scene import Scene

LANGUAGES = {"c": ("c",), "numpy": ("numpy",), "all": ("c", "numpy")}


def files(scene: Scene, language: str = "c", evaluator: str = "auto") -> dict[str, str]:
    """What `generate` writes, by file name. ToleranceError where the evaluator cannot meet the scene's tolerance."""
    merged = signals(scene)
    form = closed_form(merged, horizon(scene))
    refuse_beyond(form, rational(scene.output.tolerance), scene.name)
    reason = f"closed: {len(form.outputs)} outputs, bound {form.error_bound:.1e}"
    description = describe(scene, form, reason, contact_ends(scene))
    made = {f"{scene.name}.json": manifest(scene, description, form)}
    if "c" in LANGUAGES[language]:
        made |= c_files(description, form, _reference(merged, form))
    if "numpy" in LANGUAGES[language]:
        made |= numpy_files(description, form)
    return dict(sorted(made.items()))


def _reference(merged: Sequence[Signal], form: ClosedForm) -> Reference:
    """Values for the self-test: at every arrival, just before it, and between."""
    taus = form.check_points
    sizes = [largest(signal, form.tau_max) for signal in merged]
    return Reference(
        taus,
        [evaluate(signal, taus, form.tau_max) for signal in merged],
        [above(output.bound * size) for output, size in zip(form.outputs, sizes, strict=True)],
    )

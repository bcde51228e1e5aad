"""The files of a scene: the evaluator that meets its tolerance, in the languages asked for, and the manifest."""

from __future__ import annotations

from wavesym.emission import closed, march, pieces
from wavesym.emission.description import describe
from wavesym.emission.manifest import manifest
from wavesym.emission.selftest import selftest
from wavesym.evaluators.choice import choose
from wavesym.evaluators.contact import contact_ends
from wavesym.scene import Scene

LANGUAGES = {"c": ("c",), "numpy": ("numpy",), "all": ("c", "numpy")}
EMITTERS = {"closed": closed, "pieces": pieces, "march": march}


def files(
    scene: Scene,
    language: str = "c",
    evaluator: str = "auto",
    precision: str = "double",
    windows: int | None = None,
) -> dict[str, str]:
    """What `generate` writes, by file name.

    ToleranceError where no evaluator, or not the one asked for, meets the scene's tolerance; CostError where the one
    asked for would cost too much.
    """
    name, chosen, reason = choose(scene, evaluator, precision, windows)
    description = describe(scene, chosen, reason, contact_ends(scene, chosen.real))
    emitter = EMITTERS[name]
    made = {f"{scene.name}.json": manifest(scene, description, chosen, name)}
    if "c" in LANGUAGES[language]:
        made[f"{scene.name}.h"] = emitter.c_header(description, chosen)
        made[f"{scene.name}.c"] = emitter.c_source(description, chosen)
        made[f"{scene.name}_selftest.c"] = selftest(scene, description, chosen)
    if "numpy" in LANGUAGES[language]:
        made[f"{scene.name}.py"] = emitter.numpy_source(description, chosen)
    return dict(sorted(made.items()))

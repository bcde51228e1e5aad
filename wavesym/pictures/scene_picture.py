"""The pictures of a scene, by their kind."""

from __future__ import annotations

from dataclasses import replace

from matplotlib.figure import Figure

from wavesym.mechanics.model import Model
from wavesym.pictures import panels, xt
from wavesym.pictures.groups import notes
from wavesym.pictures.histories import histories
from wavesym.pictures.line_histories import line_histories
from wavesym.pictures.loads import load_histories
from wavesym.pictures.naming import in_readable_units, with_titles
from wavesym.pictures.place_pictures import draw_envelope, draw_map
from wavesym.scene import Scene

KINDS = ("history", "xt", "envelope", "map")


def draw(scene: Scene, model: Model, kind: str) -> tuple[Figure, list[str]]:
    """A picture of a scene.

    Args:
        scene: what is drawn.
        model: the same, lowered.
        kind: "history", "xt", "envelope" or "map".

    Returns:
        The picture, and what it leaves out, line by line.

    Raises:
        ToleranceError, CostError: where nothing could be generated either.
    """
    if kind != "history":
        model.network.refuse_rodless(f"a picture of kind {kind}", "take --kind history")
    if kind == "xt":
        return xt.draw(model, scene.system.lines, scene.physical), []
    if kind == "envelope":
        return draw_envelope(model, line_histories(scene, model)), []
    if kind == "map":
        return draw_map(model, line_histories(scene, model), load_histories(model)), []
    made = histories(with_titles(model))
    made = replace(made, outputs=in_readable_units(made.outputs))
    return panels.draw(made, in_readable_units(load_histories(model))), notes(made)

"""Modes whose numbers are given at run time, with the scene's own numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from wavesym.errors import WavesymError
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.programs.mode_sets.parameters import mode_parameters, names_of
from wavesym.running.mode_sets import ModalSets
from wavesym.scene import Scene
from wavesym.scene.lowering import amplitudes
from wavesym.verification.outcome import ProgramValues


def mode_set_names(model: Model) -> tuple[str, ...]:
    """All numbers that may be given of a damped model, or one without rods; none of another one: marches serve it."""
    if model.damping is None and model.network.bars:
        return ()
    try:
        return (*names_of(model), *(["load"] if model.loads else []))
    except WavesymError:
        return ()


def mode_set_values(
    scene: Scene, model: Model, names: Sequence[str], taus: Array, sizes: Sequence[float], name: str
) -> Iterator[ProgramValues]:
    """Values at `taus`, each relative to the `sizes` of outputs, with the estimate as bound.

    Raises:
        WavesymError: where modes do not serve the model, or these numbers of it.
    """
    parameters = mode_parameters(model, names, amplitudes(scene) if "load" in names else ())
    own = np.array([[nearest(value) for field in parameters.fields for value in field.values]])
    sets = ModalSets(parameters).values(own, taus)
    yield ProgramValues(f"{name}, C", taus, sets.values[0, 0], sizes, [float(sets.estimate[0])] * len(sizes))

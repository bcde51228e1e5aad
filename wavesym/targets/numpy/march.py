"""The march as NumPy."""

from __future__ import annotations

from wavesym.programs.march.evaluator import MarchEvaluator
from wavesym.rendering import render
from wavesym.targets.c.march import Program, march_text
from wavesym.targets.description import Description
from wavesym.targets.literals import literal


def source(scene: Description, evaluator: MarchEvaluator) -> str:
    """NAME.py."""
    return render("numpy/march.py.j2", Program(scene, march_text(scene, evaluator, literal)))

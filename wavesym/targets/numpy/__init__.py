"""Python that imports nothing but NumPy: NAME.py."""

from __future__ import annotations

from wavesym.programs.choice import Made
from wavesym.programs.closed import ClosedForm
from wavesym.programs.march.evaluator import MarchEvaluator
from wavesym.programs.pieces import Pieces
from wavesym.targets.description import Description
from wavesym.targets.numpy import closed, march, pieces


class NumPy:
    """NumPy as a target."""

    name = "numpy"
    tested = False

    def files(self, description: Description, evaluator: Made) -> dict[str, str]:
        match evaluator:
            case ClosedForm():
                text = closed.source(description, evaluator)
            case Pieces():
                text = pieces.source(description, evaluator)
            case MarchEvaluator():
                text = march.source(description, evaluator)
        return {f"{description.name}.py": text}

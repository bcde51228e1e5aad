"""C99 that is C++ too: NAME.h, NAME.c and NAME_selftest.c."""

from __future__ import annotations

from wavesym.programs.choice import Made
from wavesym.programs.closed import ClosedForm
from wavesym.programs.march.evaluator import MarchEvaluator
from wavesym.programs.pieces import Pieces
from wavesym.targets.c import closed, march, pieces
from wavesym.targets.c.header import header
from wavesym.targets.c.selftest import selftest
from wavesym.targets.description import Description


class C:
    """C as a target."""

    name = "c"
    tested = True

    def files(self, description: Description, evaluator: Made) -> dict[str, str]:
        name = description.name
        match evaluator:
            case ClosedForm():
                made = {f"{name}.h": header(description), f"{name}.c": closed.source(description, evaluator)}
            case Pieces():
                made = {f"{name}.h": header(description), f"{name}.c": pieces.source(description, evaluator)}
            case MarchEvaluator():
                streaming = march.streaming(description, evaluator)
                made = {f"{name}.h": header(description, streaming), f"{name}.c": march.source(description, evaluator)}
        if description.reference:
            made[f"{name}_selftest.c"] = selftest(description, evaluator, description.reference)
        return made

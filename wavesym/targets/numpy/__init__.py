"""Python that imports nothing but NumPy: NAME.py, whatever the kind of program."""

from __future__ import annotations

from wavesym.programs.program import Program
from wavesym.targets.description import Description
from wavesym.targets.numpy.program import source
from wavesym.targets.target import Target


class NumPyTarget:
    """NumPy as a target."""

    has_selftest = False

    def files(self, description: Description, program: Program) -> dict[str, str]:
        return {f"{description.name}.py": source(description, program)}


TARGET: Target = NumPyTarget()

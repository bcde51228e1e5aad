"""What a language is to the room: files made of a description and a program."""

from __future__ import annotations

from typing import Protocol

from wavesym.programs.program import Program
from wavesym.targets.description import Description


class Target(Protocol):
    """A language that programs are written in. Each has a folder here, whose name is that of the language."""

    @property
    def has_selftest(self) -> bool:
        """Whether its files contain a self-test, for which `Program.reference` is needed."""

    def files(self, description: Description, program: Program) -> dict[str, str]:
        """Text by file name; without a self-test where the program has no reference values."""

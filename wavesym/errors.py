"""What can go wrong for a user: each error is one line to read and an exit status."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """A question that ends a message, where `word` is nearly one that is known; empty where it is not."""
    from difflib import get_close_matches  # only where something is wrong

    near = get_close_matches(word, list(known), n=1)
    return f'Did you mean "{near[0]}"?' if near else ""


class WavesymError(ValueError):
    """A request that cannot be carried out; `str()` is one line that says why.

    `status` is what the command line exits with: 2 where the request was wrong.
    """

    status: ClassVar[int] = 2


class SceneError(WavesymError):
    """A scene, or another file of the user's, that is not as it should be: `FILE: key.path: what is wrong`."""

    def __init__(self, what: str, path: str = "", file: str = "scene") -> None:
        super().__init__(what, path, file)  # all three, so that the error can be pickled
        self.what, self.path, self.file = what, path, file

    def __str__(self) -> str:
        # a file's name may hold line breaks, and bytes that are no text
        file = self.file if self.file.isprintable() else ascii(self.file)
        return ": ".join(part for part in (file, self.path, self.what) if part)


class CostError(WavesymError):
    """What is asked for would cost too much; the message says how much."""


class RangeError(WavesymError, OverflowError):
    """A number would be beyond the largest one of its floating-point format."""


class ToleranceError(WavesymError):
    """The scene's tolerance cannot be met."""

    status: ClassVar[int] = 1

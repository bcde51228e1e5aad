"""What can go wrong for a user: each error is one line to read and an exit status."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from math import inf
from typing import ClassVar

LONGEST_NAME = 240  # characters of a path, or of what is written without a blank, in a message
MOST_FAULTS = 20
"""So many are shown of a scene: who mends these sees the rest."""


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """A question that ends a message, where `word` is nearly one that is known; empty where it is not."""
    from difflib import get_close_matches  # only where something is wrong

    near = get_close_matches(word, list(known), n=1)
    return f'Did you mean "{near[0]}"?' if near else ""


def printable(text: str) -> str:
    """A text on one line, its line breaks, escape sequences and bytes that are no text written out."""
    return "".join(each if each.isprintable() else ascii(each)[1:-1] for each in text)


def shorten_name(name: str) -> str:
    """A name for a message, such as a path: where it is long without its middle, so that the line can be read."""
    if len(name) <= LONGEST_NAME:
        return name
    start, end = LONGEST_NAME // 3, 2 * LONGEST_NAME // 3
    return f"{name[:start]}...{name[-end:]}"


def shorten_words(line: str) -> str:
    """A line of a message whose names are short: each run of characters without a blank."""
    return re.sub(rf"\S{{{LONGEST_NAME + 1},}}", lambda word: shorten_name(word[0]), line)


class WavesymError(ValueError):
    """A request that cannot be carried out; `str()` is one line that says why. All errors of wavesym are of this kind.

    `status` is what the command line exits with: 2 where the request was wrong.

    >>> import wavesym
    >>> try:
    ...     wavesym.generate(wavesym.Scene.from_toml("drive_m1"), "out", language="fortran")
    ... except wavesym.WavesymError as error:
    ...     print(error)
    language: fortran is unknown; write c, numpy or all
    """

    status: ClassVar[int] = 2

    @property
    def lines(self) -> list[str]:
        """What to show of it, line by line."""
        return [" ".join(str(self).split())]


class SceneError(WavesymError):
    """A scene, or another file of the user's, that is not as it should be: `FILE: key.path: what is wrong (line N)`.

    The parts are `file`, `path`, `what` and `line` (0 where there is none) of the first fault; `others` are the rest,
    and `lines` says all of them.

    >>> import wavesym
    >>> try:
    ...     wavesym.Scene.from_toml("drive_m1").with_({"system.kappa[0]": -1})
    ... except wavesym.SceneError as error:
    ...     print(error.path)
    ...     print(error.what)
    system.kappa[0]
    -1 is not positive; write a number above 0
    """

    def __init__(
        self, what: str, path: str = "", file: str = "scene", line: int = 0, others: Sequence[SceneError] = ()
    ) -> None:
        super().__init__(what, path, file, line, others)  # all of them, so that the error can be pickled
        self.what, self.path, self.file, self.line, self.others = what, path, file, line, others

    def __str__(self) -> str:
        return "\n".join(self.lines)

    @property
    def lines(self) -> list[str]:
        """A line for each fault, the first of many."""
        line = f"(line {self.line})" if self.line else ""
        # a file's name may hold line breaks, and bytes that are no text
        file = printable(shorten_name(self.file))
        what = ": ".join(part for part in (file, self.path, f"{self.what} {line}".rstrip()) if part)
        shown = [text for other in self.others[: MOST_FAULTS - 1] for text in other.lines]
        more = len(self.others) - len(shown)
        return [what, *shown, *([f"{file}: and {more} more faults"] if more else [])]

    def in_file(self, file: str, line_of: Callable[[str], int] = lambda _: 0) -> SceneError:
        """The same of a file; `line_of` says on which of its lines a path stands. Faults come in the file's order."""
        every = [SceneError(each.what, each.path, file, line_of(each.path)) for each in (self, *self.others)]
        first, *others = sorted(every, key=lambda each: each.line)
        return SceneError(first.what, first.path, file, first.line, tuple(others))


class CostError(WavesymError):
    """What is asked for would take minutes or fill the memory; the message says how much, and what would help.

    >>> import wavesym
    >>> scene = wavesym.Scene.from_toml("building_m2").with_({"output.until": 10**6})
    >>> try:
    ...     wavesym.evaluator(scene)([1.0])
    ... except wavesym.CostError as error:
    ...     print(error)
    output.until: 3 nodes times 1e+06 units of tau are 3e+06 stretches to keep, the limit is 20000 (a \
shorter horizon helps)
    """


class UnservedError(WavesymError):
    """What one method does not do for a kind of scene, whatever the cost; others may. The message says which do.

    >>> import wavesym
    >>> try:
    ...     wavesym.generate(wavesym.Scene.from_toml("drive_m1"), "out", evaluator="modes")
    ... except wavesym.UnservedError as error:
    ...     print(error)
    load: M1 jumps by 1 at tau = 0, and modes support no jump (write a steep ramp, or `start`, one spacing, of a \
record; or --stream --step)
    """


class SpacingError(CostError):
    """Instants of loads that fit into no window of a march; it may be that a march of one hat serves them."""


class MeasureError(CostError):
    """Travel times without a common measure that is long enough; `helps` is what to write for one."""

    def __init__(self, message: str, helps: str = "") -> None:
        super().__init__(message)
        self.helps = helps


class WindowsError(CostError):
    """A march of more windows than can be computed: a longer common measure of travel times, or less time, helps."""


class RangeError(WavesymError, OverflowError):
    """A number would be beyond the largest one of its floating-point format.

    >>> import wavesym
    >>> strong = {"body": 1, "times": [0], "steps": ["1e50"]}
    >>> scene = wavesym.Scene.from_toml("drive_m1").with_({"load": [strong]})
    >>> try:
    ...     wavesym.generate(scene, "out", evaluator="pieces", precision="single")
    ... except wavesym.RangeError as error:
    ...     print(error)
    output: pieces needs numbers beyond the range of single precision
    """


class ToleranceError(WavesymError):
    """The scene's tolerance cannot be met; the message says which could be, and last why no program meets this one.

    >>> import wavesym
    >>> scene = wavesym.Scene.from_toml("drive_m1").with_({"output.tolerance": "1e-20"})
    >>> try:
    ...     wavesym.generate(scene, "out", evaluator="pieces")
    ... except wavesym.ToleranceError as error:
    ...     print(error)
    output.tolerance: 1e-20 cannot be met; write 8e-16 or more (pieces: rounding leaves a bound of 4e-16 for strain@0)

    Args:
        message: the line that is shown.
        refusal: why the one program is refused that the error is of.
        bound: of the error that this program has instead, relative to an output's largest value; infinite for none.
    """

    status: ClassVar[int] = 1

    def __init__(self, message: str, refusal: str = "", bound: float = inf) -> None:
        super().__init__(message)
        self.refusal, self.bound = refusal, bound


def install_command(extra: str) -> str:
    """What brings an extra of wavesym, from any folder: from its source where that is installed, else by its name."""
    import json
    from importlib.metadata import PackageNotFoundError, distribution
    from urllib.parse import unquote, urlsplit

    try:
        origin = json.loads(distribution("wavesym").read_text("direct_url.json") or "{}")
    except (PackageNotFoundError, ValueError):
        origin = {}
    if origin.get("dir_info", {}).get("editable"):
        return f"pip install -e '{unquote(urlsplit(origin['url']).path)}[{extra}]'"
    return f"pip install 'wavesym[{extra}]'"

"""How files that were written differ from what would be."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import unified_diff
from pathlib import Path


@dataclass(frozen=True)
class Difference:
    """Between files as they should be, by path, and those that are `found`."""

    texts: Mapping[Path, str]
    paths: Iterable[Path]

    def report(self, command: Sequence[str]) -> str:
        """What is changed, missing or orphaned, with diffs, and what mends it; empty where there is nothing.

        `command` writes the files anew; orphans must be removed.
        """
        found = set(self.paths)
        orphans = sorted(str(path) for path in found - self.texts.keys())
        lines: list[str] = []
        stale = False
        for path in sorted(self.texts.keys() | found):
            if path not in self.texts:
                lines.append(f"orphaned: {path}\n")
                continue
            old = path.read_bytes() if path in found else b""
            if path not in found or old != self.texts[path].encode():
                stale = True
                lines.append(f"{'changed' if path in found else 'missing'}: {path}\n")
                lines += _diff(old.decode("utf-8", "backslashreplace"), self.texts[path], str(path))
        mending = [["rm", "--", *orphans]] * bool(orphans) + [list(command)] * stale
        if mending:
            lines.append(f"to mend: {' && '.join(map(shlex.join, mending))}\n")
        return "".join(lines)


def _diff(old: str, new: str, path: str) -> Iterator[str]:
    for line in unified_diff(_lines(old), _lines(new), path, "as generated"):
        yield line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n"


def _lines(text: str) -> list[str]:
    """Lines with their ends; nothing but "\\n" ends one."""
    *whole, last = text.split("\n")
    return [f"{line}\n" for line in whole] + [last] * bool(last)

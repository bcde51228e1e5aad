"""python -m tools.bench FOLDER [SECTION ...]: measure its scenes, or those sections alone; writes README.md."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

from tools.bench.report import report, sections


def measure(lines: Iterable[str]) -> str:
    """Each line as soon as it is measured, printed: what takes minutes is seen to go on."""
    found = []
    for line in lines:
        print(line, flush=True)
        found.append(f"{line}\n")
    return "".join(found)


def replace_section(page: str, section: str) -> str:
    """A page with a section, which its title begins, in the place of the one under the same title."""
    title, _, _ = section.partition("\n")
    before, found, after = page.partition(f"{title}\n")
    if not found:
        raise SystemExit(f"{title}: no such section on the page; measure the whole page")
    _, following, rest = after.partition("\n## ")
    return before + section + following + rest


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    page = folder / "README.md"
    if unknown := set(sys.argv[2:]) - sections().keys():
        raise SystemExit(f"{', '.join(sorted(unknown))}: one or more of {', '.join(sections())} expected")
    if not sys.argv[2:]:
        page.write_text(measure(report(folder)), encoding="utf-8")
    for name in sys.argv[2:]:
        section = measure(sections()[name](folder))
        page.write_text(replace_section(page.read_text(encoding="utf-8"), section), encoding="utf-8")

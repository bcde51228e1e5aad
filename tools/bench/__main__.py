"""python -m tools.bench FOLDER [corners|frames|vibration]: measure its scenes, or that part alone; writes README.md."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

from tools.bench import corners, frames, vibration
from tools.bench.report import corner_figures, frame_figures, report, vibration_figures


def measure(lines: Iterable[str]) -> str:
    """Each line as soon as it is measured, printed: what takes minutes is seen to go on."""
    found = []
    for line in lines:
        print(line, flush=True)
        found.append(f"{line}\n")
    return "".join(found)


def replace_section(page: str, title: str, section: str, following: str) -> str:
    """A page with another section of a title; where it has none, before the one that is following."""
    before, _, after = page.partition(f"{following}\n")
    return f"{before.partition(title)[0]}{section}\n{following}\n{after}"


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    page = folder / "README.md"
    if sys.argv[2:] == ["corners"]:
        section = measure(corner_figures(folder.parent / "examples" / "corners"))
        text = replace_section(page.read_text(encoding="utf-8"), corners.TITLE, section, "## Charts")
    elif sys.argv[2:] == ["frames"]:
        section = measure(frame_figures(folder.parent / "examples" / "records"))
        text = replace_section(page.read_text(encoding="utf-8"), frames.TITLE, section, vibration.TITLE)
    elif sys.argv[2:] == ["vibration"]:
        section = measure(vibration_figures(folder.parent / "examples" / "records"))
        text = replace_section(page.read_text(encoding="utf-8"), vibration.TITLE, section, corners.TITLE)
    else:
        text = measure(report(folder))
    page.write_text(text, encoding="utf-8")

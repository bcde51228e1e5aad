"""python -m tools.bench FOLDER: measure all on the scenes in it, and write its README.md."""

from __future__ import annotations

import sys
from pathlib import Path

from tools.bench.report import report

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    lines = []
    for line in report(folder):  # each as soon as it is measured: what takes minutes is seen to go on
        print(line, flush=True)
        lines.append(f"{line}\n")
    Path(folder, "README.md").write_text("".join(lines), encoding="utf-8")

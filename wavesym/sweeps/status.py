"""What is done of a sweep, from its manifest and marks alone."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from wavesym.errors import WavesymError
from wavesym.sweeps.manifest import read
from wavesym.sweeps.marks import Marks


@dataclass(frozen=True)
class SweepStatus:
    """How many cases there are, are done, have failed and are left; of each that failed its values and the reason."""

    cases: int
    done: int
    failed: int
    left: int
    reasons: tuple[dict[str, Any], ...]

    @property
    def line(self) -> str:
        """The counts."""
        return f"{self.cases} cases: {self.done} done, {self.failed} failed, {self.left} left"

    def text(self) -> str:
        """The counts, and a line for each case that failed."""
        lines = [self.line]
        for each in self.reasons:
            values = ", ".join(f"{path} = {value}" for path, value in each["values"].items())
            lines.append(f"case {each['case']} ({values}): {each['reason']}")
        return "\n".join(lines) + "\n"

    def json(self) -> str:
        """The same for programs."""
        return json.dumps(asdict(self), indent=1) + "\n"


def status(folder: Path) -> SweepStatus:
    """The state of the sweep in a folder. WavesymError where there is none."""
    manifest = read(folder)
    if manifest is None:
        raise WavesymError(f"{folder}: no manifest.json in it, the folder of a sweep expected")
    marks = list(Marks(folder).every())
    reasons = tuple(failure for mark in marks for failure in mark["failed"])
    met = sum(mark["cases"] for mark in marks)
    return SweepStatus(manifest["cases"], met - len(reasons), len(reasons), manifest["cases"] - met, reasons)

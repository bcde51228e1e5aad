"""What is done of a sweep, from its manifest and marks alone."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from wavesym.errors import printable
from wavesym.sweeps.manifest import Manifest
from wavesym.sweeps.marks import BatchMark, Marks
from wavesym.sweeps.sealed_files import DamagedError, NoFileError

_ADJUSTED = "speeds of waves are changed in each case by itself, by system.speed_adjustment at most"


@dataclass(frozen=True)
class SweepStatus:
    """How many cases there are, are done, have failed and are left; of each that failed its values and the reason.

    `notes` say what was changed of each case.
    """

    cases: int
    done: int
    failed: int
    left: int
    reasons: tuple[dict[str, Any], ...]
    notes: tuple[str, ...] = ()

    @property
    def line(self) -> str:
        """The counts, and the notes."""
        counts = f"{self.cases} cases: {self.done} done, {self.failed} failed, {self.left} left"
        return "; ".join([counts, *self.notes])

    def text(self) -> str:
        """The counts, and a line for each case that failed."""
        lines = [self.line]
        for each in self.reasons:
            values = ", ".join(f"{path} = {value}" for path, value in each["values"].items())
            lines.append(printable(f"case {each['case']} ({values}): {each['reason']}"))
        return "\n".join(lines) + "\n"

    def json(self) -> str:
        """The same for programs."""
        return json.dumps(asdict(self), indent=1) + "\n"


def status(folder: Path) -> SweepStatus:
    """The state of the sweep in a folder. WavesymError where there is none; DamagedError for damaged marks."""
    manifest = Manifest.read_folder(folder)
    return status_of(manifest, marks_of(folder, manifest))


def status_of(manifest: Manifest, marks: Mapping[int, BatchMark]) -> SweepStatus:
    """The state of a sweep with some marks."""
    reasons = tuple(failure.model_dump() for mark in marks.values() for failure in mark.failed)
    met = sum(mark.cases - len(mark.left) for mark in marks.values())
    notes = (_ADJUSTED,) * ("speed_adjustment" in manifest.scene["system"])
    return SweepStatus(manifest.cases, met - len(reasons), len(reasons), manifest.cases - met, reasons, notes)


def marks_of(folder: Path, manifest: Manifest) -> dict[int, BatchMark]:
    """The marks of a sweep, by batch. DamagedError for those that are not as they were written."""
    kept, batches = Marks(folder), manifest.batches
    found: dict[int, BatchMark] = {}
    wrong = {}
    for batch in range(len(batches)):
        name = batches.mark(manifest.sha256, batch)
        try:
            mark = kept.get(name, batches, batch)
        except NoFileError:
            raise
        except DamagedError:
            wrong[batch] = kept.path(name).relative_to(folder).as_posix()
            continue
        if mark:
            found[batch] = mark
    if wrong:
        raise damage(folder, list(wrong.values()), sum(map(batches.count, wrong)), manifest.cases)
    return found


def damage(folder: Path, files: Sequence[str], cases: int, of: int) -> DamagedError:
    """The error that says which files of a folder are damaged, how many cases that concerns, and what helps."""
    more = f" and {len(files) - 1} files more" if len(files) > 1 else ""
    what = f"{cases} of {of} cases have to be computed again" if cases else "no case has to be computed again"
    return DamagedError(f"{folder}: {files[0]}{more} damaged; {what} (wavesym sweep SWEEP -o {folder} mends it)")

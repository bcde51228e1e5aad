"""Marks of what is done: a file for each batch, named by a hash of all that goes in, put in its place by rename."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pydantic import Field

from wavesym.sweeps.batches import Batches
from wavesym.sweeps.sealed_files import DamagedError, SealedFile, Sha256, StrictTable

FOLDER = "done"


class FailedCase(StrictTable):
    """A case that failed: its number, its values by path, and the reason."""

    case: int
    values: dict[str, str]
    reason: str


class BatchMark(SealedFile):
    """What has come of a batch of so many `cases`: hashes of its `chunks` by array (None: no file, all NaN), how cases
    were computed, those that `failed`, and the numbers of those that are `left`, where it is done in part.

    While chunks are replaced, as more cases come, each is what it was or what is `coming`: both hold what is done.
    """

    batch: int
    cases: int
    chunks: dict[str, Sha256 | None]
    how: dict[str, int]
    failed: list[FailedCase]
    left: list[int]
    coming: dict[str, Sha256 | None] = Field(default_factory=dict)

    def allowed_hashes(self, name: str) -> set[str | None]:
        """The hashes that the chunk of an array may have."""
        return {each[name] for each in (self.chunks, self.coming) if name in each}

    def is_of(self, batches: Batches, batch: int) -> bool:
        """Whether it speaks of a batch: of as many cases, each at most once, and of no others."""
        said = [*self.left, *(each.case for each in self.failed)]
        return (
            (self.batch, self.cases) == (batch, batches.count(batch))
            and len(set(said)) == len(said)
            and all(batches.holds(batch, case) for case in said)
        )


@dataclass(frozen=True)
class Marks:
    """The marks in the folder of a sweep."""

    folder: Path

    def path(self, name: str) -> Path:
        """Of the mark of a batch."""
        return self.folder / FOLDER / f"{name}.json"

    def put(self, name: str, mark: BatchMark) -> None:
        """Mark a batch as done."""
        mark.put(self.path(name))

    def remove(self, name: str) -> None:
        """Say no more that a batch is done."""
        self.path(name).unlink(missing_ok=True)

    def get(self, name: str, batches: Batches, batch: int) -> BatchMark | None:
        """The mark of a batch; None where there is none. DamagedError for one that the disk has not kept."""
        mark = BatchMark.read(self.path(name))
        if mark and not mark.is_of(batches, batch):
            raise DamagedError(f"{self.path(name)}: damaged")
        return mark

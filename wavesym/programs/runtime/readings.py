"""Which strands of a section are read together: those at the same instants, so that all share the T_k(u) there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import NamedTuple, Protocol

from flint import fmpq

from wavesym.programs.flat import firsts


class ReadStrand(Protocol):
    """A strand of an output, as in `Strand`; u depends on its start and half."""

    @property
    def output(self) -> int: ...

    @property
    def start(self) -> fmpq: ...

    @property
    def half(self) -> fmpq: ...


class SharedReading(NamedTuple):
    """So many strands from one on, each of another output; `more` where one before is of these outputs, too."""

    strand: int
    strands: int
    more: bool


def readings(strands: Sequence[ReadStrand], heard: Sequence[int]) -> Iterator[SharedReading]:
    """Those of a section, of which `heard` are the strands, in order: those at the same instants follow each other."""
    outputs: set[int] = set()
    told = []
    for number in heard:
        strand = strands[number]
        told.append((strand.start, strand.half, strand.output in outputs))
        outputs.add(strand.output)
    for (*_, more), group in groupby(zip(told, heard, strict=True), key=lambda each: each[0]):
        numbers = [number for _, number in group]
        yield SharedReading(numbers[0], len(numbers), more)


def reading_tables(
    strands: Sequence[ReadStrand], sections: Sequence[Sequence[Sequence[int]]]
) -> dict[str, tuple[int, ...]]:
    """Tables of the readings of all sections, of which each is the strands of every output."""
    found = [list(readings(strands, sorted(number for output in heard for number in output))) for heard in sections]
    every = [reading for section in found for reading in section]
    return {
        "strand_output": tuple(strand.output for strand in strands),
        "first_reading": firsts(map(len, found)),
        "reading_strand": tuple(reading.strand for reading in every),
        "reading_strands": tuple(reading.strands for reading in every),
        "reading_more": tuple(int(reading.more) for reading in every),
    }

"""What is being done, on a terminal, for whatever takes more than two seconds: one line, gone when it is done."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from threading import Event, Thread
from time import monotonic
from typing import TypeVar

import click

T = TypeVar("T")

QUIET, STEP = 2.0, 0.5
"""Seconds until there is a line, and between two states of it."""

_WIDTH = 80  # of a terminal that does not say


class Progress:
    """A line on standard error that says `what` is being done, and for how many seconds."""

    def __init__(self, what: str) -> None:
        self.what = self._doing = what

    def tell(self, step: str) -> None:
        """The step that is taken now."""
        self._doing = f"{self.what}: {step}"

    def each(self, items: Sequence[T], name: Callable[[T], str]) -> Iterator[T]:
        """The items, each told by its name and number when it is taken."""
        for number, item in enumerate(items, 1):
            self.tell(f"{name(item)}, {number} of {len(items)}")
            yield item

    def show(self, done: Event) -> None:
        """Rewrite the line until `done`, and take it away; nothing is written where that is soon."""
        start = monotonic()
        if done.wait(QUIET):
            return
        # never the last column, where terminals go on to the next line
        width = _columns() - 1
        with suppress(OSError):  # of a terminal that has gone
            while not done.is_set():
                line = f"{self._doing} ({monotonic() - start:.0f} s)"
                click.echo(f"\r{line[:width]:{width}}", nl=False, err=True)
                done.wait(STEP)
            click.echo(f"\r{'':{width}}\r", nl=False, err=True)


@contextmanager
def progress(what: str) -> Iterator[Progress]:
    """Show a line while the body runs, on a terminal. The body must put nothing out itself."""
    line = Progress(what)
    if sys.stderr is None or not sys.stderr.isatty():
        yield line
        return
    done = Event()
    shower = Thread(target=line.show, args=(done,), daemon=True)
    shower.start()
    try:
        yield line
    finally:
        done.set()
        shower.join()


def _columns() -> int:
    with suppress(OSError, ValueError):
        return os.get_terminal_size(sys.stderr.fileno()).columns or _WIDTH
    return _WIDTH

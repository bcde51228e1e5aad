"""What is being done, on a terminal, for whatever takes more than two seconds: one line, gone when it is done."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from threading import Event, Thread
from time import monotonic
from typing import TypeVar

T = TypeVar("T")

QUIET, STEP = 2.0, 0.5
"""Seconds until there is a line, and between two states of it."""

LONG = 10.0
"""Seconds that are worth a line where there is no terminal, too."""

_WIDTH = 80  # of a terminal that does not say


class Progress:
    """A line on standard error that says `what` is being done, and for how many seconds."""

    def __init__(self, what: str) -> None:
        self.what = self._doing = what
        self._detail = ""
        self._warned: set[str] = set()
        self._start = monotonic()

    def tell(self, step: str) -> None:
        """The step that is taken now."""
        self._doing, self._detail = f"{self.what}: {step}", ""

    def tell_detail(self, detail: str) -> None:
        """How far that step has come."""
        self._detail = f", {detail}"

    def warn(self, text: str, about: str) -> None:
        """A line that stays, on a terminal or not: why this takes long. Only the first one about a thing is written."""
        if about not in self._warned:
            self._warned.add(about)
            with suppress(OSError):
                _put(f"{chr(13) * sys.stderr.isatty()}{self.what}: {text}\n")

    def count(self, cases: int, done: int, before: int) -> None:
        """How many cases are done, `before` of them before this line; how fast, and how long the rest will take."""
        step = f"{done} of {cases} cases"
        if done > before:
            rate = (done - before) / (monotonic() - self._start)
            step += f", {rate:.3g} a second, about {(cases - done) / rate:.0f} s left"
        self.tell(step)

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
                line = f"{self._doing}{self._detail} ({monotonic() - start:.0f} s)"
                _put(f"\r{line[:width]:{width}}")
                done.wait(STEP)
            _put(f"\r{'':{width}}\r")


_running: list[Progress] = []


@contextmanager
def progress(what: str) -> Iterator[Progress]:
    """Show a line while the body runs, on a terminal. The body must put nothing out itself."""
    line = Progress(what)
    done = Event()
    shower = Thread(target=line.show, args=(done,), daemon=True)
    shown = sys.stderr is not None and sys.stderr.isatty()
    if shown:
        shower.start()
    _running.append(line)
    try:
        yield line
    finally:
        _running.remove(line)
        done.set()
        if shown:
            shower.join()


def tell_detail(detail: str) -> None:
    """How far what takes long has come, on the line that is shown, if there is one."""
    if _running:
        _running[-1].tell_detail(detail)


def warn_long(text: str, about: str = "") -> None:
    """Say why what is being done takes long, once, wherever standard error leads; nothing where no command does it."""
    if _running and sys.stderr is not None:
        _running[-1].warn(text, about)


def warn_count(count: int, what: str, seconds: float, helps: str) -> None:
    """Say about how long so many take, at `seconds` each, where that is long; `helps` is what takes less."""
    if (total := count * seconds) > LONG:
        warn_long(f"{count} {what} take about {total:.0f} s ({helps})", what)


def warn_part(part: float, seconds: float, what: str, helps: str) -> None:
    """The same of what takes so many `seconds` for a part of it, as soon as these tell something."""
    if seconds > QUIET and part > 0 and (total := seconds / part) > LONG:
        warn_long(f"{what} takes about {total:.0f} s ({helps})", what)


def _put(text: str) -> None:
    sys.stderr.write(text)
    sys.stderr.flush()


def _columns() -> int:
    with suppress(OSError, ValueError):
        return os.get_terminal_size(sys.stderr.fileno()).columns or _WIDTH
    return _WIDTH

"""The line that says what is being done: on a terminal, after a while, gone at the end; nowhere else."""

from __future__ import annotations

import os
import re
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

import pytest

from tests.papers.small import Paper
from wavesym import progress
from wavesym.cli import main
from wavesym.exact.contacts import schedule
from wavesym.exact.contacts.events import events
from wavesym.papers import verdict_page
from wavesym.papers.entries import PaperEntry
from wavesym.papers.record import Record
from wavesym.results import frequency_response, rows
from wavesym.results.response import Response
from wavesym.scene import Scene, lower

pty = pytest.importorskip("pty", reason="no terminals to open here")


class Slow(Paper):
    """A small paper, each record of which takes a while."""

    @staticmethod
    def records(
        wanted: Sequence[PaperEntry] | None = None, watch: Callable[[Sequence[PaperEntry]], Iterable[PaperEntry]] = iter
    ) -> tuple[Record, ...]:
        def waiting(entries: Sequence[PaperEntry]) -> Iterator[PaperEntry]:
            for entry in watch(entries):
                time.sleep(0.02)
                yield entry

        return Paper.records(wanted, waiting)


class Terminal:
    """A terminal that a test opens, and what has been written to it so far."""

    _END = "\0"  # written last: what is still under way when a terminal is closed may be lost

    def __init__(self) -> None:
        self._reading, writing = pty.openpty()
        self.stream = os.fdopen(writing, "w", buffering=1)
        self.written = ""
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        while not self.written.endswith(self._END):
            self.written += os.read(self._reading, 1 << 16).decode()

    def close(self) -> str:
        """Everything that was written."""
        self.stream.write(self._END)
        self.stream.flush()
        self._reader.join()
        self.stream.close()
        os.close(self._reading)
        return self.written.removesuffix(self._END)


def screen(written: str) -> list[str]:
    """What is seen on a terminal after that: a carriage return goes back, and what comes then is written over."""
    lines = []
    for line in written.split("\r\n"):
        seen = ""
        for part in line.split("\r"):
            seen = part + seen[len(part) :]
        lines.append(seen.rstrip())
    return lines


def format_value(written: str) -> list[str]:
    """The states of the line, one after the other."""
    return [part.rstrip() for part in written.split("\r") if part.strip()]


@pytest.fixture
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "QUIET", 0.05)
    monkeypatch.setattr(progress, "STEP", 0.01)


def opened(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """A terminal in the place of standard error."""
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal.stream)
    return terminal


def work(seconds: float = 0.1, failing: bool = False) -> None:
    with progress.progress("work") as line:
        for _ in line.each("abc", str.upper):
            time.sleep(seconds)
        if failing:
            raise ValueError("wrong")


def test_it_tells_the_steps_and_is_gone_at_the_end(soon: None, monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = opened(monkeypatch)
    work()
    print("done", file=sys.stderr)
    written = terminal.close()
    assert screen(written) == ["done", ""]
    told = [line.partition(" (")[0] for line in format_value(written)]
    assert list(dict.fromkeys(told)) == ["work: A, 1 of 3", "work: B, 2 of 3", "work: C, 3 of 3", "done"]


def test_what_is_not_taken_away_would_be_seen() -> None:
    assert screen("\rwork (2 s)   \rdone\r\n") == ["done (2 s)", ""]


def test_it_says_nothing_before_two_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = opened(monkeypatch)
    assert progress.QUIET == 2
    work(seconds=0.01)
    assert terminal.close() == ""


def test_it_is_gone_before_an_error_is_told(soon: None, monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = opened(monkeypatch)
    with pytest.raises(ValueError, match="wrong"):
        work(failing=True)
    print("wrong", file=sys.stderr)
    written = terminal.close()
    assert "work" in written
    assert screen(written) == ["wrong", ""]


def test_a_line_too_long_for_the_terminal_is_cut(soon: None, monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = opened(monkeypatch)
    monkeypatch.setattr(progress, "_columns", lambda: 20)
    with progress.progress("a" * 99):
        time.sleep(0.1)
    assert set(format_value(terminal.close())) == {"a" * 19}


def test_a_terminal_that_has_gone_stops_nothing(soon: None, monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = opened(monkeypatch)
    monkeypatch.setattr(progress, "_put", gone)
    work()
    assert terminal.close() == ""


def gone(*_: object, **__: object) -> None:
    raise OSError(5, "Input/output error")


def test_it_is_quiet_where_there_is_no_terminal(soon: None, capsys: pytest.CaptureFixture[str]) -> None:
    work()
    assert capsys.readouterr() == ("", "")


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("arguments", "step"),
    [
        (["generate", "drive_m1", "-o", "made"], "generate drive_m1"),
        (["generate", "drive_m1", "-o", "made", "--check"], "check drive_m1"),
        (["run", "collision_m4", "--samples", "3"], "run collision_m4"),
        (["tables", "drive_m1", "--symbolic"], "tables drive_m1"),
        (["derive", "drive"], "derive drive"),
        pytest.param(["verify", "drive_m1"], "verify: drive_m1, 1 of 1", marks=pytest.mark.slow),
        (["verify", "--published"], "verify: "),
        (["plot", "drive_m1", "-o", "made.svg"], "plot drive_m1"),
    ],
)
def test_commands_put_out_the_same_with_it_and_without(
    arguments: list[str],
    step: str,
    tmp_path_factory: pytest.TempPathFactory,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(verdict_page, "paper", Slow)  # ours takes longer, and no other way
    monkeypatch.chdir(tmp_path_factory.mktemp("pipe"))
    status = main(arguments)
    out, aside = capsys.readouterr()
    monkeypatch.chdir(tmp_path_factory.mktemp("terminal"))
    monkeypatch.setattr(progress, "QUIET", 0.0)
    monkeypatch.setattr(progress, "STEP", 0.001)
    terminal = opened(monkeypatch)
    assert main(arguments) == status
    written = terminal.close()
    assert capsys.readouterr().out == out
    assert screen(written) == aside.split("\n")
    assert any(line.startswith(step) for line in format_value(written))


def test_it_says_how_far_the_search_for_events_has_come(soon: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten slips of a mass under a load that turns: the search is never silent for long."""
    terminal = opened(monkeypatch)
    scene = Scene(
        name="slips",
        system={"type": "chain", "parts": ["fixed", {"spring": 1}, {"mass": 1, "friction": "1/4", "name": "n"}]},
        load=[{"at": "n", "times": list(range(8)), "steps": [1, *[-2, 2] * 3, -1]}],
        output={"until": 8, "velocity": ["n"]},
    )
    with progress.progress("run slips"):
        events(lower(scene))
    told = [
        float(part)
        for part in re.findall(r"run slips, events up to (\d+)% of the time, with \d+ bits", terminal.close())
    ]
    assert told
    assert told == sorted(told)


def test_many_instants_say_how_long_they_take_where_there_is_no_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Once, before they are computed; a few are not worth a line."""
    times = tmp_path / "times"
    times.write_text("0.25\n" * 12)
    monkeypatch.setattr(rows, "_AT_ONCE", 5)
    command = ["run", "drive_m1", "--at", str(times), "-o", str(tmp_path / "out.csv")]
    assert main(command) == 0
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(progress, "LONG", 0.0)
    assert main(command) == 0
    assert re.fullmatch(
        r"run drive_m1: 12 instants of 5 outputs, right to the last bit, take about \d+ s \(.*`generate`\)\n",
        capsys.readouterr().err,
    )


def test_a_long_search_for_events_says_how_long_it_takes_where_there_is_no_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Before there is any other line, which said only how long values take after it."""
    parts = [{"mass": 1, "velocity": 1, "friction": "1/4", "name": "m"}, {"rod": 1}, "fixed"]
    scene = Scene(name="slides", system={"type": "chain", "parts": parts}, output={"until": 3, "velocity": ["m"]})
    with progress.progress("run slides"):
        events(lower(scene))
    assert capsys.readouterr().err == ""
    schedule.outcome.cache_clear()
    monkeypatch.setattr(progress, "LONG", 0.0)
    monkeypatch.setattr(progress, "QUIET", 0.0)
    with progress.progress("run slides"):
        events(lower(scene))
        rows.csv_lines(Response(lower(scene)), 3, None)
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 2
    assert re.fullmatch(r"run slides: to find all events takes about \d+ s \(a shorter horizon takes less\)", told[0])
    assert told[1].startswith("run slides: 3 instants of 1 outputs")


def test_how_many_instants_are_done_is_seen(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, soon: None) -> None:
    """Also where lines go to standard output, and that is a file."""
    monkeypatch.setattr(rows, "_AT_ONCE", 5)
    made = rows._rows

    def slowly(*given: object) -> list[str]:
        time.sleep(0.04)
        return made(*given)

    monkeypatch.setattr(rows, "_rows", slowly)
    for more in (["-o", str(tmp_path / "out.csv")], []):
        terminal = opened(monkeypatch)
        with (tmp_path / "standard").open("w") as standard:
            monkeypatch.setattr(sys, "stdout", standard)
            assert main(["run", "drive_m1", "--samples", "23", *more]) == 0
        written = terminal.close()
        assert re.search(r"run drive_m1, (5|10|15|20) of 23 instants \(0 s\)", written), written
        assert screen(written) == [""]
    assert (tmp_path / "standard").read_text() == (tmp_path / "out.csv").read_text()


def test_many_frequencies_say_how_long_they_take(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr(frequency_response, "_OFTEN", 5)
    command = ["frf", "building_m2", "--points", "12", "--to", "5", "-o", str(tmp_path / "out.csv")]
    assert main(command) == 0
    assert " take about " not in capsys.readouterr().err
    monkeypatch.setattr(progress, "LONG", 0.0)
    assert main(command) == 0
    told = [line for line in capsys.readouterr().err.splitlines() if " take about " in line]
    assert len(told) == 1
    assert re.fullmatch(r"frf building_m2: 12 frequencies take about \d+ s \(fewer take less\)", told[0])

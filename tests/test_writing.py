"""Files are written whole or not at all."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from wavesym.writing import write_whole


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_writes_texts_and_chunks_and_makes_folders(tmp_path: Path) -> None:
    write_whole({tmp_path / "a.txt": "one\ntwo\n", tmp_path / "new" / "b.txt": iter(["\u03ba", "\n"])})
    assert (tmp_path / "a.txt").read_bytes() == b"one\ntwo\n"
    assert (tmp_path / "new" / "b.txt").read_bytes() == b"\xce\xba\n"
    assert names(tmp_path) == ["a.txt", "new"]


def test_a_failure_leaves_everything_as_it_was(tmp_path: Path) -> None:
    def failing() -> Iterator[str]:
        yield "half"
        raise RuntimeError("no more")

    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(RuntimeError):
        write_whole({tmp_path / "a.txt": "new", tmp_path / "b.txt": failing()})
    assert (tmp_path / "a.txt").read_text() == "old"
    assert names(tmp_path) == ["a.txt"]


def test_a_folder_in_the_way_is_seen_before_anything_is_written(tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    with pytest.raises(IsADirectoryError):
        write_whole({tmp_path / "a": "new", tmp_path / "b": "new"})
    assert names(tmp_path) == ["b"]


@pytest.mark.skipif(os.name == "nt", reason="links and devices are of another kind there")
def test_links_and_devices_stay_what_they_are(tmp_path: Path) -> None:
    (tmp_path / "target").write_text("old")
    link = tmp_path / "link"
    link.symlink_to("target")
    write_whole({link: "new", Path(os.devnull): "gone"})
    assert link.is_symlink()
    assert (tmp_path / "target").read_text() == "new"
    assert Path(os.devnull).is_char_device()


OLD = {"a.txt": "old a", "b.txt": "old b", "c.txt": "old c"}
NEW = {name: f"new {name}" * 100 for name in OLD}


def written_in_a_process(folder: Path, prepare: str) -> int:
    """The exit status of a process that writes NEW over OLD, after `prepare`."""
    for name, text in OLD.items():
        (folder / name).write_text(text)
    code = f"""
import os, resource, signal
from pathlib import Path
from wavesym.writing import write_whole
{prepare}
write_whole(dict(zip(map(Path, {list(NEW)!r}), {list(NEW.values())!r})))
"""
    return subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, check=False).returncode


def contents(folder: Path) -> dict[str, str]:
    return {name: (folder / name).read_text() for name in names(folder) if not name.startswith(".")}


KILLED = """
calls = 0
def killed(kind, *arguments):
    global calls
    calls += 1
    if calls > {count}:
        os.kill(os.getpid(), signal.SIGKILL)
    return kind(*arguments)
sync, link, replace = os.fsync, os.link, os.replace
os.fsync = lambda *arguments: killed(sync, *arguments)
os.link = lambda *arguments: killed(link, *arguments)
os.replace = lambda *arguments: killed(replace, *arguments)
"""


@pytest.mark.skipif(os.name == "nt", reason="signals are of another kind there")
@pytest.mark.parametrize("count", range(10))
def test_a_process_that_is_killed_leaves_whole_files(tmp_path: Path, count: int) -> None:
    """Before the last draft is on the disk all are old; after that each is old or new."""
    status = written_in_a_process(tmp_path, KILLED.format(count=count))
    found = contents(tmp_path)
    assert status == (0 if count == 9 else -9)
    assert found.keys() == OLD.keys()
    if count < 5:  # three drafts, and the first file is linked and replaced
        assert found == OLD
    assert all(text in (OLD[name], NEW[name]) for name, text in found.items())
    if status == 0:
        assert found == NEW


@pytest.mark.skipif(os.name == "nt", reason="limits are of another kind there")
def test_a_full_disk_leaves_the_old_files_and_no_drafts(tmp_path: Path) -> None:
    limit = "signal.signal(signal.SIGXFSZ, signal.SIG_IGN); resource.setrlimit(resource.RLIMIT_FSIZE, (700, 700))"
    assert len(NEW["a.txt"]) > 700
    assert written_in_a_process(tmp_path, limit) == 1
    assert contents(tmp_path) == OLD
    assert names(tmp_path) == sorted(OLD)


@pytest.mark.parametrize("fails", [1, 2, 3])
@pytest.mark.parametrize("links", [True, False])
def test_what_cannot_take_its_place_puts_the_others_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fails: int, links: bool
) -> None:
    (tmp_path / "a.txt").write_text("old a")
    replace, calls = os.replace, []

    def refusing(draft: Path, place: Path) -> None:
        calls.append(place)
        if len(calls) == fails:
            raise OSError(errno.ENOSPC, "No space left on device", str(place))
        replace(draft, place)

    def no_links(*_: object) -> None:
        raise OSError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "replace", refusing)
    if not links:
        monkeypatch.setattr(os, "link", no_links)
    with pytest.raises(OSError, match="No space left"):
        write_whole({tmp_path / name: text for name, text in NEW.items()})
    assert names(tmp_path) == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == ("old a" if links or fails == 1 else NEW["a.txt"])


def test_a_folder_that_cannot_be_written_changes_nothing(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("old a")
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(OSError, match=r"Not a directory|File exists"):
        write_whole({tmp_path / "a.txt": "new", tmp_path / "file" / "b.txt": "new"})
    assert contents(tmp_path) == {"a.txt": "old a", "file": "no folder"}
    assert names(tmp_path) == ["a.txt", "file"]


def test_bytes_are_written_as_they_are(tmp_path: Path) -> None:
    write_whole({tmp_path / "a.png": b"\x89PNG\r\n\x1a\n\xff"})
    assert (tmp_path / "a.png").read_bytes() == b"\x89PNG\r\n\x1a\n\xff"

"""Files are written whole or not at all."""

from __future__ import annotations

import errno
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from threading import Barrier, Event

import pytest

from wavesym.writing import traces, write_whole


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
sync, link, replace, unlink = os.fsync, os.link, os.replace, os.unlink
os.fsync = lambda *arguments: killed(sync, *arguments)
os.link = lambda *arguments: killed(link, *arguments)
os.replace = lambda *arguments: killed(replace, *arguments)
os.unlink = lambda *arguments: killed(unlink, *arguments)
"""


@pytest.mark.skipif(os.name == "nt", reason="signals are of another kind there")
@pytest.mark.parametrize("count", range(19))
def test_a_process_that_is_killed_leaves_whole_files(tmp_path: Path, count: int) -> None:
    """Before the last draft is on the disk all are old; after that each is old or new. The next writer clears up."""
    status = written_in_a_process(tmp_path, KILLED.format(count=count))
    found = contents(tmp_path)
    assert status == (0 if count == 18 else -9)
    assert found.keys() == OLD.keys()
    if count < 5:  # three drafts, and the first file is linked and replaced
        assert found == OLD
    assert all(text in (OLD[name], NEW[name]) for name, text in found.items())
    if count >= 9:  # what is left is to clear up
        assert found == NEW
    left = {path.name: place.name for path, place in traces(tmp_path)}
    assert left.keys() == set(names(tmp_path)) - OLD.keys()
    assert set(left.values()) <= OLD.keys()
    assert bool(left) == (status != 0)
    write_whole({tmp_path / name: "newer" for name in OLD})
    assert names(tmp_path) == sorted(OLD)


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
    with pytest.raises(NotADirectoryError) as raised:
        write_whole({tmp_path / "a.txt": "new", tmp_path / "file" / "b.txt": "new"})
    assert raised.value.filename == str(tmp_path / "file" / "b.txt")
    assert contents(tmp_path) == {"a.txt": "old a", "file": "no folder"}
    assert names(tmp_path) == ["a.txt", "file"]


def test_bytes_are_written_as_they_are(tmp_path: Path) -> None:
    write_whole({tmp_path / "a.png": b"\x89PNG\r\n\x1a\n\xff"})
    assert (tmp_path / "a.png").read_bytes() == b"\x89PNG\r\n\x1a\n\xff"


KINDS = ("x", "y")
MEMBERS = tuple(f"{k}.txt" for k in range(5))


def together(*calls: Callable[[], None]) -> None:
    """All calls at once, in threads; raises what one of them raises."""
    ready = Barrier(len(calls))

    def started(call: Callable[[], None]) -> None:
        ready.wait(30)
        call()

    with ThreadPoolExecutor(len(calls)) as threads:
        for done in [threads.submit(started, call) for call in calls]:
            done.result(60)


def written_by_threads(folder: Path) -> None:
    """A round: each thread writes its kind of all members, one from the first to the last, one the other way."""
    orders = zip(KINDS, (MEMBERS, MEMBERS[::-1]), strict=True)
    sets = [{folder / name: f"{kind} {name}\n" * 50 for name in order} for kind, order in orders]
    together(*(partial(write_whole, files) for files in sets))


def kinds(folder: Path) -> set[str]:
    """Of the members that are there, each of which is whole."""
    found = {}
    for name in MEMBERS:
        text = (folder / name).read_text()
        found[name] = text[0]
        assert text == f"{text[0]} {name}\n" * 50
    return set(found.values())


def test_two_threads_that_write_one_folder_leave_the_files_of_one(tmp_path: Path) -> None:
    for _ in range(20):
        written_by_threads(tmp_path / "out")
        assert len(kinds(tmp_path / "out")) == 1
        assert names(tmp_path / "out") == sorted(MEMBERS)


WRITER = r"""
import os, sys, time
from pathlib import Path
from wavesym.writing import write_whole
replace = os.replace
def slow(*arguments):
    time.sleep(0.003)  # so that the other one is at it too
    replace(*arguments)
os.replace = slow
kind, *order = sys.argv[1:]
for line in sys.stdin:
    write_whole({Path(name): f"{kind} {name}\n" * 50 for name in order})
    print("written", flush=True)
"""


def test_two_processes_that_write_one_folder_leave_the_files_of_one(tmp_path: Path) -> None:
    writers = [
        subprocess.Popen(
            [sys.executable, "-c", WRITER, kind, *order],
            cwd=tmp_path,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for kind, order in zip(KINDS, (MEMBERS, MEMBERS[::-1]), strict=True)
    ]
    try:
        for _ in range(20):
            for writer in writers:
                assert writer.stdin
                writer.stdin.write("write\n")
                writer.stdin.flush()
            assert [writer.stdout.readline() for writer in writers if writer.stdout] == ["written\n"] * 2
            assert len(kinds(tmp_path)) == 1
            assert names(tmp_path) == sorted(MEMBERS)
    finally:
        for writer in writers:
            writer.communicate()
    assert [writer.returncode for writer in writers] == [0, 0]


@pytest.mark.skipif(os.name == "nt", reason="locks are of another kind there")
@pytest.mark.parametrize("reason", [errno.ENOLCK, errno.ENOSYS])
def test_without_locks_files_are_still_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, reason: int) -> None:
    def refusing(*_: object) -> None:
        raise OSError(reason, os.strerror(reason))

    monkeypatch.setattr("fcntl.flock", refusing)
    for _ in range(10):
        written_by_threads(tmp_path)
        assert kinds(tmp_path) <= set(KINDS)
    assert names(tmp_path) == sorted(MEMBERS)


def test_a_lock_that_may_not_be_taken_stays(tmp_path: Path) -> None:
    lock = tmp_path / ".a.txt.writing"
    lock.touch(0)
    if os.access(lock, os.W_OK):
        pytest.skip("this user may write every file")
    write_whole({tmp_path / "a.txt": "new"})
    assert contents(tmp_path) == {"a.txt": "new"}
    assert names(tmp_path) == [lock.name, "a.txt"]


def test_a_writer_waits_for_one_of_the_same_file_and_leaves_its_draft(tmp_path: Path) -> None:
    begun, go_on = Event(), Event()

    def slow() -> Iterator[str]:
        begun.set()
        assert go_on.wait(60)
        yield "first"

    with ThreadPoolExecutor() as threads:
        try:
            first = threads.submit(write_whole, {tmp_path / "a.txt": slow()})
            assert begun.wait(60)
            drafts = list(tmp_path.glob(".a.txt.*.part"))
            assert len(drafts) == 1
            second = threads.submit(write_whole, {tmp_path / "a.txt": "second"})
            # others need not wait, not even those whose name begins alike
            threads.submit(write_whole, {tmp_path / "a": "other", tmp_path / "a.txt.b": "other"}).result(60)
            with pytest.raises(TimeoutError):
                second.result(0.3)
            assert list(tmp_path.glob(".a.txt.*.part")) == drafts
        finally:
            go_on.set()
        first.result(60)
        second.result(60)
    assert contents(tmp_path) == {"a": "other", "a.txt": "second", "a.txt.b": "other"}
    assert names(tmp_path) == ["a", "a.txt", "a.txt.b"]


def test_what_is_no_trace_stays(tmp_path: Path) -> None:
    mine = [".a.txt.part", ".a.txt.old", ".a.txt.12.old", ".a.txt.0123456789abcdef.bak", ".b.0123456789abcdef.part"]
    for name in mine:
        (tmp_path / name).touch()
    (tmp_path / ".a.txt.0123456789abcdef.old").touch()
    write_whole({tmp_path / "a.txt": "new"})
    assert names(tmp_path) == sorted([*mine, "a.txt"])


@pytest.fixture
def umask() -> Iterator[None]:
    before = os.umask(0o027)
    yield
    os.umask(before)


@pytest.mark.skipif(os.name == "nt", reason="permissions are of another kind there")
@pytest.mark.parametrize("mode", [None, 0o600, 0o640, 0o666, 0o755])
def test_permissions_stay(tmp_path: Path, umask: None, mode: int | None) -> None:
    """A new file has those that the umask leaves; the draft is never open to more."""
    path = tmp_path / "a.txt"
    if mode is not None:
        path.touch()
        path.chmod(mode)
    expected = mode or 0o640
    seen: list[int] = []

    def content() -> Iterator[str]:
        seen.extend(draft.stat().st_mode & 0o777 for draft in tmp_path.glob(".*.part"))
        yield "new"

    write_whole({path: content()})
    assert seen == [expected]
    assert path.stat().st_mode & 0o777 == expected
    assert path.read_text() == "new"


def test_what_may_not_be_written_is_not_replaced(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    path.chmod(0o444)
    if os.access(path, os.W_OK):
        pytest.skip("this user may write every file")
    with pytest.raises(PermissionError) as raised:
        write_whole({tmp_path / "b.txt": "new", path: "new"})
    assert raised.value.filename == str(path)
    assert names(tmp_path) == ["a.txt"]
    assert path.read_text() == "old"


@pytest.mark.skipif(os.name == "nt", reason="links are of another kind there")
def test_the_last_of_a_chain_of_links_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "target").write_text("old")
    (tmp_path / "first").symlink_to("second")
    (tmp_path / "second").symlink_to(tmp_path / "third")
    (tmp_path / "third").symlink_to("folder/target")
    write_whole({tmp_path / "first": "new", tmp_path / "third": "newer"})  # twice one file: the later one
    assert [(tmp_path / name).is_symlink() for name in ("first", "second", "third")] == [True] * 3
    assert contents(tmp_path / "folder") == {"target": "newer"}
    assert names(tmp_path) == ["first", "folder", "second", "third"]


@pytest.mark.skipif(os.name == "nt", reason="links are of another kind there")
def test_a_link_to_itself_is_refused(tmp_path: Path) -> None:
    link = tmp_path / "link"
    link.symlink_to("link")
    with pytest.raises(OSError, match="link") as raised:
        write_whole({tmp_path / "a.txt": "new", link: "new"})
    assert (raised.value.errno, raised.value.filename) == (errno.ELOOP, str(link))
    assert names(tmp_path) == ["link"]


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="no folder that takes no files")
def test_a_folder_that_takes_no_files_is_refused_at_once() -> None:
    """A lock in it could never be had, and was waited for for ever."""
    with pytest.raises(FileNotFoundError) as raised:
        write_whole({Path("/proc/x.csv"): "new"})
    assert raised.value.filename == "/proc/x.csv"


def test_a_folder_that_vanishes_is_named_and_the_others_stay(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("old")

    def content() -> Iterator[str]:
        yield "new"
        shutil.rmtree(tmp_path / "folder")

    files = {tmp_path / "a.txt": "new", tmp_path / "folder" / "b.txt": content()}
    with pytest.raises(FileNotFoundError) as raised:
        write_whole(files)
    assert (raised.value.filename, raised.value.filename2) == (str(tmp_path / "folder" / "b.txt"), None)
    assert contents(tmp_path) == {"a.txt": "old"}
    assert names(tmp_path) == ["a.txt"]


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_errors_name_the_path_that_was_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str) -> None:
    def refusing(*arguments: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), *map(str, arguments[:1] if call == "replace" else ()))

    monkeypatch.chdir(tmp_path)
    Path("folder").mkdir()
    Path("link").symlink_to("folder", target_is_directory=True)
    monkeypatch.setattr(os, call, refusing)
    with pytest.raises(OSError, match=os.strerror(errno.ENOSPC)) as raised:
        write_whole({Path("link/a.txt"): "new"})
    assert (raised.value.filename, raised.value.strerror) == (str(Path("link/a.txt")), os.strerror(errno.ENOSPC))
    assert names(tmp_path / "folder") == []


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
def test_a_full_device_is_named(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="No space left") as raised:
        write_whole({Path("/dev/full"): "new", tmp_path / "a.txt": "new"})
    assert raised.value.filename == "/dev/full"

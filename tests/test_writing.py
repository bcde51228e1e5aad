"""Files are written whole or not at all."""

from __future__ import annotations

import os
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

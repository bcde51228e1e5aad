"""What differs between files as they are and as they should be is named, and so is what mends it."""

from __future__ import annotations

from pathlib import Path

from wavesym.difference import Difference


def test_a_difference_names_what_is_changed_missing_and_orphaned(tmp_path: Path) -> None:
    made = {tmp_path / "same": "x\n", tmp_path / "changed": "new\nline\n", tmp_path / "missing": "m\n"}
    (tmp_path / "same").write_bytes(b"x\n")
    (tmp_path / "changed").write_bytes(b"old\nline\xff")
    (tmp_path / "orphan").write_bytes(b"")
    found = list(tmp_path.iterdir())
    report = Difference(made, found).report(["again", "a b"])
    assert report.splitlines() == [
        f"changed: {tmp_path}/changed",
        f"--- {tmp_path}/changed",
        "+++ as generated",
        "@@ -1,2 +1,2 @@",
        "-old",
        "-line\\xff",
        "\\ No newline at end of file",
        "+new",
        "+line",
        f"missing: {tmp_path}/missing",
        f"--- {tmp_path}/missing",
        "+++ as generated",
        "@@ -0,0 +1 @@",
        "+m",
        f"orphaned: {tmp_path}/orphan",
        f"to mend: rm -- {tmp_path}/orphan && again 'a b'",
    ]
    assert Difference({tmp_path / "same": "x\n"}, [tmp_path / "same"]).report(["again"]) == ""
    assert "again" not in Difference({}, [tmp_path / "orphan"]).report(["again"])
    # a line end that Windows makes is a change, too
    (tmp_path / "same").write_bytes(b"x\r\n")
    assert Difference({tmp_path / "same": "x\n"}, [tmp_path / "same"]).report(["again"]).startswith("changed: ")


def test_orphans_are_not_opened(tmp_path: Path) -> None:
    """One may be of a writer who has just finished."""
    gone = tmp_path / "gone"
    assert Difference({}, [gone]).report(["again"]) == f"orphaned: {gone}\nto mend: rm -- {gone}\n"

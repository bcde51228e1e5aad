"""generated/ holds what would be made now; `make generated` mends it."""

import os
import re
import shlex
import subprocess
import sys
from importlib.resources import files as files_of
from pathlib import Path

import pytest

from tests.support.generated import files
from wavesym import api
from wavesym.cli import main
from wavesym.documents.tables import table_lines
from wavesym.scene import Scene, lower

KEPT = Path(__file__).parent.parent / "generated"
EXAMPLES = ("building_m2", "collision_m4", "drive_m1")


@pytest.mark.parametrize("name", EXAMPLES)
def test_kept_files_are_what_is_generated(name):
    scene = Scene.from_toml(name)
    made = files(lower(scene), "all") | {"tables.csv": "".join(table_lines(api.table(scene), name, "csv"))}
    kept = {path.name: path.read_bytes().decode() for path in (KEPT / name).iterdir()}
    assert kept.keys() == made.keys(), "make generated"
    for file, text in made.items():
        assert kept[file] == text, f"{name}/{file} differs: make generated"


def test_nothing_else_is_kept():
    assert sorted(path.name for path in KEPT.iterdir()) == sorted([*EXAMPLES, "errata.md"]), "make generated"


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", EXAMPLES)
def test_check_holds_what_is_kept(name, capsys):
    assert main(["generate", name, "-o", str(KEPT / name), "--language", "all", "--check"]) == 0
    assert capsys.readouterr() == ("", "")


def test_check_names_what_is_wrong_and_the_command_it_prints_mends_it(tmp_path, monkeypatch, capsys):
    """Changed, absent and orphaned files, in a folder whose name a shell would take apart."""
    folder, source = tmp_path / "it's $(here)", tmp_path / "my scene.toml"
    folder.mkdir()
    source.write_text((files_of("wavesym.scene") / "builtin" / "drive_m1.toml").read_text())
    monkeypatch.chdir(tmp_path)
    request = ["generate", source.name, "-o", folder.name, "--evaluator", "closed"]
    assert main(request) == 0
    assert main([*request, "--check"]) == 0
    capsys.readouterr()
    other = folder / "other.txt"
    other.write_text("not mine")
    (folder / "drive_m1_folder").mkdir()
    (folder / "drive_m1.h").unlink()
    (folder / "drive_m1.c").write_bytes((folder / "drive_m1.c").read_bytes().replace(b"0.5", b"0.6", 1) + b"\xff")
    (folder / "drive_m1.py").write_text("of an earlier time")
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    assert main([*request, "--check"]) == 1
    found, warned = capsys.readouterr()
    assert not warned
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before
    named = [line for line in found.splitlines() if re.match("changed|missing|orphaned", line)]
    place = folder.name
    assert named == [f"changed: {place}/drive_m1.c", f"missing: {place}/drive_m1.h", f"orphaned: {place}/drive_m1.py"]
    assert "\n-" in found
    assert "\n+" in found
    last = found.splitlines()[-1]
    assert last.startswith("to mend: rm -- ")
    command = last.removeprefix("to mend: ").replace("wavesym ", f"{shlex.quote(sys.executable)} -m wavesym ", 1)
    assert subprocess.run(command, shell=True, capture_output=True, check=False).returncode == 0
    assert main([*request, "--check"]) == 0
    assert capsys.readouterr() == ("", "")
    assert other.read_text() == "not mine"


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="signals are of another kind there")
def test_check_names_what_a_killed_process_left(tmp_path, monkeypatch, capsys):
    """Drafts, and the locks of their files; the command that is printed removes them."""
    monkeypatch.chdir(tmp_path)
    request = ["generate", "drive_m1", "-o", "folder"]
    assert main(request) == 0
    written = sorted(path.name for path in Path("folder").iterdir())
    killed = f"""
import os, signal
from wavesym import api
from wavesym.cli import main
from wavesym.documents.tables import table_lines
os.replace = lambda *_: os.kill(os.getpid(), signal.SIGKILL)
main({request})
"""
    assert subprocess.run([sys.executable, "-c", killed], capture_output=True, check=False).returncode == -9
    Path("folder/.other.c.0123456789abcdef.part").touch()
    capsys.readouterr()
    assert main([*request, "--check"]) == 1
    *named, last = capsys.readouterr().out.splitlines()
    left = [f".{name}.{end}" for name in written for end in ("*.part", "writing")] + [f".{written[0]}.*.old"]
    assert [re.sub("[0-9a-f]{16}", "*", line) for line in named] == [
        f"orphaned: folder/{name}" for name in sorted(left)
    ]
    assert subprocess.run(last.removeprefix("to mend: "), shell=True, check=False).returncode == 0
    assert main([*request, "--check"]) == 0
    assert sorted(path.name for path in Path("folder").iterdir()) == [".other.c.0123456789abcdef.part", *written]

"""Builds that are kept: compiled once, and again as soon as anything that the compiler reads is another."""

import sys
from dataclasses import replace

import pytest

from tests.support.kept_builds import KeptBuilds
from wavesym.running.toolchain import Compiler, CompilerError

CHOSEN = Compiler("python", (sys.executable,))
ARGUMENTS = ["-O0", "a.c", "-o", "a"]


@pytest.fixture
def build(tmp_path):
    """Builds in a folder with a.c and a.h; how often the compiler was started."""
    kept, folder, started = tmp_path / "kept", tmp_path / "in", []
    kept.mkdir()
    folder.mkdir()
    (folder / "a.c").write_text('#include "a.h"\nint main(void) { return STATUS; }\n')
    (folder / "a.h").write_text("#define STATUS 0\n")
    builds = KeptBuilds(kept, CHOSEN)

    def run(by, arguments, at):
        started.append(arguments)
        (at / "a").write_bytes((at / "a.h").read_bytes())
        if "-save-temps" in arguments:
            (at / "a.s").write_text("")
        if b"error" in (at / "a.h").read_bytes():
            raise CompilerError("no")

    def made(arguments=ARGUMENTS, by=CHOSEN):
        builds.run(run, by, arguments, folder)
        return (folder / "a").read_text(), len(started)

    return folder, made


def test_the_same_is_compiled_once(build):
    folder, made = build
    assert made() == ("#define STATUS 0\n", 1)
    (folder / "a").write_text("another")
    assert made() == ("#define STATUS 0\n", 1)


def test_what_differs_is_compiled_again(build):
    folder, made = build
    made()
    (folder / "a.h").write_text("#define STATUS 7\n")
    assert made() == ("#define STATUS 7\n", 2)
    assert made(["-O2", *ARGUMENTS[1:]])[1] == 3
    assert made(by=replace(CHOSEN, command=(*CHOSEN.command, "-g")))[1] == 4
    assert made(by=Compiler("none", ("no such compiler",)))[1] == 5


def test_what_is_refused_or_writes_more_is_not_kept(build):
    folder, made = build
    for started in (1, 2):
        assert made([*ARGUMENTS, "-save-temps"])[1] == started
        (folder / "a.s").unlink()
    (folder / "a.h").write_text("error\n")
    for _ in range(2):
        with pytest.raises(CompilerError):
            made()
    (folder / "a.h").write_text("#define STATUS 0\n")
    assert made()[1] == 5

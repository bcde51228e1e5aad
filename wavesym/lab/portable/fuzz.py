"""Programs under libFuzzer and sanitizers: bytes become arguments; templates/fuzz/ says what must hold of what comes.

Without a fuzzer the bytes that were kept can be replayed, by any compiler that has sanitizers.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from wavesym.lab.portable.subjects import CHECKED, PortableProgram
from wavesym.lab.portable.tools import started, version
from wavesym.rendering import text_of
from wavesym.running.toolchain import CompilerError

HEAD = ("program", "made by", "called", "seconds", "executions", "findings")
CLANGS = ("clang", *(f"clang-{number}" for number in range(21, 11, -1)))
SANITIZED = ("-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all", "-g")
_WITH_FUZZER = (f"{SANITIZED[0]},fuzzer", *SANITIZED[1:])
_TRIED = """
int LLVMFuzzerTestOneInput(const char *bytes, unsigned long count) { return bytes && count > 99; }
"""
_SHARED = ("fuzz.h", "parameters.h", "models.h", "steps.h", "replay.c")
_AT_ONCE = 2
_SLOWEST = 30  # seconds: what takes longer with some bytes is a fault, too
_COMPILING = 300.0
_SAID = re.compile(r"does not hold: .*|runtime error: .*|ERROR: (?!libFuzzer: deadly).*|undefined reference.*")


class FuzzedProgram(NamedTuple):
    """A program, the driver in templates/fuzz/ that calls it, and how many bytes it is given at most."""

    subject: PortableProgram
    driver: str
    longest: int

    @property
    def name(self) -> str:
        """What its folder is called."""
        return f"{self.subject.name}_{self.driver}"

    def called(self, folder: Path) -> list[str]:
        """What is called of it, without the program's name before it; its files are in the folder."""
        where, name = folder / self.name, self.subject.name

        def words(file: str) -> set[str]:
            text = (where / file).read_text(encoding="utf-8")
            own = set(re.findall(rf"\b{name}_(\w+)\(", text))
            return own.union(*map(words, re.findall(r'#include "(\w+\.h)"', text)))

        return sorted(words(f"{self.driver}.c") & words(f"{name}.h"))

    def write(self, folder: Path) -> Path:
        """Its files and driver, in a folder of its own."""
        where = folder / self.name
        where.mkdir(parents=True, exist_ok=True)
        for file, text in self.subject.files().items():
            (where / file).write_text(text, encoding="utf-8")
        for file in (*_SHARED, f"{self.driver}.c"):
            (where / file).write_text(self.subject.spelt(text_of(f"fuzz/{file}")), encoding="utf-8")
        return where

    def command(self, compiler: str, sanitizers: Sequence[str], *more: str) -> list[str]:
        """That makes `run` of them."""
        name = self.subject.name
        flags = (
            "-std=c99",
            "-O1",
            "-Wall",
            "-Werror=incompatible-pointer-types",
            *sanitizers,
            "-include",
            f"{name}.h",
            "-I.",
        )
        return [compiler, *flags, f"{self.driver}.c", *more, f"{name}.c", "-o", "run", "-lm"]


_BY_NAME = {subject.name: subject for subject in CHECKED}
FUZZED = (
    FuzzedProgram(_BY_NAME["pieces_double"], "values", 64),
    FuzzedProgram(_BY_NAME["closed_double"], "values", 64),
    FuzzedProgram(_BY_NAME["march_double"], "values", 64),
    FuzzedProgram(_BY_NAME["rings_double"], "values", 64),
    FuzzedProgram(_BY_NAME["march_double"], "march", 512),
    FuzzedProgram(_BY_NAME["march_double"].single, "march", 512),
    FuzzedProgram(_BY_NAME["modes_double"], "stream", 512),
    FuzzedProgram(_BY_NAME["stream_double"], "stream", 512),
    FuzzedProgram(_BY_NAME["stream_double"].single, "stream", 512),
    FuzzedProgram(_BY_NAME["tuned_double"], "tuned", 512),
    FuzzedProgram(_BY_NAME["runtime_double"], "runtime", 128),
    FuzzedProgram(_BY_NAME["joints_double"], "runtime", 128),
    FuzzedProgram(_BY_NAME["runtime_double"], "batch", 512),
)


class FuzzVerdict(NamedTuple):
    """Of one run: how often the program was called, and what was found, "" for nothing."""

    executions: int
    found: str


def fuzzer() -> str | None:
    """The first compiler here that has libFuzzer and its sanitizers, if any."""
    for clang in filter(shutil.which, CLANGS):
        with TemporaryDirectory() as folder:
            (Path(folder) / "tried.c").write_text(_TRIED, encoding="utf-8")
            made = started([clang, *_WITH_FUZZER, "tried.c", "-o", "tried"], Path(folder), _COMPILING)
        if made.status == 0:
            return clang
    return None


def fuzz(program: FuzzedProgram, clang: str, folder: Path, kept: Path, seconds: int) -> FuzzVerdict:
    """Let libFuzzer call a program for so long, from the bytes in `kept` on, and what it has learnt in `folder`."""
    where = program.write(folder)
    made = started(program.command(clang, _WITH_FUZZER), where, _COMPILING)
    if made.status != 0:
        raise CompilerError(made.errors)
    (where / "learnt").mkdir(exist_ok=True)
    options = (f"-max_total_time={seconds}", f"-max_len={program.longest}", "-len_control=0", f"-timeout={_SLOWEST}")
    seeds = [str(kept / program.driver)] if (kept / program.driver).is_dir() else []
    said = started(
        ["./run", *options, "-print_final_stats=1", "learnt", *seeds], where, seconds + 2 * _SLOWEST + _COMPILING
    )
    count = re.search(r"number_of_executed_units: (\d+)", said.errors)
    bytes_ = re.search(r"Base64: (\S*)", said.errors)
    told = list(dict.fromkeys(_SAID.findall(said.errors))) or [said.errors[-500:]]
    found = "" if said.status == 0 else f"{'; '.join(told)}; bytes {bytes_[1] if bytes_ else 'not known'}"
    return FuzzVerdict(int(count[1]) if count else 0, found)


def keep(program: FuzzedProgram, folder: Path, kept: Path) -> None:
    """Keep the bytes that get to lines which those in `kept` do not get to."""
    into = kept / program.driver
    into.mkdir(parents=True, exist_ok=True)
    started(["./run", "-merge=1", "-use_counters=0", str(into), "learnt"], folder / program.name, _COMPILING)


def rows(
    programs: Sequence[FuzzedProgram], clang: str, folder: Path, kept: Path, seconds: int, failed: list[str]
) -> Iterator[tuple[str, ...]]:
    """A row for each program; what was found is added to `failed`, and bytes that are worth it to those in `kept`."""
    with ThreadPoolExecutor(_AT_ONCE) as pool:
        runs = [pool.submit(fuzz, program, clang, folder, kept, seconds) for program in programs]
        for program, run in zip(programs, runs, strict=True):
            found = run.result()
            if found.found:
                failed.append(f"{program.name}: {found.found}")
            else:
                keep(program, folder, kept)
            yield (
                program.subject.name,
                f"`{program.subject.asked}`",
                ", ".join(f"`{name}`" for name in program.called(folder)),
                str(seconds),
                str(found.executions),
                "1" if found.found else "0",
            )


def tool(clang: str) -> str:
    """Which fuzzer, in a line."""
    return f"{version(clang)}, `{SANITIZED[0]}`"


def replayer(program: FuzzedProgram, compiler: str, folder: Path, sanitizers: Sequence[str] = SANITIZED) -> Path:
    """A program that is given files and calls what the fuzzer called with their bytes. CompilerError."""
    where = program.write(folder)
    made = started(program.command(compiler, sanitizers, "replay.c"), where, _COMPILING)
    if made.status != 0:
        raise CompilerError(made.errors)
    return where / "run"


def replayed(run: Path, files: Sequence[Path]) -> str:
    """What does not hold for these bytes; "" where all does."""
    said = started([str(run), *map(str, files)], run.parent, _COMPILING)
    return "" if said.status == 0 else "; ".join(_SAID.findall(said.errors)) or said.errors[-500:] or f"{said.status}"

"""Programs under libFuzzer and sanitizers: bytes become arguments; drivers/ says what must hold of what comes.

Bytes that are worth keeping stand in corpus/, a file for each driver and a line of hexadecimal digits for each input.
Without a fuzzer they can be replayed, by any compiler that has sanitizers.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from tools.portable.external import run_command, version
from tools.portable.subjects import CHECKED, PortableProgram
from wavesym.running.toolchain import CompilerError
from wavesym.writing import write_whole

HEAD = ("program", "made by", "called", "seconds", "executions", "findings")
CLANGS = ("clang", *(f"clang-{number}" for number in range(21, 11, -1)))
SANITIZED = ("-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all", "-g")
_WITH_FUZZER = (f"{SANITIZED[0]},fuzzer", *SANITIZED[1:])
_TRIED = """
int LLVMFuzzerTestOneInput(const char *bytes, unsigned long count) { return bytes && count > 99; }
"""
CORPUS = Path(__file__).with_name("corpus")
_DRIVERS = Path(__file__).with_name("drivers")
_SHARED = ("fuzz.h", "parameters.h", "models.h", "steps.h", "replay.c")
_AT_ONCE = 2
_SLOWEST = 30  # seconds: what takes longer with some bytes is a fault, too
_COMPILING = 300.0
_SAID = re.compile(r"does not hold: .*|runtime error: .*|ERROR: (?!libFuzzer: deadly).*|undefined reference.*")


class FuzzedProgram(NamedTuple):
    """A program, the driver in drivers/ that calls it, and how many bytes it is given at most."""

    subject: PortableProgram
    driver: str
    longest: int

    @property
    def name(self) -> str:
        """What its folder is called."""
        return f"{self.subject.name}_{self.driver}"

    def called_functions(self, folder: Path) -> list[str]:
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
            (where / file).write_text(
                self.subject.instantiate((_DRIVERS / file).read_text(encoding="utf-8")), encoding="utf-8"
            )
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
    FuzzedProgram(_BY_NAME["blocks_double"], "values", 64),
    FuzzedProgram(_BY_NAME["modes_double"], "stream", 512),
    FuzzedProgram(_BY_NAME["stream_double"], "stream", 512),
    FuzzedProgram(_BY_NAME["stream_double"].single, "stream", 512),
    FuzzedProgram(_BY_NAME["tuned_double"], "tuned", 512),
    FuzzedProgram(_BY_NAME["runtime_double"], "runtime", 128),
    FuzzedProgram(_BY_NAME["joints_double"], "runtime", 128),
    FuzzedProgram(_BY_NAME["runtime_double"], "batch", 512),
    FuzzedProgram(_BY_NAME["joints_double"], "batch", 512),
)


class FuzzVerdict(NamedTuple):
    """Of one run: how often the program was called, and what was found, "" for nothing."""

    executions: int
    finding: str


def fuzzer() -> str | None:
    """The first compiler here that has libFuzzer and its sanitizers, if any."""
    for clang in filter(shutil.which, CLANGS):
        with TemporaryDirectory() as folder:
            (Path(folder) / "tried.c").write_text(_TRIED, encoding="utf-8")
            made = run_command([clang, *_WITH_FUZZER, "tried.c", "-o", "tried"], Path(folder), _COMPILING)
        if made.status == 0:
            return clang
    return None


def inputs(corpus: Path, driver: str) -> list[bytes]:
    """The bytes that were kept for a driver, none where nothing was."""
    file = corpus / f"{driver}.hex"
    return [bytes.fromhex(line) for line in file.read_text(encoding="ascii").splitlines()] if file.is_file() else []


def unpack_corpus(corpus: Path, driver: str, folder: Path) -> list[Path]:
    """The same as files in a folder, which is made."""
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for number, data in enumerate(inputs(corpus, driver)):
        files.append(folder / f"{number:04}")
        files[-1].write_bytes(data)
    return files


def fuzz(program: FuzzedProgram, clang: str, folder: Path, corpus: Path, seconds: int) -> FuzzVerdict:
    """Let libFuzzer call a program for so long, from the bytes in `corpus` on, and what it has learnt in `folder`."""
    where = program.write(folder)
    made = run_command(program.command(clang, _WITH_FUZZER), where, _COMPILING)
    if made.status != 0:
        raise CompilerError(made.errors)
    (where / "learnt").mkdir(exist_ok=True)
    options = (f"-max_total_time={seconds}", f"-max_len={program.longest}", "-len_control=0", f"-timeout={_SLOWEST}")
    unpack_corpus(corpus, program.driver, where / "kept")
    result = run_command(
        ["./run", *options, "-print_final_stats=1", "learnt", "kept"], where, seconds + 2 * _SLOWEST + _COMPILING
    )
    count = re.search(r"number_of_executed_units: (\d+)", result.errors)
    bytes_ = re.search(r"Base64: (\S*)", result.errors)
    findings = list(dict.fromkeys(_SAID.findall(result.errors))) or [result.errors[-500:]]
    found = "" if result.status == 0 else f"{'; '.join(findings)}; bytes {bytes_[1] if bytes_ else 'not known'}"
    return FuzzVerdict(int(count[1]) if count else 0, found)


def keep(program: FuzzedProgram, folder: Path, corpus: Path) -> None:
    """Keep the bytes that get to lines which those in `corpus` do not get to."""
    where = folder / program.name
    with TemporaryDirectory() as name:
        unpack_corpus(corpus, program.driver, Path(name))
        run_command(["./run", "-merge=1", "-use_counters=0", name, "learnt"], where, _COMPILING)
        found = {file.read_bytes() for file in Path(name).iterdir()}
    lines = [f"{data.hex()}\n" for data in sorted(found, key=lambda data: (len(data), data))]
    write_whole({corpus / f"{program.driver}.hex": "".join(lines)})


def rows(
    programs: Sequence[FuzzedProgram], clang: str, folder: Path, corpus: Path, seconds: int, failed: list[str]
) -> Iterator[tuple[str, ...]]:
    """A row for each program; what was found is added to `failed`, and bytes that are worth it to those in `corpus`."""
    with ThreadPoolExecutor(_AT_ONCE) as pool:
        runs = [pool.submit(fuzz, program, clang, folder, corpus, seconds) for program in programs]
        for program, run in zip(programs, runs, strict=True):
            found = run.result()
            if found.finding:
                failed.append(f"{program.name}: {found.finding}")
            else:
                keep(program, folder, corpus)
            yield (
                program.subject.name,
                f"`{program.subject.generate_command}`",
                ", ".join(f"`{name}`" for name in program.called_functions(folder)),
                str(seconds),
                str(found.executions),
                "1" if found.finding else "0",
            )


def tool(clang: str) -> str:
    """Which fuzzer, in a line."""
    return f"{version(clang)}, `{SANITIZED[0]}`"


def replayer(program: FuzzedProgram, compiler: str, folder: Path, sanitizers: Sequence[str] = SANITIZED) -> Path:
    """A program that is given files and calls what the fuzzer called with their bytes. CompilerError."""
    where = program.write(folder)
    made = run_command(program.command(compiler, sanitizers, "replay.c"), where, _COMPILING)
    if made.status != 0:
        raise CompilerError(made.errors)
    return where / "run"


def replay(run: Path, files: Sequence[Path]) -> str:
    """What does not hold for these bytes; "" where all does."""
    result = run_command([str(run), *map(str, files)], run.parent, _COMPILING)
    return (
        ""
        if result.status == 0
        else "; ".join(_SAID.findall(result.errors)) or result.errors[-500:] or f"{result.status}"
    )

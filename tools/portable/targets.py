"""Every program compiled by zig for other machines, without a warning; its self-test run where this machine can."""

from __future__ import annotations

import os
import re
import shutil
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

from tools.portable.answers import cached_answer
from tools.portable.external import absent, run_command, version
from tools.portable.prove import MACHINES
from tools.portable.subjects import PortableProgram
from wavesym.running.toolchain import CompilerError

HEAD = ("target", "program", "compiled", "self-test", "text", "rodata", "data", "frames")
STATUS_HEAD = ("target", "compiled", "self-test passes", "proved")
_STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wmissing-prototypes", "-Werror")
_NO_DOUBLES = ("-Wdouble-promotion",)
_ZIG = (sys.executable, "-m", "ziglang", "cc", "-std=c99", "-Os", "-fno-sanitize=all")
_SECONDS = 600.0  # the first program for a machine waits until zig has built its C library
_RUN_WASM = """import { readFile } from 'node:fs/promises';
import { WASI } from 'node:wasi';
const wasi = new WASI({ version: 'preview1' });
const made = await WebAssembly.compile(await readFile('selftest'));
process.exitCode = wasi.start(await WebAssembly.instantiate(made, wasi.getImportObject()));
"""


# what compilers call of themselves, where a machine has no instruction for it
_COPIES = r"mem(cpy|move|set)|__aeabi_mem(cpy|move|set|clr)[48]?"
_FRAMES = r"__aeabi_unwind_cpp_pr[01]|___?chkstk(_ms)?|_GLOBAL_OFFSET_TABLE_"
_INTEGERS = r"__aeabi_(ui?divmod|idivmod|ul?div|i?div|uidiv|l?mul|ldivmod|uldivmod|ll?sl|ll?sr)|__u?(div|mod)[sd]i3"
_FLOATS = r"__aeabi_(f(add|sub|mul|div|rsub|2iz|2uiz|2lz|2ulz|cmp\w+)|[u]?[il]2f|cf\w+)|_fltused"
_DOUBLES = r"__aeabi_(d\w+|[uf]?[il]?2d|cd\w+|d2f)"

_PIE = ("-fPIE",)
"""Elsewhere than at a fixed address: tables that hold addresses would have to be written to then."""


@dataclass(frozen=True)
class TargetMachine:
    """A machine as zig calls it, with nothing on it, and with a system and C library (empty: it has none).

    `runner` runs the self-test: a program of this machine, which `qemu` or node lets believe that it is on that one.
    `layout` is what the prover calls a machine with integers and pointers of the same sizes.
    """

    name: str
    bare: str
    hosted_triple: str
    runner: tuple[str, ...] = ()
    options: tuple[str, ...] = ()
    layout: str = "gcc_x86_32"


_LONG = "gcc_x86_64"


def _linux(name: str, zig: str, qemu: str, layout: str = "gcc_x86_32", floats: str = "") -> TargetMachine:
    emulators = [name for name in (f"qemu-{qemu}-static", f"qemu-{qemu}") if shutil.which(name)]
    runner = ((emulators or [f"qemu-{qemu}"])[0], "./selftest") if qemu else ("./selftest",)
    return TargetMachine(
        name, f"{zig}-freestanding-{floats}".rstrip("-"), f"{zig}-linux-musl{floats}", runner, _PIE, layout
    )


TARGETS = (
    _linux("x86-64", "x86_64", "", _LONG),
    _linux("aarch64", "aarch64", "aarch64", _LONG),
    _linux("riscv64", "riscv64", "riscv64", _LONG),
    _linux("s390x, big-endian", "s390x", "s390x", _LONG),
    _linux("i386", "x86", "i386"),
    _linux("arm", "arm", "arm", floats="eabihf"),
    TargetMachine("Cortex-M4F", "thumb-freestanding-eabihf", "", options=("-mcpu=cortex_m4+vfp4d16sp",)),
    TargetMachine("Cortex-M0+", "thumb-freestanding-eabi", "", options=("-mcpu=cortex_m0plus",)),
    TargetMachine("windows", "x86_64-windows-gnu", "x86_64-windows-gnu", layout="msvc_x86_64"),
    TargetMachine("wasm32", "wasm32-freestanding", "wasm32-wasi", ("node", "--no-warnings", "selftest.mjs")),
)


class MachineBytes(NamedTuple):
    """Bytes: of code, of constants, of data that can be written, and of the frames of all functions together, which is
    more than the stack can become, as no function calls itself."""

    text: int
    rodata: int
    data: int
    stack: int


def compiler() -> str:
    """Which one, in a line."""
    return f"ziglang {metadata.version('ziglang')}"


def rows(
    subjects: Sequence[PortableProgram],
    targets: Sequence[TargetMachine],
    folder: Path,
    kept_in: Path,
    failed: list[str],
) -> Iterator[tuple[str, ...]]:
    """A row for each target and program; what does not compile, and a self-test that fails, is added to `failed`."""
    tools = (compiler(), *(version(tool) for target in targets for tool in target.runner[:1] if shutil.which(tool)))
    texts = {subject.name: subject.files() for subject in subjects}

    def row(target: TargetMachine, subject: PortableProgram) -> tuple[str, ...]:
        question = (repr((target, _STRICT, _ZIG[3:], tools)), *texts[subject.name].values())
        where = folder / target.name / subject.name

        def answer() -> list[str]:
            where.mkdir(parents=True)
            for file, text in (*texts[subject.name].items(), ("selftest.mjs", _RUN_WASM)):
                (where / file).write_text(text, encoding="utf-8")
            size = compile_bare(subject, target, where)
            return ["yes", selftest(subject, target, where), *map(str, size)]

        return target.name, subject.name, *cached_answer(kept_in, question, answer)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        runs = [
            (target, subject, pool.submit(row, target, subject))
            for target in targets
            for subject in subjects
            if target.hosted_triple or not subject.calls_exp  # exp is all that a program asks of a machine
        ]
        for target, subject, run in runs:
            try:
                yield run.result()
            except CompilerError as error:
                failed.append(f"{target.name}, {subject.name}: {error}")
                yield target.name, subject.name, "no", "", "", "", "", ""


def status(
    made: Sequence[tuple[str, ...]], targets: Sequence[TargetMachine], proved: set[str]
) -> Iterator[tuple[str, ...]]:
    """A line for each target, from its rows: how many programs were compiled, passed, and are `proved` for its layout
    of data."""
    for target in targets:
        own = [row for row in made if row[0] == target.name]
        passed = sum(row[3] == "passes" for row in own)
        yield (
            target.name,
            f"{sum(row[2] == 'yes' for row in own)} of {len(own)}",
            f"{passed} of {len(own)}" if passed else "not run",
            f"{sum(row[1] in proved for row in own)} of {len(own)}"
            if target.layout in MACHINES
            else "no, for other sizes of integers and pointers",
        )


def compile_bare(subject: PortableProgram, target: TargetMachine, folder: Path) -> MachineBytes:
    """A program alone, compiled for a machine with nothing on it. CompilerError where that says a word, where there is
    data that can be written, where it calls what such a machine has not, and, in single precision, for doubles."""
    triple = target.hosted_triple if subject.calls_exp else target.bare
    single = subject.request.precision == "single"
    flags = (*_STRICT, *(_NO_DOUBLES if single else ()), *target.options)
    frames = ("-Wframe-larger-than=0", "-Wno-error=frame-larger-than")  # tells the frame of each function
    result = run_command(
        [*_ZIG, "-target", triple, *flags, *frames, "-c", f"{subject.name}.c", "-o", "object"], folder, _SECONDS
    )
    warned = re.findall(r"^.*(?:warning|error): .*$", result.errors, re.MULTILINE)
    sizes = [re.search(r"stack frame size \((\d+)\) exceeds limit \(0\)", line) for line in warned]
    if result.status != 0 or None in sizes:
        raise CompilerError(result.errors)
    stack = sum(int(size[1]) for size in sizes if size)
    found = sections(folder / "object")
    size = MachineBytes(
        text=sum(size for name, size in found.items() if name.startswith((".text", "code"))),
        rodata=sum(size for name, size in found.items() if name.startswith((".rodata", ".rdata", "constant"))),
        data=sum(size for name, size in found.items() if name.startswith((".data", ".bss", ".tdata", "writable"))),
        stack=stack,
    )
    if size.data:
        raise CompilerError(f"{size.data} bytes of data that can be written")
    allowed = re.compile("|".join((_COPIES, _FRAMES, _INTEGERS, _FLOATS, *(() if single else (_DOUBLES,)))))
    lacking = [name for name in undefined_symbols(folder / "object") if not allowed.fullmatch(name)]
    if lacking and not subject.calls_exp:
        raise CompilerError(f"needs {', '.join(lacking)}")
    return size


def undefined_symbols(file: Path) -> list[str]:
    """What an object file calls of others; none is known of WebAssembly, where a self-test would not start."""
    if file.read_bytes().startswith(b"\0asm"):
        return []
    listed = run_command(["nm", "-u", file.name], file.parent, _SECONDS)
    if listed.status != 0:
        raise CompilerError(listed.errors)
    return [line.split()[-1] for line in listed.output.splitlines() if line.split()]


def selftest(subject: PortableProgram, target: TargetMachine, folder: Path) -> str:
    """That the self-test passes on the machine, or why it was not run. CompilerError where it fails."""
    if not target.runner:
        return "not run"
    if missing := absent(*(program for program in target.runner[:1] if not program.startswith("."))):
        return f"not run: no {missing[0]}"
    files = (f"{subject.name}.c", f"{subject.name}_selftest.c")
    result = run_command([*_ZIG, "-target", target.hosted_triple, *files, "-o", "selftest", "-lm"], folder, _SECONDS)
    if result.status == 0:
        result = run_command(target.runner, folder, _SECONDS)
    if result.status != 0:
        raise CompilerError(f"self-test: {result.output}{result.errors}")
    return "passes"


def sections(file: Path) -> dict[str, int]:
    """Bytes of each section of an object file."""
    content = file.read_bytes()
    if content.startswith(b"\0asm"):
        return _wasm(content)
    listed = run_command(["size", "-A", file.name], file.parent, _SECONDS).output
    words = [line.split() for line in listed.splitlines()]
    return {name: int(size) for name, size, *_ in (word for word in words if len(word) == 3 and word[1].isdigit())}


def _wasm(content: bytes) -> dict[str, int]:
    """Those of WebAssembly that count: code, and data, which does not say whether it is constant."""
    sizes = {"code": 0, "constant": 0}
    at = 8
    while at < len(content):
        kind = content[at]
        size, at = _leb128(content, at + 1)
        if kind == 10:
            sizes["code"] += size
        if kind == 11:
            sizes["constant"] += size
        at += size
    return sizes


def _leb128(content: bytes, at: int) -> tuple[int, int]:
    """A number, seven bits a byte, and where it ends."""
    number = shift = 0
    while True:
        number |= (content[at] & 127) << shift
        shift, at = shift + 7, at + 1
        if content[at - 1] < 128:
            return number, at

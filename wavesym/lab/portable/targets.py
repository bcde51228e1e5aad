"""Every program compiled by zig for other machines, without a warning; its self-test run where this machine can."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

from wavesym.lab.portable.subjects import PortableProgram
from wavesym.lab.portable.tools import absent, started
from wavesym.running.toolchain import CompilerError

HEAD = ("target", "program", "compiled", "self-test", "text", "rodata", "data", "frames")
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


_PIE = ("-fPIE",)
"""Elsewhere than at a fixed address: tables that hold addresses would have to be written to then."""


@dataclass(frozen=True)
class TargetMachine:
    """A machine as zig calls it, with nothing on it, and with a system and C library (empty: it has none).

    `runner` runs the self-test: a program of this machine, which `qemu` or node lets believe that it is on that one.
    """

    name: str
    bare: str
    hosted: str
    runner: tuple[str, ...] = ()
    options: tuple[str, ...] = ()


TARGETS = (
    TargetMachine("x86-64", "x86_64-freestanding", "x86_64-linux-musl", ("./selftest",), _PIE),
    TargetMachine("aarch64", "aarch64-freestanding", "aarch64-linux-musl", ("qemu-aarch64-static", "./selftest"), _PIE),
    TargetMachine("riscv64", "riscv64-freestanding", "riscv64-linux-musl", ("qemu-riscv64-static", "./selftest"), _PIE),
    TargetMachine(
        "s390x, big-endian", "s390x-freestanding", "s390x-linux-musl", ("qemu-s390x-static", "./selftest"), _PIE
    ),
    TargetMachine("i386", "x86-freestanding", "x86-linux-musl", ("qemu-i386-static", "./selftest"), _PIE),
    TargetMachine("arm", "arm-freestanding-eabihf", "arm-linux-musleabihf", ("qemu-arm-static", "./selftest"), _PIE),
    TargetMachine("Cortex-M4F", "thumb-freestanding-eabihf", "", options=("-mcpu=cortex_m4+vfp4d16sp",)),
    TargetMachine("Cortex-M0+", "thumb-freestanding-eabi", "", options=("-mcpu=cortex_m0plus",)),
    TargetMachine("windows", "x86_64-windows-gnu", "x86_64-windows-gnu"),
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
    subjects: Sequence[PortableProgram], targets: Sequence[TargetMachine], folder: Path, failed: list[str]
) -> Iterator[tuple[str, ...]]:
    """A row for each target and program; what does not compile, and a self-test that fails, is added to `failed`."""
    (folder / "selftest.mjs").write_text(_RUN_WASM, encoding="utf-8")
    for subject in subjects:
        for file, text in subject.files().items():
            (folder / file).write_text(text, encoding="utf-8")
    for target in targets:
        for subject in subjects:
            if subject.calls_exp and not target.hosted:
                continue  # exp is all that a program asks of a machine
            try:
                size = compiled(subject, target, folder)
                ran = selftest(subject, target, folder)
                yield target.name, subject.name, "yes", ran, *map(str, size)
            except CompilerError as error:
                failed.append(f"{target.name}, {subject.name}: {error}")
                yield target.name, subject.name, "no", "", "", "", "", ""


def compiled(subject: PortableProgram, target: TargetMachine, folder: Path) -> MachineBytes:
    """A program alone, compiled for a machine with nothing on it. CompilerError where that says a word."""
    triple = target.hosted if subject.calls_exp else target.bare
    single = subject.request.precision == "single"
    flags = (*_STRICT, *(_NO_DOUBLES if single else ()), *target.options)
    frames = ("-Wframe-larger-than=0", "-Wno-error=frame-larger-than")  # tells the frame of each function
    said = started(
        [*_ZIG, "-target", triple, *flags, *frames, "-c", f"{subject.name}.c", "-o", "object"], folder, _SECONDS
    )
    warned = re.findall(r"^.*(?:warning|error): .*$", said.errors, re.MULTILINE)
    sizes = [re.search(r"stack frame size \((\d+)\) exceeds limit \(0\)", line) for line in warned]
    if said.status != 0 or None in sizes:
        raise CompilerError(said.errors)
    stack = sum(int(size[1]) for size in sizes if size)
    found = sections(folder / "object")
    return MachineBytes(
        text=sum(size for name, size in found.items() if name.startswith((".text", "code"))),
        rodata=sum(size for name, size in found.items() if name.startswith((".rodata", ".rdata", "constant"))),
        data=sum(size for name, size in found.items() if name.startswith((".data", ".bss", ".tdata", "writable"))),
        stack=stack,
    )


def selftest(subject: PortableProgram, target: TargetMachine, folder: Path) -> str:
    """That the self-test passes on the machine, or why it was not run. CompilerError where it fails."""
    if not target.runner:
        return "not run"
    if missing := absent(*(program for program in target.runner[:1] if not program.startswith("."))):
        return f"not run: no {missing[0]}"
    files = (f"{subject.name}.c", f"{subject.name}_selftest.c")
    said = started([*_ZIG, "-target", target.hosted, *files, "-o", "selftest", "-lm"], folder, _SECONDS)
    if said.status == 0:
        said = started(target.runner, folder, _SECONDS)
    if said.status != 0:
        raise CompilerError(f"self-test: {said.out}{said.errors}")
    return "passes"


def sections(file: Path) -> dict[str, int]:
    """Bytes of each section of an object file."""
    content = file.read_bytes()
    if content.startswith(b"\0asm"):
        return _wasm(content)
    listed = started(["size", "-A", file.name], file.parent, _SECONDS).out
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

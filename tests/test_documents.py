"""README.md, CONTRIBUTING.md, docs/, examples/: what they tell to type is run, and what they show is what comes out.

The first word after ``` says what a block is, a second one the file that it is saved as:
toml, c     a scene or a sweep, a program in C; a later command uses the file
csv         a record, which a scene or a command uses
python      a program, which runs
sh          commands, line by line
text        all that the block before it puts out, to the character; of what takes long only with patience
picture     for the eye only
console     what the checks of this project run themselves: `make demo`, `make test`
others      what another test reads: those of READ_ELSEWHERE
"""

from __future__ import annotations

import importlib
import io
import os
import re
import shlex
import shutil
import stat
import subprocess
import sys
from contextlib import chdir, redirect_stderr, redirect_stdout
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import click
import numpy as np
import pytest

import wavesym
from tests.cli.test_cli import example
from wavesym.cli import COMMANDS, cli, main
from wavesym.running.toolchain import compiler
from wavesym.scene import Scene
from wavesym.sweeps.plan import plan
from wavesym.sweeps.request import SweepRequest

ROOT = Path(wavesym.__file__).parents[1]
PAGES = sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").rglob("*.md"))
GUIDE = [page for page in PAGES if page.startswith("docs/guide/")]
REFERENCE = [page for page in PAGES if page.startswith("docs/reference/")]
TUTORIALS = [page for page in PAGES if page.startswith("docs/tutorials/")]
EXAMPLES = sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "examples").rglob("*.md"))
DOCUMENTS = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "llms.txt", *PAGES, *EXAMPLES)
QUICK = [name for name in DOCUMENTS if name not in EXAMPLES and name not in TUTORIALS]
SECONDS = {  # whose commands others have
    "docs/reference/commands.md",
    *(f"docs/guide/{page}.md" for page in ("bound", "c", "chains", "pictures", "results", "units")),
}
READ_ELSEWHERE = {"order", "exceptions", "exact", "walls"}  # of architecture.md, by test_architecture.py
TREE = re.compile(r"(wavesym|tests|templates|docs|bench|generated|examples)/[\w./-]*$")
LONG = re.compile(
    r"sed .*= 1e7.* \| wavesym run"
    r"|(sed .*= 1e4.* \| )?wavesym (chart|verify|plot --published|plot \S+ --kind xt|generate \S+ --target|inspect -)"
)  # seconds and more; what is only inspected on standard input is far too long a scene
ELSEWHERE = re.compile(r"wavesym stability\b")  # minutes: slow tests in tests/lab draw the same curves
COMPILED = "wavesym.model("  # of a block of Python: it waits for a compiler
SHELL = set("|<>;&$`*?~=")  # what a line is for a shell with, but for these two endings
UNREAD = "..."  # what a command that takes long puts out, for whom has no patience
TELLING = ["||", "echo", "exit status $?"]

BLOCK = re.compile(r"^```(.*)\n((?:.*\n)*?)^```$\n", re.MULTILINE)
SPAN = re.compile(r"`([^`\n]+)`")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)
LINK = re.compile(r"\]\(([^)#:]*)(?:#([^)]*))?\)")


class Block(NamedTuple):
    """A block of code: what it is, the file that it is saved as, if any, and its text."""

    language: str
    file: str
    text: str


def document(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def blocks(text: str) -> list[Block]:
    """The blocks of code of a document, all of them."""
    left = BLOCK.sub("\n\n", f"\n\n{text}")
    assert "```" not in left, "a block has no end"
    assert "~~~" not in left, "a block between other marks"
    assert not re.search(r"\n\n(?: {4}|\t)", left), "code that is only indented"
    return [Block(*(*words.split(maxsplit=1), "", "")[:2], code) for words, code in BLOCK.findall(text)]


class Reader:
    """Does in a folder what a document says; with `patience` what takes long too, and each command as a process."""

    def __init__(self, folder: Path, patience: bool, beside: Path | None = None) -> None:
        """`beside` is a folder of examples/, whose scenes and records a document does not show; copies are read."""
        self.folder, self.patience = folder, patience
        if beside:
            shutil.copytree(ROOT / "examples", folder / "examples", ignore=shutil.ignore_patterns("*.png"))
            self.folder = folder / beside.relative_to(ROOT)
        self.unused: set[str] = set()
        self.used_elsewhere: set[str] = set()
        self.unread = False  # a command of this block, since it takes long
        programs = folder / "bin"
        programs.mkdir()
        program, *given = compiler().command
        cc = programs / "cc"  # the compiler of this machine, whatever it is called
        quick = "" if patience else " -O0"  # instead of what the line says
        cc.write_text(f'#!/bin/sh\nexec {shlex.join([shutil.which(program) or program, *given])} "$@"{quick}\n')
        cc.chmod(cc.stat().st_mode | stat.S_IXUSR)
        path = [str(programs), str(Path(sys.executable).parent), os.environ["PATH"]]
        self.environment = os.environ | {"PATH": os.pathsep.join(path)}

    def read(self, text: str) -> int:
        """How many blocks there are, each of them followed."""
        printed, followed = None, 0
        for block in blocks(text):
            printed = self.follow(block, printed)
            followed += 1
        assert self.unused <= self.used_elsewhere, "saved and never used"
        return followed

    def share(self, pages: list[str]) -> None:
        """Save what other pages of a book show: a page may use it, and use of it there counts."""
        for block in (block for page in pages for block in blocks(document(page))):
            if block.file:
                (self.folder / block.file).write_text(block.text, encoding="utf-8")
            elif block.language == "sh":
                self.used_elsewhere |= words_of_files(block.text)

    def follow(self, block: Block, before: str | None) -> str | None:
        """What a block puts out; None of one that runs nothing, or not all."""
        if block.file:
            (self.folder / block.file).write_text(block.text, encoding="utf-8")
        match block.language:
            case "toml":
                if "[vary]" in block.text:
                    plan(*reversed(SweepRequest.read(self.folder / block.file)))
                else:
                    Scene.from_toml(self.folder / block.file)
                self.unused.add(block.file)
            case "c":
                self.unused.add(block.file)
            case "csv":
                self.unused.add(block.file)
            case "python":
                self.unused -= {file for file in self.unused if f'"{file}"' in block.text}
                if COMPILED in block.text and not self.patience:
                    return UNREAD
                return self.process([sys.executable, "-c", block.text]) if self.patience else self.program(block.text)
            case "sh":
                self.unread = False
                lines = [self.line(line) for line in block.text.splitlines() if line.partition("#")[0].strip()]
                if None in lines:
                    return None
                return UNREAD if UNREAD in lines else "".join(filter(None, lines))
            case "text":
                assert before == UNREAD or block.text == before
            case other if other in {"picture", "console", *READ_ELSEWHERE}:
                return before
            case _:
                raise AssertionError(f"no way to run {block.language or 'what has no language'}")
        return None

    def line(self, line: str) -> str | None:
        """What a command puts out; None of one that is not run, UNREAD of one that takes too long."""
        self.unused -= words_of_files(line)
        words = shlex.split(line, comments=True)
        if self.unread and words[0] != "wavesym":  # it looks at what would have been made
            return UNREAD
        if words[0] == "make":
            assert_made(words[1:])
            return None
        if ELSEWHERE.match(line) or (LONG.match(line) and not self.patience):
            ours = words[words.index("wavesym") :]
            assert_spelt(ours[: ours.index("|")] if "|" in ours else ours)
            self.unread = True
            return UNREAD
        told = words[-3:] == TELLING
        words = words[:-3] if told else words
        file = words.pop() if words[-2:-1] == [">"] else None
        words = words[:-1] if file else words
        if self.patience or not words_of_pipe(words):
            return self.process(["bash", "-c", line])
        given = ""
        for stage in words_of_pipe(words):
            if stage[0] == "wavesym":
                given = self.here(stage[1:], file, given, told=told)
            else:
                given = self.process(stage, given)
        return given

    def here(self, arguments: list[str], file: str | None, given: str, *, told: bool) -> str:
        """What a command of wavesym puts out, without the second that a process takes to start.

        Standard input is what is `given`. Standard output goes into a `file`, where there is one; a status other than 0
        is wrong where it is not `told`.
        """
        out, err, before = io.StringIO(), io.StringIO(), sys.stdin
        with chdir(self.folder), redirect_stdout(out), redirect_stderr(err if file else out):
            sys.stdin = io.TextIOWrapper(io.BytesIO(given.encode()))
            try:
                status = main(arguments)
            finally:
                sys.stdin = before
        assert status == 0 or told, out.getvalue() + err.getvalue()
        if file:
            (self.folder / file).write_text(out.getvalue(), encoding="utf-8")
            out = err
        return out.getvalue() + (f"exit status {status}\n" if status else "")

    def program(self, text: str) -> str:
        """What a program in Python puts out, in this process, which imports from the folder and forgets it then."""
        out, known = io.StringIO(), set(sys.modules)
        importlib.invalidate_caches()
        with chdir(self.folder), redirect_stdout(out), redirect_stderr(out), pytest.MonkeyPatch.context() as patch:
            patch.syspath_prepend(self.folder)
            try:
                exec(compile(text, "<block>", "exec"), {"__name__": "__main__"})
            except Exception as error:
                raise AssertionError(f"{text}\n{out.getvalue()}{type(error).__name__}: {error}") from error
        for name in set(sys.modules) - known:
            if str(getattr(sys.modules[name], "__file__", "")).startswith(str(self.folder)):
                del sys.modules[name]
        return out.getvalue()

    def process(self, command: list[str], given: str = "") -> str:
        done = subprocess.run(
            command,
            input=given,
            cwd=self.folder,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            encoding="utf-8",
            check=False,
        )
        assert done.returncode == 0, f"{command[-1]}\n{done.stdout}"
        return done.stdout


def words_of_files(text: str) -> set[str]:
    """What may be the name of a file, without its folder, in lines of commands."""
    return set(re.split(r"[\s/]+", text))


def words_of_pipe(words: list[str]) -> list[list[str]]:
    """The commands of a line one after another; none where there is more to a line than that, or nothing of wavesym."""
    stages = [list(stage) for bar, stage in groupby(words, "|".__eq__) if not bar]
    plain = all(stage[0] in {"wavesym", "sed", "head", "tail", "grep", "cmp"} for stage in stages)
    ours = [stage for stage in stages if stage[0] == "wavesym"]
    return stages if plain and len(ours) == 1 and not any(SHELL & set(word) for word in ours[0]) else []


def reader(name: str, folder: Path, patience: bool) -> Reader:
    """Of a document of the project."""
    made = Reader(folder, patience, (ROOT / name).parent if name in EXAMPLES else None)
    if name in GUIDE:
        made.share([page for page in GUIDE if page != name])
    if name in TUTORIALS:  # as from the root of the repository
        shutil.copytree(ROOT / "examples" / "records", folder / "examples" / "records")
    return made


def book(pages: list[str]) -> str:
    """The text of several pages, one after another."""
    return "\n".join(map(document, pages))


def assert_made(targets: list[str]) -> None:
    """These are targets of the Makefile."""
    known = set(re.findall(r"^([a-z-]+):", document("Makefile"), re.MULTILINE))
    assert targets
    assert known >= set(targets)


def options(command: click.Command) -> set[str]:
    return {"--help", *(option for parameter in command.params for option in parameter.opts)}


def command(name: str) -> click.Command:
    found = cli.get_command(click.Context(cli), name)
    assert found, f"no command {name}"
    return found


def assert_spelt(words: list[str]) -> None:
    """This names a command of wavesym, and options that it has."""
    assert words[0] == "wavesym"
    if words[1].startswith("-"):
        assert words[1] in options(cli)
        return
    assert {word for word in words if word.startswith("-") and word != "-"} <= options(command(words[1]))


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in SECONDS else name for name in QUICK]
)
def test_what_a_document_says_works(name: str, tmp_path: Path) -> None:
    assert reader(name, tmp_path, patience=False).read(document(name)) == document(name).count("```") // 2


@pytest.mark.slow
@pytest.mark.parametrize("name", DOCUMENTS)
def test_all_that_a_document_says_works(name: str, tmp_path: Path) -> None:
    follower = reader(name, tmp_path, patience=True)
    assert follower.read(document(name)) == document(name).count("```") // 2
    if name in EXAMPLES:
        assert_kept(follower.folder, (ROOT / name).parent)


def assert_kept(made: Path, kept: Path) -> None:
    """What the commands of a page made is what is kept beside it: data, and pictures but for other fonts."""
    from matplotlib.image import imread

    assert {path.name for path in made.glob("*.png")} == {path.name for path in kept.glob("*.png")}
    for picture in made.glob("*.png"):
        now, then = (imread(folder / picture.name)[:, :, :3] for folder in (made, kept))
        assert now.shape == then.shape, picture.name
        assert np.mean(np.abs(now - then)) < 2e-3, f"{picture.name}: make examples"
    for data in kept.glob("*.csv"):
        assert (made / data.name).read_bytes() == data.read_bytes(), data.name


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_the_example_in_the_help_of_a_command_works(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = shlex.join(["wavesym", *example(name, capsys)]).replace(" '>' ", " > ")
    if line not in re.findall(r"^(wavesym .*?) *(?:#.*)?$", book(GUIDE), re.MULTILINE):
        (tmp_path / "ground.csv").write_text("0,0\n0.02,0.3\n0.04,-0.2\n0.06,0\n")  # the record that `init` is given
        assert Reader(tmp_path, patience=True).line(line) is not None  # what is in the guide too is run there


@pytest.mark.parametrize("name", DOCUMENTS)
def test_what_a_document_names_exists(name: str) -> None:
    text = BLOCK.sub("", document(name))
    everything = options(cli).union(*(options(command(name)) for name in COMMANDS))
    for span in SPAN.findall(text):
        words = span.split()
        if words[0] == "make":
            assert_made(words[1:])
        elif words[0].endswith("wavesym") and len(words) > 1:
            assert_spelt(["wavesym", *words[1:]])
        elif words[0].startswith("--"):
            assert words[0] in everything, span
        elif TREE.match(span) and "NAME" not in span:
            assert (ROOT / span).exists(), span
    for file, heading in LINK.findall(text):
        target = (ROOT / name).parent / file if file else ROOT / name
        assert target.exists(), file
        if heading:
            assert heading in headings(target.read_text(encoding="utf-8")), heading


def headings(text: str) -> set[str]:
    """The anchors that a document has."""
    return {
        re.sub(r"[^a-z0-9 _-]", "", line.lower()).replace(" ", "-") for line in HEADING.findall(BLOCK.sub("", text))
    }


def test_every_page_can_be_found() -> None:
    """README.md links to those of docs/, to tutorials and how to contribute, guide and reference to their pages."""
    linked = {file for file, _ in LINK.findall(document("README.md"))}
    assert linked >= {"CONTRIBUTING.md", *TUTORIALS, *(page for page in PAGES if page.count("/") == 1)}
    assert {page for page in PAGES if f": {page}\n" in document("mkdocs.yml")} >= set(TUTORIALS)
    for first, pages in (("docs/guide.md", GUIDE), ("docs/reference.md", REFERENCE)):
        assert {f"docs/{file}" for file, _ in LINK.findall(document(first))} >= set(pages)


@pytest.mark.parametrize(
    ("pages", "lines"), [(TUTORIALS, 130), (GUIDE, 400), (REFERENCE, 700)], ids=["tutorials", "guide", "reference"]
)
def test_a_page_is_no_longer_than_is_read_at_once(pages: list[str], lines: int) -> None:
    assert pages
    assert [page for page in pages if document(page).count("\n") > lines] == []


def test_no_file_is_shown_twice_in_the_guide() -> None:
    """So a page may use what another one shows."""
    shown = [block.file for block in blocks(book(GUIDE)) if block.file]
    assert len(shown) == len(set(shown))


def test_the_readme_says_how_to_start_on_its_first_screen() -> None:
    first = document("README.md").splitlines()[:32]
    assert first[0] == "# wavesym"
    assert {"make demo", "make test"} <= {line.partition("  ")[0] for line in first}
    order = [line for line in first if re.match(r"# |\*\*|!\[|\*\w.*[.]\*$|- \*\*|make ", line)]
    kinds = [line[:2] for line in order]
    assert kinds == ["# ", "**", "![", "*w", "- ", "- ", "- ", "ma", "ma"], "a line, a picture, numbers, commands"
    assert document("README.md").count("\n") <= 140


def test_the_numbers_of_the_readme_are_those_of_the_bench() -> None:
    from tools.front_page import measurements

    assert measurements() in document("README.md")


def test_why_and_how_fast_stand_within_ten_seconds_of_the_readme() -> None:
    """At four words a second, from the title on. What describes a picture is heard, not read; its caption is read."""
    read, _, after = document("README.md").partition(" times that")
    assert after
    assert " proved below " in read
    words = re.sub(r"<.*?>|!\[.*?\]\(.*?\)", "", read).split()
    assert sum(any(map(str.isalnum, word)) for word in words) + 2 <= 40


def test_no_source_names_a_document_that_is_not_here() -> None:
    there = {Path(name).name for name in DOCUMENTS} | {"errata.md"}
    for path in (path for room in ("wavesym", "tests", "templates") for path in (ROOT / room).rglob("*.*")):
        if path.suffix in {".py", ".c", ".h", ".j2", ".toml"}:
            named = re.findall(r"\b(\w+\.md)\b", path.read_text(encoding="utf-8"))
            assert set(named) <= there, path


def test_the_reference_has_every_option_of_every_command() -> None:
    rows = re.findall(r"^\| (`wavesym (\w+).*)$", book(REFERENCE), re.MULTILINE)
    for name in COMMANDS:
        spans = " ".join(SPAN.findall("".join(row for row, named in rows if named == name)))
        wanted = {option for option in options(command(name)) if option.startswith("-")} - {"--help"}
        wanted -= {each for option in command(name).params if getattr(option, "hidden", False) for each in option.opts}
        assert wanted <= set(spans.split()), name


def test_the_reference_has_everything_public() -> None:
    code = set(re.findall(r"`wavesym\.(\w+)", book(REFERENCE)))
    assert code >= set(wavesym.__all__) - {"__version__"}


def test_the_reference_has_every_target_of_the_makefile() -> None:
    targets = set(re.findall(r"`make ([a-z-]+)`", book(REFERENCE)))
    assert targets == set(re.findall(r"^\.PHONY: (.*)$", document("Makefile"), re.MULTILINE)[0].split())


def test_the_guide_has_every_command() -> None:
    code = "".join(block.text for block in blocks(book(GUIDE)) if block.language == "sh")
    assert {name for name in COMMANDS if f"wavesym {name}" in code} == set(COMMANDS)


SCENE = """```toml rod.toml
name = "rod"
[system]
type = "drive"
m = 1
kappa = [1]
inertia = [1, 2]
[[load]]
body = 1
times = [0]
steps = [1]
[output]
until = 2
strain = [0.5]
```
"""
RUN = "```sh\nwavesym run rod.toml --samples 1   # a comment\n```\n"
SHOWN = "```text\ntau,strain@0.5\n0.0,0.0\n```\n"
PROGRAM = "```c main.c\nint main(void) { return 0; }\n```\n```sh\ncc main.c -o main\n./main\n```\n"
SOUND = SCENE + RUN + SHOWN + PROGRAM + "```python\nprint(1)\n```\n```text\n1\n```\n"


@pytest.mark.quick(1)
@pytest.mark.parametrize("patience", [False, True])
def test_a_sound_document_passes(patience: bool, tmp_path: Path) -> None:
    assert Reader(tmp_path, patience).read(SOUND) == SOUND.count("```") // 2


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("```python", "```pyhton"),
        ("```python", "```"),
        ("print(1)", "print(2)"),
        ("print(1)", "raise ValueError"),
        ("kappa = [1]", "kappa = []"),
        ("0.0,0.0\n", "0.0,0.1\n"),
        ("0.0,0.0\n", ""),
        (RUN, ""),
        (RUN, "```sh\nmake demo\n```\n"),
        ("--samples 1", "--sample_s 1"),
        ("run rod.toml", "run rot.toml"),
        ("wavesym run", "true; wavesym ran"),
        ("return 0;", "return 1;"),
        ("return 0;", "return zero;"),
        ("./main", "./mean"),
        ("cc main.c -o main\n./main", "true"),
        ("cc main.c", "make dmeo\ncc main.c"),
        ("cc main.c", "wavesym chart rod.toml -u rod.svg\ncc main.c"),
        ("```python\n", "    wavesym indented\n\n```python\n"),
        ("```python\n", "~~~\n~~~\n```python\n"),
        ("1\n```\n", "1\n"),
    ],
)
def test_a_broken_document_is_seen(old: str, new: str, tmp_path: Path) -> None:
    assert old in SOUND
    with pytest.raises((AssertionError, wavesym.SceneError)):
        Reader(tmp_path, patience=False).read(SOUND.replace(old, new))


@pytest.mark.parametrize(
    "words", ["wavesym rnu x", "wavesym run --sample 3", "wavesym --versoin", "wavesym verify --csv x"]
)
def test_a_wrong_spelling_is_seen(words: str) -> None:
    with pytest.raises(AssertionError):
        assert_spelt(words.split())

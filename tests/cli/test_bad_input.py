"""Bad input at scale: whatever a scene holds, the answer is a result or one line, soon and in little memory."""

from __future__ import annotations

import io
import os
import random
import re
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.cli.mutants import basic_string, mutant
from wavesym import rendering
from wavesym.cli import main
from wavesym.errors import MOST_FAULTS, CostError, WavesymError
from wavesym.scene import Scene

pytestmark = pytest.mark.skipif(os.name == "nt", reason="limits of time and memory are of another kind there")

SECONDS = 10.0  # of processor time, so that a busy machine does not count; what is refused takes a few
MEMORY = 1 << 30

Request = Callable[[random.Random], list[str]]

# what names a key, an option, or says that there is no scene at all
NAMED = re.compile(
    r'bad\.toml: (?:(?:[\w.-]|\[\d+\]|"[^\n]*(?:"|\.\.\.))+: '
    r"|not TOML, |empty; |byte \d+ is not UTF-8; |larger than |and \d+ more faults|tables or lists too deep"
    r"|an integer has more than |more than |line \d+: )"
)


class Answer(NamedTuple):
    """What a request was answered with."""

    status: object
    out: str
    err: str
    seconds: float


def ask(*arguments: str) -> Answer:
    """A request in this process."""
    out, err = io.StringIO(), io.StringIO()
    began = time.process_time()
    with redirect_stdout(out), redirect_stderr(err):
        status = main(arguments)
    return Answer(status, out.getvalue(), err.getvalue(), time.process_time() - began)


def read() -> Answer:
    """The reading alone, with which every request begins."""
    began = time.process_time()
    status, err = 0, ""
    try:
        Scene.from_toml("bad.toml")
    except WavesymError as error:
        status, err = error.status, f"{error}\n"
    return Answer(status, "", err, time.process_time() - began)


def faults(answer: Answer, left: set[str], unmet: bool = False) -> list[str]:
    """What is wrong with an answer; `left` are the files there now besides the scene."""
    found = []
    lines = answer.err.splitlines()
    if answer.status not in ((0, 1, 2) if unmet else (0, 2)):
        found.append(f"status {answer.status}")
    if answer.status != 0:
        if not 0 < len(lines) <= MOST_FAULTS + 1 or not all(line.isprintable() and len(line) <= 700 for line in lines):
            found.append("not a line for each fault")
        elif not all(map(NAMED.match, lines)):
            found.append("names no file and key")
        if answer.status == 1 and ": output.tolerance: " not in answer.err:
            found.append("1, but for a tolerance")
        if left:
            found.append(f"left {left}")
    if answer.seconds > SECONDS:
        found.append(f"took {answer.seconds:.1f} s")
    return found


@contextmanager
def little_memory() -> Iterator[None]:
    """No more than MEMORY on top of what is used now; a MemoryError beyond it.

    Measured, as a limit would end this process: the libraries abort where there is none left.
    """
    begun = _memory(reset=True)
    yield
    if _memory() > begun + MEMORY:
        raise MemoryError(f"{_memory() - begun} bytes more")


def _memory(reset: bool = False) -> int:
    """The most memory that was in use, in bytes, since it was last reset; 0 where the system does not say."""
    if not Path("/proc/self/clear_refs").exists():
        return 0
    if reset:
        Path("/proc/self/clear_refs").write_text("5")
    return int(re.search(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text())[1]) * 1024  # type: ignore[index]


def reading(_: random.Random) -> list[str]:
    """No request at all."""
    return ["read"]


def cheap(rng: random.Random) -> list[str]:
    """Requests whose cost is mostly that of reading."""
    return rng.choice([["tables", "bad.toml", "--intervals", "2"], ["run", "bad.toml", "--samples", "3"]])


def any_request(rng: random.Random) -> list[str]:
    """Requests that go through everything."""
    evaluator, precision = rng.choice(["auto", "closed", "pieces", "march"]), rng.choice(["double", "single"])
    return rng.choice(
        [
            ["generate", "bad.toml", "-o", "out", "--language", "all"],
            ["generate", "bad.toml", "-o", "out", "--evaluator", evaluator, "--precision", precision],
            ["run", "bad.toml", "--samples", "11", "-o", "out.csv"],
            ["tables", "bad.toml", "-o", "out.csv"],
            ["tables", "bad.toml", "--intervals", "3", "--format", "json", "-o", "out.csv"],
            ["tables", "bad.toml", "--intervals", "1000000000", "-o", "out.csv"],
        ]
    )


def hunt(folder: Path, seeds: range, request: Request) -> tuple[Counter[object], list[str]]:
    """How often each status was met, and what was found wrong, with the seed that shows it."""
    os.chdir(folder)
    statuses: Counter[object] = Counter()
    found = []
    for seed in seeds:
        Path("bad.toml").write_bytes(mutant(seed))
        arguments = request(random.Random(seed))
        try:
            with little_memory():
                answer = read() if arguments == ["read"] else ask(*arguments)
        except BaseException as error:
            found.append(f"{seed} {' '.join(arguments)}: {type(error).__name__}: {error}"[:300])
        else:
            statuses[answer.status] += 1
            left = {path.name for path in Path().iterdir()} - {"bad.toml"}
            unmet = arguments[0] in ("generate", "run")  # which takes a program where exact values cost too much
            found += [
                f"{seed} {' '.join(arguments)}: {fault}: {answer.err[:200]}" for fault in faults(answer, left, unmet)
            ]
        shutil.rmtree("out", ignore_errors=True)
        Path("out.csv").unlink(missing_ok=True)
    return statuses, found


@pytest.mark.parametrize(
    ("seeds", "request_"),
    [(range(400), reading), (range(100_000, 100_060), cheap), (range(200_000, 200_040), any_request)],
    ids=["read", "cheap", "any"],
)
def test_mutants_are_answered_or_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seeds: range, request_: Request, thorough: bool
) -> None:
    monkeypatch.chdir(tmp_path)
    seeds = seeds if thorough else seeds[: max(40, len(seeds) // 4)]  # of fewer too few are served to say many
    statuses, found = hunt(tmp_path, seeds, request_)
    assert not found
    assert statuses[0] > 0.1 * len(seeds) < statuses[2]  # of both there are many


@pytest.mark.slow
@pytest.mark.parametrize("first", range(1_000_000, 1_020_000, 10_000))
def test_twenty_thousand_mutants(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, first: int) -> None:
    monkeypatch.chdir(tmp_path)
    for part, request_ in (
        (range(first, first + 9_000), reading),
        (range(first + 9_000, first + 9_900), cheap),
        (range(first + 9_900, first + 10_000), any_request),
    ):
        statuses, found = hunt(tmp_path, part, request_)
        assert not found
        assert statuses.total() == len(part)


@pytest.mark.slow
def test_the_hunt_finds_what_is_wrong(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    good = Answer(2, "", "bad.toml: system.m: 0 is not an integer of 1 or more; write one\n", 0.1)
    assert not faults(good, set())
    for wrong in (
        good._replace(status=1),
        good._replace(status=None),
        good._replace(err="Traceback (most recent call last):\n"),
        good._replace(err="bad.toml: something is wrong\n"),
        good._replace(err="output.until: too long\n"),
        good._replace(seconds=100.0),
    ):
        assert faults(wrong, set(), unmet=True)
    assert faults(good, {"out.csv"})

    def broken(_: object) -> None:
        raise RecursionError

    monkeypatch.setattr("wavesym.scene.scene.read_toml", broken)
    assert "RecursionError" in hunt(tmp_path, range(1), cheap)[1][0]
    if _memory():
        with pytest.raises(MemoryError), little_memory():
            assert b"x" * (MEMORY + MEMORY // 8)


def test_mutants_are_the_same_everywhere() -> None:
    assert mutant(7) == mutant(7) != mutant(8)
    assert len({mutant(seed) for seed in range(500)}) > 450


DRIVE = """name = "bad"
system = {{type = "drive", m = {m}, kappa = {kappa}, inertia = {inertia}}}
load = [{{body = 1, times = {times}, steps = {steps}}}]
output = {{until = {until}, tolerance = {tolerance}, strain = {strain}}}
"""


def drive(m: int = 1, kappa: str = "1", times: int = 1, until: str = "10", tolerance: str = "1e-6", outputs: int = 1):
    """A drive that may be absurd."""
    places = [f"{k + 1}/{outputs + 1}" for k in range(outputs)]
    return DRIVE.format(
        m=m,
        kappa=f"[{', '.join([kappa] * m)}]",
        inertia=f"[{', '.join(['1'] * (m + 1))}]",
        times=f"[{', '.join(f'{k}e-4' for k in range(times))}]",
        steps=f"[{', '.join(['1'] * times)}]",
        until=until,
        tolerance=tolerance,
        strain=str(places),
    )


ABSURD = {
    "long": drive(until="1e9"),
    "light bodies": drive(kappa="1e4", until="50"),
    "lighter": drive(kappa="1e300"),
    "heavy": drive(kappa="1e-300"),
    "exact": drive(tolerance="1e-300"),
    "steps": drive(times=10**5),
    "outputs": drive(outputs=40, until="1"),
    "rods": drive(m=4000),
    "rods for long": drive(m=4000, until="1e6"),
}
LONG = ("steps", "light bodies", "rods", "rods for long")  # a few seconds for each request
REQUESTS = [
    ["generate", "bad.toml", "-o", "out", "--language", "all"],
    ["generate", "bad.toml", "-o", "out", "--evaluator", "march"],
    ["generate", "bad.toml", "-o", "out", "--precision", "single"],
    ["run", "bad.toml", "--samples", "3", "-o", "out.csv"],
    ["tables", "bad.toml", "-o", "out.csv"],
]


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in LONG else name for name in ABSURD]
)
def test_what_is_absurd_is_served_or_refused_soon(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.chdir(tmp_path)
    Path("bad.toml").write_text(ABSURD[name])
    for request in REQUESTS:
        with little_memory():
            answer = ask(*request)
        left = {path.name for path in Path().iterdir()} - {"bad.toml"}
        assert not faults(answer, left, unmet=True), request
        shutil.rmtree("out", ignore_errors=True)
        Path("out.csv").unlink(missing_ok=True)


PAYLOADS = [
    *("{{7*7}}", "{% include 'c/header.h.j2' %}", "{{ ''.__class__.__mro__ }}", "{# gone #}", "${7*7}", "%(name)s"),
    *("__import__('os').system('touch PWNED')", "$(touch PWNED)", "`touch PWNED`", "; touch PWNED", "| touch PWNED"),
    *(
        "*/ int x; /*",
        '"); system("touch PWNED',
        "\\input{/etc/passwd}",
        "\\write18{touch PWNED}",
        "../../PWNED",
        "a/b",
    ),
    *("\\x41", "%s%n", "\x1b[31m", "<script>", "1+1", "0.5+{{7*7}}", "lambda: 0", "-o", "--help", "~"),
]


def strings() -> Iterator[tuple[str, str]]:
    """Every string of a scene that has one of every kind, as a place to put another: (the scene, the string)."""
    scene = """name = "mine"
system = {type = "building", m = "2", kappa = ["1/4", "3/5", "1/5"], base = "force"}
load = [{times = ["0"], a = ["1"], b = ["1/2"]}, {spacing = "1/8", samples = ["1/3"]}]
output = {until = "2/1", tolerance = "1/9", strain = ["1-"], velocity = ["3/2"], displacement = ["7/4"]}
"key" = 1
"""
    for place in re.finditer(r'"[^"]*"', scene):
        yield scene[: place.start()] + "PAYLOAD" + scene[place.end() :], place.group()


@pytest.mark.parametrize("payload", PAYLOADS)
def test_payloads_in_strings_are_refused_as_they_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, payload: str
) -> None:
    """Each string of a scene is a name, a keyword or a number, and a payload is none of these."""
    monkeypatch.chdir(tmp_path)
    for scene, _ in strings():
        Path("bad.toml").write_text(scene.replace("PAYLOAD", basic_string(payload)), encoding="utf-8")
        answer = ask("generate", "bad.toml", "-o", "out", "--language", "all")
        assert not faults(answer, {path.name for path in Path().iterdir()} - {"bad.toml"})
        assert answer.status == 2
        assert "49" not in answer.err
    assert [path.name for path in tmp_path.iterdir()] == ["bad.toml"]
    assert not (tmp_path.parent / "PWNED").exists()


@pytest.mark.parametrize("payload", PAYLOADS)
def test_payloads_in_a_good_scene_stay_what_they_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, payload: str
) -> None:
    """In a comment, in the name of the file and in the folder's they are no part of what is generated."""
    monkeypatch.chdir(tmp_path)
    plain = drive(tolerance="1e-3", until="1").replace("bad", "good")
    Path("good.toml").write_text(plain)
    assert ask("generate", "good.toml", "-o", "good", "--language", "all").status == 0
    comment = payload.replace("\x1b", "")
    folder = payload.replace("/", "_").replace("..", "_")
    Path(f"{folder}.toml").write_text(f"# {comment}\n{plain}", encoding="utf-8")
    answer = ask("generate", f"./{folder}.toml", "-o", f"./{folder}", "--language", "all")
    assert answer.status == 0
    made = {path.name: path.read_bytes() for path in Path(f"./{folder}").iterdir()}
    assert made == {path.name: path.read_bytes() for path in Path("good").iterdir()}
    assert not list(tmp_path.parent.rglob("PWNED"))


@pytest.mark.slow
def test_payloads_in_the_environment_change_nothing(tmp_path: Path) -> None:
    """Nothing of wavesym's reads the environment."""
    code = "import sys; from wavesym.cli import main; sys.exit(main(['tables', 'drive_m1', '--intervals', '2']))"
    names = ("USER", "HOME", "TERM", "NAME", "WAVESYM", "WAVESYM_SCENE", "WAVESYM_TABLES_INTERVALS", "EDITOR", "PAGER")
    environment = os.environ | dict(zip(names, PAYLOADS, strict=False))
    plain, planted = (
        subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=env, capture_output=True, check=True)
        for env in (os.environ, environment)
    )
    assert (plain.stdout, plain.stderr) == (planted.stdout, planted.stderr)
    assert not list(tmp_path.iterdir())


def test_a_payload_that_reached_a_template_would_be_seen() -> None:
    """What is put into a template stays text, and what comes from a user is never compiled as one."""
    environment = rendering._environment()
    assert environment.from_string("{{ name }}").render(name="{{7*7}}") == "{{7*7}}"
    assert environment.from_string("{{7*7}}").render() == "49"
    sources = "".join(path.read_text() for path in Path(rendering.__file__).parent.rglob("*.py"))
    assert not re.search(r"from_string|\beval\(|\bexec\(|sympify|getenv|shell=True|pickle\.load", sources)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "darwin", reason="names there are UTF-8")
def test_names_that_are_no_utf8(tmp_path: Path) -> None:
    """They are printed as they are, or escaped on standard error."""
    scene, folder = os.fsdecode(b"\xff.toml"), os.fsdecode(b"\xfe")
    (tmp_path / scene).write_text(drive(until="1"))
    code = "import sys; from wavesym.cli import main; sys.exit(main())"
    for arguments, status in (
        (["generate", scene, "-o", folder], 0),
        (["generate", scene, "-o", "elsewhere\udcff", "--check"], 1),
        (["run", "no" + scene], 2),
    ):
        done = subprocess.run(
            [sys.executable, "-c", code, *arguments],
            cwd=tmp_path,
            env=os.environ | {"PYTHONIOENCODING": "utf-8:strict"},
            capture_output=True,
            check=False,
        )
        assert done.returncode == status, done.stderr
        assert b"Traceback" not in done.stderr
    assert (tmp_path / folder / "bad.c").is_file()


def test_verify_names_the_file_of_the_scene_it_refuses(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("good.toml").write_text(drive(until="1"))
    Path("bad.toml").write_text(drive(until="1").replace("bad", "other"))

    def checked(scenes: Iterator[Scene], *_: object, **__: object) -> None:
        for scene in scenes:
            if scene.name == "other":
                raise CostError("output.until: too far")

    monkeypatch.setattr("wavesym.api.verify", checked)
    for order in (["good.toml", "bad.toml"], ["bad.toml", "good.toml"], ["bad.toml"]):
        answer = ask("verify", *order)
        assert (answer.status, answer.err) == (2, "bad.toml: output.until: too far\n")

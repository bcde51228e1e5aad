"""Which mistakes in the proofs of the bounds the tests see: mutants of their rooms, run against the tests of these.

Each mutant is one file in a copy of the project, killed by the first test that fails or hangs. No test among them
compares with a kept text. known.toml lists, with the reason, mutants that change no value, or only make a bound larger
than it need be; they are counted and not run. `make mutants`, or `python -m tests.mutation.run --help`.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import signal
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager, suppress
from importlib.util import cache_from_source
from pathlib import Path
from queue import SimpleQueue
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import NamedTuple

from tests.mutation.operators import Mutant, Names, mutants

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("wavesym/programs/**/*.py", "templates/c/**/*.c", "templates/c/series.h")
ROOMS += tuple(
    f"wavesym/exact/{name}.py" for name in ("tables/ball", "contacts/events", "motion", "reference", "tables/signal")
)
ROOMS += tuple(f"wavesym/numbers/{name}.py" for name in ("balls", "chebyshev", "doubles", "reals"))
# All of it is run for a mutant that survives: it may take a minute and a half where a tenth of 300 do.
TESTS = ("programs", "numbers", "verification/test_properties.py")
TESTS += tuple(f"exact/test_{name}.py" for name in ("ball", "collision", "motion", "reference", "signal"))
TESTS += ("exact/test_joint.py", "exact/test_network_waves.py", "exact/test_arrivals.py")
TESTS += tuple(f"targets/test_{name}.py" for name in ("march_c", "march_short_panels", "selftest"))
TESTS += ("exact/test_enclosure.py",)
# run too for what is changed where a path has this: tests of the programs that are built of it
OWN = {"elimination": ("runtime", "stream"), "runtime": ("runtime",), "stream": ("stream",)}
OWN |= {"mode_sets": ("mode_sets",), "modes/": ("modes",)}
COPIED = ("wavesym", "templates", "tests", "examples", "pyproject.toml")
PYTEST = f"""ulimit -v {4 << 20}; exec "$0" -m pytest -x -q --tb=short -p no:cacheprovider --basetemp=tmp/pytest \
--hypothesis-profile=first_failure -o faulthandler_exit_on_timeout=true "$@" """
WANTED = 0.95  # of the mutants that make a bound false or a value wrong


class Verdict(NamedTuple):
    """What became of a mutant: "killed", "hung", "survived" or "known"; by which test, or for which reason."""

    mutant: Mutant
    fate: str
    why: str = ""
    seconds: float = 0.0


class Project:
    """A copy of the project, in which one file at a time is another."""

    def __init__(self, folder: Path) -> None:
        # in a folder of this name Hypothesis draws no constants from sources, and so the same examples for all mutants
        self.folder = folder / "test"
        (self.folder / "tmp").mkdir(parents=True)
        for name in COPIED:
            copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy2
            copy(ROOT / name, self.folder / name)

    @contextmanager
    def changed(self, mutant: Mutant) -> Iterator[None]:
        """The project with a mutant in place of its source."""
        path = self.folder / mutant.file
        right = path.read_text()
        _write(path, mutant.text)
        try:
            yield
        finally:
            _write(path, right)

    def run(self, tests: Sequence[str], usual: float = 600) -> tuple[int | None, str]:
        """The status of pytest after the first test that fails, None where it hangs, and what it says.

        One test may take as long as all of them do on what is right, `usual` seconds, and all of them four times that.
        """
        places = {"PYTHONPATH": str(self.folder), "TMPDIR": str(self.folder / "tmp"), "OMP_NUM_THREADS": "1"}
        told = self.folder / "told"
        with told.open("w") as out:
            process = subprocess.Popen(
                ["sh", "-c", PYTEST, sys.executable, "-o", f"faulthandler_timeout={usual}", *tests],
                cwd=self.folder,
                env=os.environ | places,
                stdout=out,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
            status = None
            try:
                with suppress(subprocess.TimeoutExpired):
                    status = process.wait(4 * usual)
            finally:
                with suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)  # programs that tests have started too
                process.wait()
        return status, told.read_text(errors="replace")

    def judge(self, mutant: Mutant, usual: float) -> Verdict:
        """Whether the tests see a mutant."""
        begun = perf_counter()
        with self.changed(mutant):
            status, told = self.run(related(mutant.file), usual)
        seconds = perf_counter() - begun
        if status == 0:
            return Verdict(mutant, "survived", "", seconds)
        if failed := re.search(r"^(?:FAILED|ERROR) (\S+)", told, re.MULTILINE):
            return Verdict(mutant, "killed", failed[1], seconds)
        hung = status is None or "Timeout (" in told
        return Verdict(mutant, "hung" if hung else "killed", f"status {status}", seconds)


def _write(path: Path, text: str) -> None:
    # Python's cache takes two texts of one length in one second for one
    Path(cache_from_source(str(path))).unlink(missing_ok=True)
    path.write_text(text)


def related(file: str) -> list[str]:
    """The files of tests, those first whose names have most in common with that of a mutated file."""
    given = [ROOT / "tests" / name for name in TESTS]
    files = [path for test in given for path in (sorted(test.rglob("test_*.py")) if test.is_dir() else [test])]
    own = {name for part, names in OWN.items() if part in file for name in names}
    files += [path for name in sorted(own) for path in sorted((ROOT / "tests/targets").glob(f"test_{name}_*.py"))]
    names = [path.relative_to(ROOT).as_posix() for path in files]
    return sorted(names, key=lambda name: -len(_words(file) & _words(name)))


def _words(file: str) -> set[str]:
    return set(re.findall(r"[a-z]+", file)) - {"py", "test", "tests", "targets"}


def places(only: Sequence[str] = ()) -> list[list[Mutant]]:
    """The mutants of every place of the rooms, or of those files whose names contain one of `only`."""
    files = sorted(path.relative_to(ROOT).as_posix() for room in ROOMS for path in ROOT.glob(room))
    wanted = [file for file in files if not only or any(part in file for part in only)]
    return [place for file in wanted for place in mutants(file, (ROOT / file).read_text())]


def sample(found: Sequence[Sequence[Mutant]], count: int, seed: int) -> list[Mutant]:
    """One mutant each of so many places; the same ones whatever changes elsewhere."""
    drawn = [min(place, key=lambda mutant: mutant.lot(seed)) for place in found]
    return sorted({mutant.names: mutant for mutant in drawn}.values(), key=lambda mutant: mutant.lot(seed))[:count]


def known() -> dict[Names, str]:
    """Why a mutant need not be killed."""
    listed = tomllib.loads((ROOT / "tests/mutation/known.toml").read_text())
    return {
        (file, each["function"], each["right"], each["wrong"]): f"{each['kind']}: {each['reason']}"
        for file, entries in listed.items()
        for each in entries
    }


def judged(chosen: Sequence[Mutant], jobs: int) -> Iterator[Verdict]:
    """The verdicts as they come, in so many projects at once."""
    with TemporaryDirectory(prefix="mutants-") as folder, ThreadPoolExecutor(jobs) as pool:
        free: SimpleQueue[Project] = SimpleQueue()
        for job in range(jobs):
            free.put(project := Project(Path(folder) / str(job)))
        begun = perf_counter()
        status, told = project.run(related(""))
        if status != 0:
            sys.exit(f"tests fail on the project as it is:\n{told[-3000:]}")
        usual = perf_counter() - begun
        print(f"all tests on the project as it is: {usual:.0f} s", flush=True)

        def judge(mutant: Mutant) -> Verdict:
            project = free.get()
            try:
                return project.judge(mutant, usual)
            finally:
                free.put(project)

        try:
            for future in as_completed([pool.submit(judge, mutant) for mutant in chosen]):
                yield future.result()
        finally:
            pool.shutdown(cancel_futures=True)  # where this ends early


def report(verdicts: Sequence[Verdict]) -> str:
    """Markdown: a row for each file; survivors with their lines; what is known, with its reason."""
    counts = Counter((verdict.mutant.file, verdict.fate) for verdict in verdicts)
    files = sorted({verdict.mutant.file for verdict in verdicts})
    text = ["| file | made | killed | of them by time | known | survived | share |", "|---|---|---|---|---|---|---|"]
    for name, rows in [*((file, [file]) for file in files), ("all", files)]:
        total = {fate: sum(counts[file, fate] for file in rows) for fate in ("killed", "hung", "known", "survived")}
        killed, hung, listed, survived = total.values()
        share = f"{(killed + hung) / (killed + hung + survived):.1%}" if killed + hung + survived else ""
        text.append(f"| {name} | {sum(total.values())} | {killed + hung} | {hung} | {listed} | {survived} | {share} |")
    for fate in ("survived", "known"):
        found = sorted((each for each in verdicts if each.fate == fate), key=lambda each: each.mutant.names)
        text += ["", f"## {fate.capitalize()}: {len(found)}", ""]
        text += [f"{each.mutant}{each.why and f'    {each.why}'}\n" for each in found]
    return "\n".join(text)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=300, help="how many mutants (300)")
    parser.add_argument("--seed", type=int, default=1, help="which ones (1)")
    parser.add_argument("--only", action="append", default=[], metavar="FILE", help="of files whose names contain this")
    parser.add_argument("--jobs", type=int, default=2, help="how many at once (2)")
    parser.add_argument("--list", action="store_true", help="name them, run none")
    parser.add_argument("--known", action="store_true", help="run those in known.toml too")
    parser.add_argument("--key", help="run one, and show what pytest says")
    parser.add_argument("--write", type=Path, metavar="PATH", help="write the report there, in Markdown")
    asked = parser.parse_args()
    found = places(asked.only)
    if asked.key:
        (mutant,) = {mutant.names: mutant for place in found for mutant in place if mutant.key == asked.key}.values()
        with TemporaryDirectory(prefix="mutants-") as folder, (project := Project(Path(folder))).changed(mutant):
            status, told = project.run(related(mutant.file), 60)
        print(mutant, told, sep="\n")
        return status or 0
    chosen = sample(found, asked.count, asked.seed)
    if asked.list:
        print(*chosen, sep="\n")
        return 0
    print(f"{len(chosen)} mutants of {sum(map(len, found))} at {len(found)} places, seed {asked.seed}", flush=True)
    begun = perf_counter()
    reasons = {} if asked.known else known()
    verdicts = [Verdict(mutant, "known", reasons[mutant.names]) for mutant in chosen if mutant.names in reasons]
    for verdict in judged([mutant for mutant in chosen if mutant.names not in reasons], asked.jobs):
        verdicts.append(verdict)
        mutant, fate, why, seconds = verdict
        print(f"{len(verdicts):4} {fate:8} {seconds:4.0f} s  {mutant.key} {mutant.file}  {why}", flush=True)
    print("\n" + (text := report(verdicts)), f"{(perf_counter() - begun) / 60:.0f} min", sep="\n")
    if asked.write:
        asked.write.parent.mkdir(parents=True, exist_ok=True)
        asked.write.write_text(text)
    fates = Counter(verdict.fate for verdict in verdicts)
    return int(fates["survived"] > (1 - WANTED) * (len(verdicts) - fates["known"]))


if __name__ == "__main__":
    sys.exit(main())

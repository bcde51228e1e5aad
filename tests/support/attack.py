"""Generated programs run where they are likeliest to be wrong, and held against the exact solution.

`python -m tests.support.attack --count 400 --seed 1` draws scenes and prints a table, then each scene that was missed.
"""

from __future__ import annotations

import argparse
import ctypes
import json
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np
from flint import arb, ctx
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support.generated import files
from tests.support.scenes import as_toml, scenes
from tests.support.truth import Truth
from wavesym.errors import CostError, RangeError, ToleranceError
from wavesym.numbers.arrays import Array
from wavesym.running.compilation import FLAGS, import_text
from wavesym.running.toolchain import compiler
from wavesym.scene import Scene, lower

EVALUATORS = ("closed", "pieces", "march")
PRECISIONS = {"double": np.float64, "single": np.float32}
FUSED = ("-std=c99", "-O3", "-march=native", "-ffp-contract=fast")
MOST = 240
"""Instants at which a program is asked."""
GRID = 65
"""Samples of NAME_sample."""


@dataclass(frozen=True)
class Outcome:
    """What came of a program. `worst` is its largest error, in parts of what it says is the largest."""

    evaluator: str
    precision: str
    language: str
    refusal: str = ""
    fault: str = ""
    """What ended it, other than a refusal."""
    values: int = 0
    worst: float = 0.0
    output: str = ""
    tau: float = 0.0
    """Where that was."""
    seconds: float = 0.0
    """What it took to generate."""

    def __str__(self) -> str:
        what = f"{self.worst:.3g} times the bound for {self.output} at tau = {self.tau!r}"
        return f"{self.evaluator}, {self.language}, {self.precision}: {self.refusal or self.fault or what}"


class Exam:
    """The exact outputs of a scene up to TAU_MAX, at fronts, hardly before and after them, and in between."""

    def __init__(self, scene: Scene, precision: str, tau_max: float) -> None:
        self.real = PRECISIONS[precision]
        self.tau_max = tau_max
        end = Fraction(tau_max)
        self._truth = Truth(scene, end)
        self._outputs = range(len(scene.outputs))
        self._largest = [self._truth.largest(k, end)[1] for k in self._outputs]
        self.grid = self.real(tau_max / (GRID - 1)) * np.arange(GRID, dtype=self.real)
        self.taus = np.union1d(self._instants(), self.grid[self.grid <= tau_max]).astype(self.real)
        self._values = {float(tau): self._exact(Fraction(float(tau))) for tau in self.taus}

    def _exact(self, tau: Fraction) -> list[arb]:
        return [self._truth.value(k, tau) for k in self._outputs]

    def _instants(self) -> NDArray[np.floating]:
        """Some of the numbers next to fronts, or near them, and others."""
        rng = np.random.default_rng(1)
        real, end = self.real, self.real(self.tau_max)
        fronts = {t for k in self._outputs for t in self._truth.arrivals(k)}
        near = []
        for front in sorted(fronts):
            at = real(float(front))
            near += [at, np.nextafter(at, real(0)), *_after(at, 3)]
            near += [real(float(front + Fraction(1, 2**k))) for k in range(1, 44, 3)]
        if len(near) > MOST:
            near = rng.choice(near, MOST, replace=False)
        ends = [real(0), *_after(real(0), 1), end, np.nextafter(end, real(0))]
        tiny = self.tau_max * 10.0 ** -np.arange(1, 24, 4)
        taus = np.array([*near, *ends, *tiny, *rng.uniform(0, self.tau_max, 40)], dtype=real)
        return taus[(taus >= 0) & (taus <= end)]

    def judge(self, taus: NDArray[np.floating], found: Array, bounds: list[float]) -> tuple[float, int, float]:
        """The largest error in parts of what is allowed; its output, and tau.

        What is 0 up to TAU_MAX must be so exactly. Otherwise rounded towards innocence.
        """
        worst = (0.0, 0, 0.0)
        with ctx.workprec(100):
            for k in self._outputs:
                allowed = arb(bounds[k]) * self._largest[k]
                for tau, value in zip(taus.tolist(), found[k].tolist(), strict=True):
                    if not np.isfinite(value):
                        return np.inf, k, tau
                    error = (arb(value) - self._values[tau][k]).abs_lower()
                    ratio = float((error / allowed).lower()) if allowed > 0 else (np.inf if error > 0 else 0.0)
                    worst = max(worst, (ratio, k, tau), key=lambda at: at[0])
        return worst


def _after(number: np.floating, count: int) -> Iterator[np.floating]:
    for _ in range(count):
        number = np.nextafter(number, type(number)(np.inf))
        yield number


def attack(
    scene: Scene, precision: str, evaluators: tuple[str, ...] = EVALUATORS, languages: tuple[str, ...] = ("c", "numpy")
) -> Iterator[Outcome]:
    """What comes of the programs of a scene: of each evaluator, C twice, with fused operations the second time."""
    exam: Exam | None = None
    for evaluator in evaluators:
        began = perf_counter()
        kind = {"evaluator": evaluator, "precision": precision}
        try:
            made = files(lower(scene), "all", evaluator, precision)
        except (ToleranceError, CostError, RangeError) as refusal:
            yield Outcome(**kind, language="all", refusal=_said(refusal), seconds=perf_counter() - began)
            continue
        except Exception as error:  # whatever it is, it belongs into the table
            yield Outcome(**kind, language="all", fault=_said(error), worst=np.inf, seconds=perf_counter() - began)
            continue
        kind["seconds"] = perf_counter() - began
        told = json.loads(made[f"{scene.name}.json"])
        exam = exam or Exam(scene, precision, told["tau_max"])
        bounds = [output["error_bound"] for output in told["outputs"]]
        runs = {}
        if "c" in languages:
            runs |= {"c": _in_c(made, scene, exam, FLAGS), "c, fused": _in_c(made, scene, exam, FUSED)}
        if "numpy" in languages:
            runs["numpy"] = _in_numpy(made, scene, exam)
        for language, run in runs.items():
            values, worst = 0, (0.0, 0, 0.0)
            try:
                for taus, found in run:
                    values += found.size
                    worst = max(worst, exam.judge(taus, found, bounds), key=lambda at: at[0])
            except Exception as error:
                yield Outcome(**kind, language=language, fault=_said(error), worst=np.inf)
                continue
            ratio, k, tau = worst
            output = scene.outputs[k].name
            yield Outcome(**kind, language=language, values=values, worst=ratio, output=output, tau=tau)


def _said(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"


def _in_numpy(made: dict[str, str], scene: Scene, exam: Exam) -> Iterator[tuple[NDArray[np.floating], Array]]:
    yield exam.taus, import_text(made[f"{scene.name}.py"], scene.name).evaluate(exam.taus)


def _in_c(
    made: dict[str, str], scene: Scene, exam: Exam, flags: tuple[str, ...]
) -> Iterator[tuple[NDArray[np.floating], Array]]:
    name, outputs = scene.name, len(scene.outputs)
    real = ctypes.c_double if exam.real is np.float64 else ctypes.c_float
    with TemporaryDirectory() as directory:
        folder = Path(directory)
        for suffix in (".h", ".c"):
            (folder / f"{name}{suffix}").write_text(made[f"{name}{suffix}"], encoding="utf-8")
        compiler().run([*flags, "-fPIC", "-shared", f"{name}.c", "-o", "library.so", "-lm"], folder)
        library = ctypes.CDLL(str(folder / "library.so"))
    evaluate, sample = (getattr(library, f"{name}_{entry}") for entry in ("eval", "sample"))
    evaluate.argtypes = [real, ctypes.c_void_p]
    sample.argtypes = [real, real, ctypes.c_size_t, ctypes.c_void_p]
    rows = np.empty((len(exam.taus), outputs), dtype=exam.real)
    for tau, row in zip(exam.taus.tolist(), rows, strict=True):
        evaluate(tau, row.ctypes.data)
    yield exam.taus, rows.T
    history = np.empty((outputs, GRID), dtype=exam.real)
    sample(0.0, float(exam.grid[1]), GRID, history.ctypes.data)
    inside = exam.grid <= exam.tau_max
    yield exam.grid[inside], history[:, inside]


def drawn(number: int) -> tuple[Scene, str]:
    """A scene and a precision, the same ones for the same number."""
    precision = list(PRECISIONS)[number % 2]
    found: list[Scene] = []

    @seed(number)
    @settings(max_examples=2, database=None, phases=[Phase.generate], suppress_health_check=list(HealthCheck))
    @given(st.integers(), scenes(precision))
    def collect(_: int, scene: Scene) -> None:
        found.append(scene)

    collect()
    # the first is the simplest there is; the second differs from it in what is drawn first, and is else at random
    return found[-1], precision


def main() -> None:
    """Attack drawn scenes; print the table, and what was missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100, help="scenes")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--evaluator", choices=("auto", *EVALUATORS), action="append")
    asked = parser.parse_args()
    outcomes: dict[tuple[str, str, str], list[Outcome]] = defaultdict(list)
    for number in range(asked.count):
        scene, precision = drawn(asked.seed * 10**6 + number)
        came = list(attack(scene, precision, tuple(asked.evaluator or EVALUATORS)))
        for outcome in came:
            outcomes[outcome.evaluator, outcome.language, outcome.precision].append(outcome)
        if missed := [outcome for outcome in came if outcome.worst > 1]:
            print(*(f"# {outcome}" for outcome in missed), as_toml(scene), sep="\n", flush=True)
    row = "{:10}{:10}{:10}{:>9}{:>9}{:>9}{:>8}{:>11}{:>9}"
    print(
        row.format("evaluator", "language", "precision", "programs", "refused", "values", "missed", "worst", "seconds")
    )
    for kind, came in sorted(outcomes.items()):
        refused = sum(bool(outcome.refusal) for outcome in came)
        values = sum(outcome.values for outcome in came)
        missed = sum(outcome.worst > 1 for outcome in came)
        worst, longest = (max(getattr(outcome, of) for outcome in came) for of in ("worst", "seconds"))
        print(row.format(*kind, len(came) - refused, refused, values, missed, f"{worst:.3g}", f"{longest:.1f}"))


if __name__ == "__main__":
    main()

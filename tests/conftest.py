"""What all tests share: `--run-slow`, `--processor`, and how much Hypothesis draws."""

from __future__ import annotations

import gc
import os
from collections import Counter
from collections.abc import Generator, Iterator, Sequence
from functools import cache
from pathlib import Path

import pytest
from hypothesis import Phase, is_hypothesis_test, settings

# each worker has one core: threads of matrix products would wait for each other, which takes twice the processor time
os.environ.setdefault("OMP_NUM_THREADS", "1")

from tests.support.kept_builds import KeptBuilds
from wavesym.running import mode_sets, native, sets
from wavesym.running.toolchain import Compiler, CompilerError, compiler

settings.register_profile("wavesym", deadline=None, derandomize=True)
# where only the first failure is of interest, not the simplest
settings.register_profile("first_failure", settings.get_profile("wavesym"), phases=[Phase.explicit, Phase.generate])
settings.load_profile("wavesym")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--run-slow", action="store_true", help="run the tests marked slow too")
    parser.addoption("--processor", action="store_true", help="list the processor seconds of each file and test")


def pytest_report_header(config: pytest.Config) -> str:
    return "" if config.getoption("--run-slow") else "without what is slow: --run-slow"


def pytest_configure(config: pytest.Config) -> None:
    _without_compiler()
    if config.getoption("--processor"):
        config.pluginmanager.register(ProcessorSeconds())


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--run-slow"):
        return
    cases = Counter[tuple[pytest.Item | pytest.Collector | None, str]]()
    patient = []
    for item in items:
        slow = "slow" in item.keywords
        if not slow and (quick := item.get_closest_marker("quick")):
            key = item.parent, item.name.partition("[")[0]
            cases[key] += 1
            slow = cases[key] > quick.args[0]
        if slow:
            patient.append(item)
    # left out here, none costs the time of a test that is skipped: what is slow is a third of all
    config.hook.pytest_deselected(items=patient)
    left_out = {*patient}
    items[:] = [item for item in items if item not in left_out]
    for test in {item.obj for item in items if isinstance(item, pytest.Function) and is_hypothesis_test(item.obj)}:
        # Hypothesis has no other way to change the settings of a test that has its own
        every = test._hypothesis_internal_use_settings
        test._hypothesis_internal_use_settings = settings(every, max_examples=quick_examples(every.max_examples))


def pytest_collection_finish() -> None:
    """What was imported and collected stays, so that Python need not look through it again and again for garbage."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)


@pytest.fixture(autouse=True, scope="session")
def quick_builds(pytestconfig: pytest.Config) -> Iterator[None]:
    """Without --run-slow, C is compiled without optimisation, in a third of the time, and kept for the next run.

    It is compared with exact values and bounds, which hold however it is compiled. Where a test says how products are
    contracted, or that code is small, it is compiled as the test says. `--cache-clear` drops what is kept.
    """
    run = Compiler.run
    cache: pytest.Cache | None = getattr(pytestconfig, "cache", None)  # none with -p no:cacheprovider
    kept = KeptBuilds(cache.mkdir("compiled"), compiler()) if cache and not _without_compiler() else None

    def quick(self: Compiler, arguments: Sequence[str], folder: Path) -> None:
        if not any(argument.startswith("-ffp-contract") for argument in arguments):
            arguments = ["-O0" if argument in ("-O1", "-O2", "-O3") else argument for argument in arguments]
        if kept:
            kept.run(run, self, arguments, folder)
        else:
            run(self, arguments, folder)

    with pytest.MonkeyPatch.context() as patch:
        if not pytestconfig.getoption("--run-slow"):
            patch.setattr(Compiler, "run", quick)
            for module in (mode_sets, sets):
                patch.setattr(module, "FAST", ("-O0", *native.FAST[1:]))
        yield


@pytest.fixture(scope="session")
def thorough(pytestconfig: pytest.Config) -> bool:
    """Whether a test may take its time: with --run-slow it compares more, longer, or larger."""
    return bool(pytestconfig.getoption("--run-slow"))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup() -> Generator[None, None, None]:
    yield from _skip_without_compiler()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call() -> Generator[None, None, None]:
    yield from _skip_without_compiler()


def _skip_without_compiler() -> Generator[None, None, None]:
    """What a machine cannot compile is skipped, where it has no compiler: `make test` installs one there."""
    try:
        yield
    except CompilerError as error:
        if str(error) == _without_compiler():
            pytest.skip(str(error))
        raise


@cache
def _without_compiler() -> str:
    """Why this machine cannot compile; empty where it can. First asked before a test makes it another machine."""
    try:
        compiler()
    except CompilerError as error:
        return str(error)
    return ""


def quick_examples(every: int) -> int:
    """How many examples are drawn without --run-slow: a tenth, but as many as 2 where there are so many."""
    return max(min(every, 2), every // 10)


class ProcessorSeconds:
    """The processor time of each file and test, with that of the processes they start: the clock depends on the load.

    A fixture or cache counts for the test that asks for it first. With xdist each worker measures, the controller adds.
    """

    def __init__(self) -> None:
        self.before = 0.0
        self.files: Counter[str] = Counter()
        self.tests: Counter[str] = Counter()

    def pytest_runtest_logstart(self) -> None:
        self.before = _processor_seconds()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        report = yield
        before, self.before = self.before, _processor_seconds()
        report.user_properties.append(("processor seconds", self.before - before))
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        seconds = sum(value for name, value in report.user_properties if name == "processor seconds")
        self.files[report.nodeid.split("::")[0]] += seconds
        self.tests[report.nodeid] += seconds

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        terminalreporter.section(f"processor seconds: {self.files.total():.1f}, collecting left out")
        for counted in (self.files, self.tests):
            for name, seconds in counted.most_common():
                if seconds >= 0.1:
                    terminalreporter.write_line(f"{seconds:8.2f}  {name}")


def _processor_seconds() -> float:
    return sum(os.times()[:4])

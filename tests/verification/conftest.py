"""What tests of `verify` share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from wavesym.running import co_simulation
from wavesym.verification import programs


@pytest.fixture(autouse=True, scope="session")
def quickest_builds(pytestconfig: pytest.Config) -> Iterator[None]:
    """Without --run-slow, what is compiled for being compared takes a third of the time: bounds hold however it is."""
    with pytest.MonkeyPatch.context() as patch:
        if not pytestconfig.getoption("--run-slow"):
            patch.setattr(programs, "FLAGS", ("-std=c99", "-O0"))
            patch.setattr(co_simulation, "_FLAGS", ("-std=c99", "-O0"))
        yield

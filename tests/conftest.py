"""What all tests share: `--run-slow`, and where Hypothesis keeps quiet about slow machines."""

from __future__ import annotations

import pytest
from hypothesis import Phase, settings

settings.register_profile("wavesym", deadline=None, derandomize=True)
# where only the first failure is of interest, not the simplest
settings.register_profile("first_failure", settings.get_profile("wavesym"), phases=[Phase.explicit, Phase.generate])
settings.load_profile("wavesym")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--run-slow", action="store_true", help="run the tests marked slow too")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--run-slow"):
        return
    for item in items:
        if "slow" in item.keywords:
            item.add_marker(pytest.mark.skip(reason="slow: run with --run-slow"))

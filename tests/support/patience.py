"""Which cases are always run, and which when there is time."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def first_always(cases: Iterable[Any]) -> list[Any]:
    """The first case as it is, the others marked as slow."""
    return [pytest.param(case, marks=pytest.mark.slow) if k else case for k, case in enumerate(cases)]

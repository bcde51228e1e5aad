"""`python -m tests.support.eager_sweep SWEEP -o DIR --workers N`: `wavesym sweep` by workers alone, however short."""

from __future__ import annotations

import sys
from collections.abc import Generator
from typing import Any

from wavesym.cli import main
from wavesym.sweeps import running


def leave_to_workers() -> None:
    """From now on sweeps of this process compute nothing here."""

    def nothing(*given: Any) -> Generator[Any, None, int]:
        yield from ()
        return int(given[-1])

    running._compute_here = nothing


if __name__ == "__main__":
    leave_to_workers()
    sys.exit(main(["sweep", *sys.argv[1:]]))

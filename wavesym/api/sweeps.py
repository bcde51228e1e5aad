"""Many scenes that differ in a few fields or records: computed into a folder, counted, tabulated, shown."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wavesym.progress import progress

if TYPE_CHECKING:
    from wavesym.sweeps.status import SweepStatus


def sweep(
    source: str | PathLike[str] | Mapping[str, Any],
    folder: str | PathLike[str],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    retry_failed: bool = False,
) -> Any:
    """Compute many scenes into a folder, as `wavesym sweep` does; what is there goes on where it was.

    On a terminal a line says how far it is.

    Args:
        source: a file of TOML, or the same fields: `scene` (a Scene, or a path), `vary`, `records`, `keep`.
        folder: where the results go.
        workers: so many processes of this machine compute at most; None for as many as it has processors. They are
            started where that is done sooner than by this process alone; a warning says where it is not.
        scheduler: the address of a Dask scheduler whose workers compute.
        retry_failed: whether cases that failed are tried again.

    Returns:
        An xarray.Dataset: extremes over the varied paths, `record` and `output`, NaN for a case that failed.

    Raises:
        SceneError: for a request that is wrong.
        WavesymError: for the folder of another sweep.

    >>> import wavesym
    >>> request = {"scene": "drive_m1", "vary": {"output.until": [4, 5], "system.kappa[0]": ["1/2", 1, 2]}}
    >>> wavesym.sweep(request, "stiffnesses")["max"].dims
    ('output.until', 'system.kappa[0]', 'output')
    """
    from wavesym.sweeps.store import open_dataset, require_packages

    require_packages("xarray", "zarr")
    told: list[str] = []
    with progress(f"sweep {folder}") as line:
        run_sweep(source, folder, workers, scheduler, retry_failed, line.count, told.append)
    for note in told:
        warnings.warn(note, UserWarning, stacklevel=2)
    return open_dataset(folder)


def run_sweep(
    source: str | PathLike[str] | Mapping[str, Any],
    folder: str | PathLike[str],
    workers: int | None,
    scheduler: str | None,
    retry_failed: bool,
    watch: Callable[[int, int, int], object] = lambda *_: None,
    tell: Callable[[str], object] = lambda _: None,
) -> int:
    """Compute what is left of a sweep; how many of its cases have failed.

    `watch` is called with the number of all cases, of those done, and of those done before; `tell` with why
    fewer workers were started than asked for. The rest as of `sweep`.
    """
    from wavesym.sweeps.running import Computing, run

    return run(source, folder, Computing(workers, scheduler), retry_failed, watch, tell)


def sweep_status(folder: Path) -> SweepStatus:
    """How many cases of the sweep in a folder are done, have failed and are left. WavesymError where there is none."""
    from wavesym.sweeps.status import status

    return status(folder)


def sweep_table(folder: Path, path: Path) -> None:
    """Write the results of a sweep as .csv or .parquet, a row for each case."""
    from wavesym.sweeps.table import write_table

    write_table(folder, path)


def sweep_report(folder: Path, path: Path) -> None:
    """Write what the sweep in a folder came to as one page of HTML. WavesymError where there is no sweep."""
    from wavesym.pictures.page.sweep import sweep_page
    from wavesym.writing import write_whole

    write_whole({path: sweep_page(folder)})

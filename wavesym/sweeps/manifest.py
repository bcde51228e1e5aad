"""The folder of a sweep: which sweep it is of, said once, before anything is computed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from wavesym.errors import WavesymError
from wavesym.sweeps.batches import Batches
from wavesym.sweeps.marks import FOLDER
from wavesym.sweeps.plan import SCHEMA, SweepPlan
from wavesym.sweeps.store import NAME, Store
from wavesym.writing import write_whole

FILE = "manifest.json"
_KEYS = {"sha256", "name", "cases", "wavesym", "dimensions", "outputs", "keep", "scene"}


def settle(folder: Path, plan: SweepPlan, batches: Batches) -> Store:
    """The store of a sweep in its folder; what is not there is made. WavesymError for a folder of another sweep."""
    store = Store(folder, plan, batches)
    there = read(folder)
    if there and there["sha256"] != plan.sha256:
        was = f'"{there["name"]}", {there["cases"]} cases, wavesym {there["wavesym"]}'
        raise WavesymError(f"{folder}: the folder of another sweep given ({was}), its own or a new one expected")
    if not (folder / NAME).exists():
        store.make()
    elif store.sha256 != plan.sha256:
        raise WavesymError(f"{folder}: a {NAME} that is not of this sweep given, a new folder expected")
    (folder / FOLDER).mkdir(exist_ok=True)
    if not there:
        write_whole({folder / FILE: json.dumps(_said(plan, batches), indent=1) + "\n"})
    return store


def read(folder: Path) -> dict[str, Any] | None:
    """The manifest of a folder, None where it has none. WavesymError for one that is damaged."""
    path = folder / FILE
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except (ValueError, RecursionError, NotADirectoryError):
        manifest = None
    if not isinstance(manifest, dict) or manifest.get("schema_version") != SCHEMA or not manifest.keys() >= _KEYS:
        raise WavesymError(f"{path}: no manifest of a sweep, one of schema_version {SCHEMA} expected")
    return manifest


def _said(plan: SweepPlan, batches: Batches) -> dict[str, Any]:
    from wavesym import __version__

    return {
        "schema_version": SCHEMA,
        "wavesym": __version__,
        "sha256": plan.sha256,
        "name": plan.name,
        "cases": plan.cases,
        "dimensions": {dimension.name: len(dimension) for dimension in plan.dimensions},
        "computed": {"as": batches.kind, "together": list(batches.chunk), "batches": len(batches)},
        "outputs": dict(zip(plan.outputs, plan.units, strict=True)),
        "keep": {"summary": list(plan.summary), "histories": plan.histories},
        "scene": plan.said_scene,
    }

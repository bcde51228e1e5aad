"""The folder of a sweep: which sweep it is of, said once, before anything is computed."""

from __future__ import annotations

import json
from math import prod
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from wavesym.errors import WavesymError
from wavesym.results.statistics import LINK_ARRAYS
from wavesym.sweeps.batches import Batches
from wavesym.sweeps.marks import FOLDER
from wavesym.sweeps.plan import LINK, MOST, OUTPUT, SAMPLE, SCHEMA, SweepPlan
from wavesym.sweeps.request import MOST_SAMPLES
from wavesym.sweeps.sealed_files import DamagedError, NoFileError, SealedFile, Sha256, StrictTable, file_bytes
from wavesym.sweeps.store import ATTRIBUTES, NAME, Store, folder_content, lay_out
from wavesym.sweeps.values import kept_arrays

FILE = "manifest.json"
Count = Annotated[int, Field(ge=1, le=MOST)]


class ComputedTable(StrictTable):
    """How cases are computed: as what `kind`, how many `together` in each dimension, in so many `batches`."""

    kind: str
    together: list[Count]
    batches: Count


class KeptTable(StrictTable):
    """What is kept of each case."""

    summary: list[str]
    histories: Annotated[int, Field(ge=2, le=MOST_SAMPLES)] | None


class Manifest(SealedFile):
    """What the folder of a sweep holds.

    `dimensions` have their lengths, `outputs` and `links` whose sets are kept their units, `arrays` the dimensions that
    they have beside those of the sweep; `files` are hashes of what else there is in the store: coordinates, and what is
    said of arrays.
    """

    schema_version: int = Field(ge=SCHEMA, le=SCHEMA)
    wavesym: str
    sha256: Sha256
    name: str
    cases: Count
    dimensions: dict[str, Count]
    computed: ComputedTable
    outputs: dict[str, str]
    links: dict[str, str] = Field(default_factory=dict)
    keep: KeptTable
    arrays: dict[Annotated[str, Field(pattern="^[a-z_]+$")], list[str]]
    files: dict[str, Sha256]
    scene: dict[str, Any]

    @model_validator(mode="after")
    def _check_consistency(self) -> Self:
        """What else is wrong with one that somebody else has made."""
        shape, chunk = list(self.dimensions.values()), self.computed.together
        fits = len(chunk) == len(shape) and all(part <= n for part, n in zip(chunk, shape, strict=True))
        known = {name: [LINK if name in LINK_ARRAYS else OUTPUT] for name in self.keep.summary} | {"bound": []}
        others = {OUTPUT, *([LINK] if self.links else []), *([SAMPLE] if self.keep.histories else [])}
        if not fits or prod(shape) != self.cases or len(self.batches) != self.computed.batches:
            raise ValueError("batches that are not those of the cases")
        if any(self.arrays.get(name) != each for name, each in known.items()):
            raise ValueError("arrays that are not what is kept")
        if not all(others.issuperset(each) for each in self.arrays.values()):
            raise ValueError("arrays that are not what is kept")
        return self

    @property
    def batches(self) -> Batches:
        """The batches of its cases."""
        return Batches(self.computed.kind, tuple(self.dimensions.values()), tuple(self.computed.together))

    def store(self, folder: Path) -> Store:
        """The arrays in its folder."""
        lengths = {OUTPUT: len(self.outputs), SAMPLE: self.keep.histories or 0, LINK: len(self.links)}
        return Store(
            folder, self.batches, {name: tuple(map(lengths.__getitem__, each)) for name, each in self.arrays.items()}
        )

    @classmethod
    def read_folder(cls, folder: Path) -> Self:
        """That of a folder. WavesymError where it has none; DamagedError for one that is not as it was written."""
        try:
            found = cls.read(folder / FILE)
        except NoFileError:
            raise
        except DamagedError:
            what = f"damaged, or not of schema_version {SCHEMA} (wavesym sweep SWEEP -o {folder} mends what is damaged)"
            raise DamagedError(f"{folder / FILE}: {what}") from None
        if found is None:
            raise WavesymError(f"{folder}: no {FILE} in it; write the folder of a sweep")
        return found


def settle(folder: Path, plan: SweepPlan, batches: Batches) -> Store:
    """The store of a sweep in its folder; what is not there or damaged, but for chunks and marks, is made.

    WavesymError for a folder of another sweep; NoFileError where something else is in the place of a file.
    """
    try:
        there = Manifest.read(folder / FILE)
    except DamagedError:
        there = None
    if there and there.sha256 != plan.sha256:
        was = f'"{there.name}", {there.cases} cases, wavesym {there.wavesym}'
        raise WavesymError(f"{folder}: the folder of another sweep ({was}); write its own or a new one")
    if not there and (folder / NAME).exists() and _sweep(folder / NAME) != plan.sha256:
        raise WavesymError(f"{folder}: has a {NAME} that is not of this sweep; write a new folder")
    manifest = _manifest(plan, batches, lay_out(folder, plan, batches))
    if (folder / FOLDER).is_symlink() or ((folder / FOLDER).exists() and not (folder / FOLDER).is_dir()):
        raise WavesymError(f"{folder / FOLDER}: no folder, and a sweep has one there; delete it")
    (folder / FOLDER).mkdir(exist_ok=True)
    folder_content(folder / FOLDER)
    if there != manifest:
        manifest.put(folder / FILE)
    return manifest.store(folder)


def _sweep(store: Path) -> object:
    """The hash of the sweep that a store says it is of; None where it cannot be read."""
    try:
        return json.loads(file_bytes(store / ATTRIBUTES, 1 << 28)).get("sweep_sha256")
    except (OSError, ValueError, RecursionError, AttributeError):
        return None


def _manifest(plan: SweepPlan, batches: Batches, files: dict[str, str]) -> Manifest:
    from wavesym import __version__

    return Manifest(
        schema_version=SCHEMA,
        wavesym=__version__,
        sha256=plan.sha256,
        name=plan.name,
        cases=plan.cases,
        dimensions={dimension.name: len(dimension) for dimension in plan.dimensions},
        computed=ComputedTable(kind=batches.kind, together=list(batches.chunk), batches=len(batches)),
        outputs=dict(zip(plan.outputs, plan.units, strict=True)),
        links=dict.fromkeys(plan.links, plan.link_unit),
        keep=KeptTable(summary=list(plan.summary), histories=plan.histories),
        arrays={each.name: list(each.dimensions) for each in kept_arrays(plan)},
        files=files,
        scene=plan.first_scene,
    )

"""Folders of sweeps that disks, people or other tools have changed: the numbers are as they were, or one line says why
there are none; and nothing in such a folder is ever run."""

from __future__ import annotations

import csv
import hashlib
import json
import os
import pickle
import re
import shutil
from collections.abc import Iterator
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("zarr", reason="the extra `sweep` is not installed")

from tests.sweeps.test_cluster import files
from wavesym import __version__, api
from wavesym.cli import main
from wavesym.errors import WavesymError
from wavesym.pictures.page.sweep import sweep_page
from wavesym.sweeps import pace, running, work
from wavesym.sweeps.running import run
from wavesym.sweeps.sealed_files import DamagedError, _seal
from wavesym.sweeps.status import status
from wavesym.sweeps.store import NAME
from wavesym.sweeps.values import CaseValues

SWEEP: dict[str, Any] = {
    "scene": "drive_m1",
    "zip": True,
    "vary": {"output.until": [4, 5, 6, 7, 8], "system.kappa[0]": ["1/2", "x", 1, 2, 3]},
    "keep": {"histories": 3},
}
CASES = 5


def fake(plan: Any, scene: Any) -> CaseValues:
    """Any numbers, at once: a disk does not know what they mean."""
    draw = np.random.default_rng(int(scene.output.until))
    shape = (len(plan.outputs),)
    made = {name: draw.standard_normal(shape) for name in plan.summary}
    return CaseValues({**made, "history": draw.standard_normal((*shape, 3)), "until": 1.0, "bound": 1e-16}, "drawn")


@pytest.fixture
def computed(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The batches that are computed here, in order; cases cost nothing."""
    done: list[int] = []
    compute = running.compute

    def counted(plan: Any, batches: Any, batch: int, places: Any = None) -> Any:
        done.append(batch)
        return compute(plan, batches, batch, places)

    monkeypatch.setattr(running, "compute", counted)
    monkeypatch.setattr(pace, "processors", lambda: 1)
    monkeypatch.setattr(work, "single", fake)
    return done


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep of five cases, one of which fails, each a batch."""
    folder = tmp_path_factory.mktemp("made") / "out"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pace, "processors", lambda: 1)
        patch.setattr(work, "single", fake)
        assert run(SWEEP, folder) == 1
    return folder


@pytest.fixture
def folder(tmp_path: Path, made: Path, computed: list[int]) -> Path:
    """A copy of it."""
    return Path(shutil.copytree(made, tmp_path / "out"))


def numbers(folder: Path) -> tuple[str, ...]:
    """All that people read of a folder."""
    table = folder.parent / "table.csv"
    api.sweep_table(folder, table)
    return status(folder).json(), table.read_text(), sweep_page(folder)


def flips(path: Path, offsets: int) -> Iterator[bytes]:
    """A file with one bit flipped, the k-th of several."""
    content = path.read_bytes()
    for k in range(offsets):
        place = (2 * k + 1) * len(content) // (2 * offsets)
        yield content[:place] + bytes([content[place] ^ 1 << (3 * k + len(path.name)) % 8]) + content[place + 1 :]


@pytest.mark.parametrize("offsets", [1, pytest.param(5, marks=pytest.mark.slow)])
def test_one_flipped_bit_never_gives_wrong_numbers(folder: Path, offsets: int) -> None:
    before, every = numbers(folder), files(folder)
    assert len(every) > 40
    for name, content in every.items():
        for flipped in flips(folder / name, offsets):
            (folder / name).write_bytes(flipped)
            with pytest.raises(DamagedError, match=re.escape(name)) as refused:
                numbers(folder)
            assert refused.value.status == 1
            assert str(refused.value).isprintable()
            (folder / name).write_bytes(content)
    assert numbers(folder) == before


def test_damage_is_one_line_that_says_what_to_do(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / NAME / "max" / "2.0").write_bytes(b"")
    (folder / NAME / "min" / "3.0").unlink()
    (folder / NAME / "output" / "0").unlink()
    table, page = folder.parent / "t.csv", folder.parent / "p.html"
    for command in (["sweep", str(folder), "--table", str(table)], ["report", str(folder), "-o", str(page)]):
        assert main(command) == 1
        assert capsys.readouterr().err == (
            f"{folder}: {NAME}/output/0 and 2 files more damaged; 2 of 5 cases have to be computed again "
            f"(wavesym sweep SWEEP -o {folder} mends it)\n"
        )
    assert not table.exists()
    assert not page.exists()


def test_a_table_says_how_many_rows_have_no_results(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = folder.parent / "t.csv"
    assert main(["sweep", str(folder), "--table", str(table)]) == 0
    assert capsys.readouterr().err == f"{table}: rows without results: 1 (5 cases: 4 done, 1 failed, 0 left)\n"
    for mark in (folder / "done").iterdir():
        mark.unlink()
    assert main(["sweep", str(folder), "--table", str(table)]) == 0
    assert capsys.readouterr().err == f"{table}: rows without results: 5 (5 cases: 0 done, 0 failed, 5 left)\n"


def test_the_next_start_mends_all_that_is_damaged(folder: Path, computed: list[int]) -> None:
    every = files(folder)
    marks = {json.loads(content)["batch"]: name for name, content in every.items() if name.startswith("done/")}
    damaged = ["manifest.json", f"{NAME}/.zgroup", f"{NAME}/max/.zarray", f"{NAME}/output/0", f"{NAME}/max/2.0"]
    for name in [*damaged, f"{NAME}/output.until/.zattrs", marks[4]]:
        (folder / name).write_bytes(next(flips(folder / name, 1)))
    assert run(SWEEP, folder) == 1
    assert computed == [2, 4]
    assert files(folder) == every
    shutil.rmtree(folder / NAME / "unit")
    (folder / NAME / ".zattrs").write_text("x")
    assert run(SWEEP, folder) == 1
    assert computed == [2, 4]
    assert files(folder) == every


@pytest.mark.slow
def test_after_any_flipped_bit_a_start_makes_the_same_files(folder: Path) -> None:
    every = files(folder)
    for name in every:
        for flipped in flips(folder / name, 3):
            (folder / name).write_bytes(flipped)
            assert run(SWEEP, folder) == 1
            assert files(folder) == every


def test_a_chunk_without_a_mark_is_no_number(folder: Path) -> None:
    """As one that a machine has not finished: what the status calls left the table has not."""
    before = (numbers(folder)[1]).splitlines()
    for path in (folder / "done").iterdir():
        if json.loads(path.read_text())["batch"] == 3:
            path.unlink()
    assert status(folder).left == 1
    after = numbers(folder)[1].splitlines()
    assert [a == b for a, b in zip(before, after, strict=True)] == [True, True, True, True, False, True]
    assert set(after[4].split(",")[2:]) == {""}


def test_a_manifest_of_another_sweep_is_not_mended(folder: Path, computed: list[int]) -> None:
    other = {**SWEEP, "keep": {}}
    every = files(folder)
    with pytest.raises(
        WavesymError, match=rf'of another sweep \("drive_m1", 5 cases, wavesym {re.escape(__version__)}\)'
    ):
        run(other, folder)
    (folder / "manifest.json").write_text("{")
    with pytest.raises(WavesymError, match=r"a results.zarr that is not of this sweep; write a new folder"):
        run(other, folder)
    assert computed == []
    assert files(folder) == {**every, "manifest.json": b"{"}


class Touching:
    """Makes a file where it is unpickled."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> Any:
        return os.mkdir, (str(self.path),)


def sealed(folder: Path, change: Any) -> None:
    """Change a manifest, as one who knows how they are made: its hashes are right."""
    fields = json.loads((folder / "manifest.json").read_text())
    fields.pop("seal")
    change(fields)
    (folder / "manifest.json").write_text(json.dumps({**fields, "seal": _seal(fields)}, indent=1) + "\n")


def hashed(folder: Path) -> None:
    """Put the hashes of files as they are into the manifest."""

    def change(fields: dict[str, Any]) -> None:
        fields["files"] = {
            name: sha256((folder / NAME / name).read_bytes()).hexdigest()
            for name in fields["files"]
            if (folder / NAME / name).is_file()
        }

    sealed(folder, change)


TEXTS, PICKLE = {"id": "vlen-utf8"}, {"id": "pickle", "protocol": 5}
POISON: list[dict[str, Any]] = [
    {"dtype": "|O", "fill_value": "", "filters": [TEXTS], "compressor": PICKLE},
    {"dtype": "|O", "fill_value": "", "filters": [TEXTS, PICKLE]},
]


@pytest.mark.parametrize(("name", "said"), list(zip(["output", "max"], POISON, strict=True)))
def test_no_codec_that_a_store_names_is_run(
    folder: Path, monkeypatch: pytest.MonkeyPatch, name: str, said: dict[str, Any]
) -> None:
    """With the codec `pickle` allowed, as it is in other versions of numcodecs; opened by zarr itself it would run."""
    import zarr

    pickles = pytest.importorskip("numcodecs.pickles")
    monkeypatch.setattr(pickles, "ALLOW_UNSAFE_PICKLE_DECODE", True, raising=False)
    before, every, witness = numbers(folder), files(folder), folder.parent / "witness"
    at = folder / NAME / name
    zarray = json.loads((at / ".zarray").read_text())
    (at / ".zarray").write_text(json.dumps(zarray | said))
    chunk = at / ("0" if name == "output" else "0.0")
    chunk.write_bytes(pickle.dumps(Touching(witness)))
    with pytest.raises(DamagedError):
        numbers(folder)
    hashed(folder)
    for path in (folder / "done").iterdir():
        mark = json.loads(path.read_text())
        if mark.pop("seal") and name == "max" and mark["batch"] == 0:
            mark["chunks"]["max"] = sha256(chunk.read_bytes()).hexdigest()
        path.write_text(json.dumps({**mark, "seal": _seal(mark)}, indent=1) + "\n")
    with suppress(DamagedError):
        assert numbers(folder) == before
    assert not witness.exists()
    assert run(SWEEP, folder) == 1
    assert files(folder) == every
    assert np.isfinite(zarr.open_array(folder / NAME / "max", mode="r")[0]).all()
    assert not witness.exists()
    # what zarr would have done; of the one chunk, since it reads several at once and stops at the first that is damaged
    chunk.write_bytes(pickle.dumps(Touching(witness)))
    (at / ".zarray").write_text(json.dumps(zarray | said))
    with pytest.raises(Exception):  # noqa: B017, PT011 whatever comes of it
        np.asarray(zarr.open_array(at, mode="r")[:1])
    assert witness.exists()


NOT_OF_IT: list[dict[str, Any]] = [
    {"left": list(range(1000))},
    {"left": [-1]},
    {"left": [4]},
    {"left": [2, 2]},
    {"failed": [{"case": 10**30, "values": {}, "reason": "none"}]},
    {"left": [2], "failed": [{"case": 2, "values": {}, "reason": "none"}]},
]


@pytest.mark.parametrize("change", NOT_OF_IT)
def test_a_mark_that_speaks_of_other_cases_is_made_again(
    folder: Path, computed: list[int], change: dict[str, Any]
) -> None:
    """Its hash is right: the status said that -995 cases were done."""
    every = files(folder)
    (path,) = (path for path in (folder / "done").iterdir() if json.loads(path.read_text())["batch"] == 2)
    mark = json.loads(path.read_text()) | change
    mark.pop("seal")
    path.write_text(json.dumps({**mark, "seal": _seal(mark)}, indent=1) + "\n")
    with pytest.raises(DamagedError, match=rf"{path.name} damaged; 1 of 5 cases have to be computed again"):
        status(folder)
    assert run(SWEEP, folder) == 1
    assert computed == [2]
    assert files(folder) == every


@pytest.mark.parametrize("name", [f"{NAME}/max/2.0", f"{NAME}/.zattrs"])
def test_what_is_too_large_is_not_read(folder: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """A chunk of 64 GB was hashed whole, which took minutes, before its size was looked at."""
    every, whole, read = files(folder), hashlib.file_digest, []

    def noted(file: Any, algorithm: str) -> Any:
        read.append(Path(file.name).relative_to(folder).as_posix())
        return whole(file, algorithm)

    (folder / name).write_bytes((folder / name).read_bytes() + b" ")
    monkeypatch.setattr(hashlib, "file_digest", noted)
    assert run(SWEEP, folder) == 1
    assert name not in read
    assert files(folder) == every


ABSURD: list[dict[str, Any]] = [
    {"cases": 10**18, "dimensions": {"case": 10**18}},
    {"cases": 10**7, "dimensions": {"case": 10**7}},
    {"computed": {"kind": "single", "together": [0], "batches": 5}},
    {"computed": {"kind": "single", "together": [10**7], "batches": 5}},
    {"computed": {"kind": "single", "together": [], "batches": 5}},
    {"keep": {"summary": ["min", "max"], "histories": 10**15}},
    {"keep": {"summary": ["../max"], "histories": 3}},
    {"arrays": {}},
    {"arrays": {"../../max": ["output"], "bound": []}},
    {"arrays": {"max": ["output", "output"], "bound": ["sample"]}},
    {"files": {"../../../etc/passwd": "0" * 64}},
    {"files": {}},
    {"outputs": {}},
    {"outputs": [1]},
    {"schema_version": 1},
    {"schema_version": True},
    {"cases": "5"},
    {"scene": None},
    {"more": 1},
]


@pytest.mark.parametrize("change", ABSURD)
def test_a_manifest_that_is_none_is_refused_before_it_costs_anything(folder: Path, change: dict[str, Any]) -> None:
    sealed(folder, lambda fields: fields.update(change))
    with pytest.raises(WavesymError) as refused:
        numbers(folder)
    assert str(refused.value).isprintable()
    assert refused.value.status == 1


SAID: list[tuple[str, dict[str, Any]]] = [
    (".zarray", {"dtype": "|O"}),
    (".zarray", {"dtype": "<U99999"}),
    (".zarray", {"dtype": "<f4"}),
    (".zarray", {"dtype": None}),
    (".zattrs", {"written": []}),
    (".zattrs", {"written": [1, 2, 3, 4, 5]}),
    (".zattrs", {"_ARRAY_DIMENSIONS": ["nowhere"]}),
    (".zattrs", {"_ARRAY_DIMENSIONS": []}),
    (".zattrs", {"path": 5}),
]


@pytest.mark.parametrize(("file", "change"), SAID)
def test_coordinates_that_are_none_are_refused(folder: Path, file: str, change: dict[str, Any]) -> None:
    path = folder / NAME / "output.until" / file
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    hashed(folder)
    with pytest.raises(DamagedError, match="coordinates that are none"):
        api.sweep_table(folder, folder.parent / "t.csv")


@pytest.mark.parametrize("name", ["manifest.json", f"{NAME}/max", f"{NAME}/output/0", f"{NAME}/max/2.0", NAME])
@pytest.mark.parametrize("pipe", [False, True])
def test_links_and_pipes_are_not_followed(folder: Path, name: str, pipe: bool) -> None:
    """Though what is behind a link is what should be there."""
    (folder / name).rename(folder.parent / "elsewhere")
    if pipe:
        os.mkfifo(folder / name)
    else:
        (folder / name).symlink_to(folder.parent / "elsewhere")
    with pytest.raises(DamagedError):
        numbers(folder)
    if name != "manifest.json":
        with pytest.raises(DamagedError, match="neither a file nor a folder"):
            run(SWEEP, folder)


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    "place", ["mark", f"{NAME}/max/2.0", f"{NAME}/output/0", f"{NAME}/max/.zarray", "manifest.json"]
)
@pytest.mark.parametrize("other", ["pipe", "folder", "link"])
def test_who_deletes_what_is_no_file_gets_the_sweep_back(
    folder: Path, computed: list[int], place: str, other: str
) -> None:
    """Nobody is promised that the next start mends what it then refuses; only files are replaced unasked."""
    known = numbers(folder)
    path = folder / (place if place != "mark" else sorted((folder / "done").iterdir())[1].relative_to(folder))
    path.unlink()
    if other == "pipe":
        os.mkfifo(path)
    elif other == "folder":
        path.mkdir()
    else:
        path.symlink_to(folder.parent / "nowhere")
    with pytest.raises(DamagedError, match="delete it") as error:
        numbers(folder)
    assert str(path) in str(error.value)
    assert "mends" not in str(error.value)
    if place != "manifest.json" or other == "folder":
        with pytest.raises(DamagedError, match="delete it"):
            run(SWEEP, folder)
    if other == "folder":
        path.rmdir()
    else:
        path.unlink(missing_ok=True)
    run(SWEEP, folder)
    assert numbers(folder) == known


@pytest.mark.parametrize("name", ["zarr.json", ".zmetadata", "sample/zarr.json", "more/.zarray"])
def test_what_zarr_might_open_beside_the_arrays_is_refused(folder: Path, name: str) -> None:
    (folder / NAME / name).parent.mkdir(exist_ok=True)
    (folder / NAME / name).write_text("{}")
    with pytest.raises(WavesymError, match="not of this sweep; move it elsewhere"):
        run(SWEEP, folder)


def test_texts_of_others_are_shown_as_they_are(tmp_path: Path, computed: list[int], monkeypatch: Any) -> None:
    """No formula for a spreadsheet, no command for a terminal, one line for each case."""
    names = ["=1+1", "+x", "-2+3", "@f", "\t=1", "-5", "-1/2", "a\rb", "\uff1d1", "a\x1b[2Jb"]
    sweep = {"scene": "drive_m1", "vary": {"system.kappa[0]": names}}
    assert run(sweep, tmp_path / "out") == len(names)
    api.sweep_table(tmp_path / "out", tmp_path / "t.csv")
    with (tmp_path / "t.csv").open(newline="") as file:
        _, *rows = csv.reader(file)
    shown = ["'=1+1", "'+x", "'-2+3", "'@f", "'\\t=1", "-5", "'-1/2", "a\\rb", "'\uff1d1", "a\\x1b[2Jb"]
    assert [row[0] for row in rows] == shown
    text = status(tmp_path / "out").text()
    assert text.count("\n") == 1 + len(names)
    assert all(line.isprintable() for line in text.splitlines())
    assert "= a\\x1b[2Jb)" in text

"""A sweep in this process: labelled arrays that are what each scene's summary is, and nothing lost or done twice."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("zarr", reason="the extra `sweep` is not installed")

from tests.sweeps.test_cluster import files
from wavesym import Scene, api
from wavesym.cli import main
from wavesym.errors import SceneError, WavesymError
from wavesym.sweeps import running
from wavesym.sweeps.marks import BatchMark
from wavesym.sweeps.running import run
from wavesym.sweeps.sealed_files import DamagedError
from wavesym.sweeps.status import status
from wavesym.sweeps.store import Store

SWEEP: dict[str, Any] = {
    "scene": "drive_m1",
    "vary": {"output.until": [4, 5], "system.kappa[0]": {"from": "1/4", "to": 1, "count": 3}},
}
BATCHES = 6


@pytest.fixture
def computed(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[int]]:
    """The batches that are computed here, in order."""
    done: list[int] = []
    compute = running.compute

    def counted(plan: Any, batches: Any, batch: int, places: Any = None) -> Any:
        done.append(batch)
        return compute(plan, batches, batch, places)

    monkeypatch.setattr(running, "compute", counted)
    return done


@pytest.mark.slow
def test_a_sweep_that_is_done_is_not_done_again(tmp_path: Path, computed: list[int]) -> None:
    assert run(SWEEP, tmp_path / "a") == 0
    assert computed == list(range(BATCHES))
    before = files(tmp_path / "a")
    assert run(SWEEP, tmp_path / "a") == 0
    assert len(computed) == BATCHES
    assert files(tmp_path / "a") == before
    chunk = tmp_path / "a" / "results.zarr" / "max" / "0.1.0"
    *kept, last = chunk.read_bytes()
    chunk.write_bytes(bytes([*kept, last ^ 1]))  # a bit of a disk that rots
    (tmp_path / "a" / "results.zarr" / "min" / "1.0.0").unlink()
    mark = next((tmp_path / "a" / "done").iterdir())
    mark.write_text(mark.read_text()[:40])  # of a disk that lost its power
    torn = int(json.loads(before[f"done/{mark.name}"])["batch"])
    assert run(SWEEP, tmp_path / "a") == 0
    assert sorted(computed[BATCHES:]) == sorted({1, 3, torn})
    assert files(tmp_path / "a") == before


@pytest.mark.slow
def test_the_folder_of_another_sweep_is_refused(tmp_path: Path, computed: list[int]) -> None:
    run(SWEEP, tmp_path)
    before = files(tmp_path)
    with pytest.raises(WavesymError, match=r"the folder of another sweep .*; write its own or a new one"):
        run({**SWEEP, "keep": {"summary": ["max"]}}, tmp_path)
    assert files(tmp_path) == before


@pytest.mark.slow
def test_what_is_lost_or_damaged_is_made_again(tmp_path: Path, computed: list[int]) -> None:
    run(SWEEP, tmp_path)
    before = files(tmp_path)
    for lost in ("done", "results.zarr", "manifest.json"):
        path = tmp_path / lost
        shutil.rmtree(path) if path.is_dir() else path.unlink()
        assert run(SWEEP, tmp_path) == 0
        assert files(tmp_path) == before
    assert len(computed) == 3 * BATCHES  # without a manifest arrays and marks are still those of the sweep
    mark = next((tmp_path / "done").iterdir())
    for text in ("{}", "[]", '{"batch": "x"}', '{"batch": 0, "cases": 1, "chunks": {}, "failed": [1]}', "[" * 10**5):
        mark.write_text(text)
        (tmp_path / "done" / "stranger.json").write_text(text)
        with pytest.raises(DamagedError, match=rf"{mark.name} damaged; 1 of 6 cases have to be computed again"):
            status(tmp_path)
        assert run(SWEEP, tmp_path) == 0
        assert {**files(tmp_path), "done/stranger.json": b""} == {**before, "done/stranger.json": b""}
    shutil.rmtree(tmp_path / "results.zarr" / "max")
    with pytest.raises(DamagedError, match=r"max/\.zarray and 7 files more damaged; 6 of 6 cases"):
        api.sweep_table(tmp_path, tmp_path / "t.csv")
    assert run(SWEEP, tmp_path) == 0
    assert {**files(tmp_path), "done/stranger.json": b""} == {**before, "done/stranger.json": b""}


@pytest.mark.slow
@pytest.mark.parametrize("moment", ["write", "put"])
def test_a_process_that_dies_at_any_moment_of_a_batch_loses_that_batch_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, computed: list[int], moment: str
) -> None:
    """Before its chunks, and between them and the mark, which is torn: as a signal does, or a machine's end."""
    run(SWEEP, tmp_path / "alone")
    del computed[:]
    where: Any = BatchMark if moment == "put" else Store
    whole, calls = getattr(where, moment), []

    def dies(self: Any, *given: Any) -> Any:
        calls.append(given)
        if len(calls) == 3:
            if moment == "put":
                given[0].with_suffix(".part").write_text('{"batch": ')
            raise KeyboardInterrupt
        return whole(self, *given)

    with monkeypatch.context() as patched:
        patched.setattr(where, moment, dies)
        with pytest.raises(KeyboardInterrupt):
            run(SWEEP, tmp_path / "a")
    assert computed == [0, 1, 2]
    assert status(tmp_path / "a").done == 2
    assert run(SWEEP, tmp_path / "a") == 0
    assert computed[3:] == [2, 3, 4, 5]
    assert files(tmp_path / "a") == files(tmp_path / "alone")


@pytest.mark.slow
def test_a_clock_that_is_set_back_changes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import time

    run(SWEEP, tmp_path / "alone")
    hours = iter(range(10**6, 0, -1))
    with monkeypatch.context() as patched:
        patched.setattr(time, "time", lambda: 3600.0 * next(hours))
        run(SWEEP, tmp_path / "a")
    assert files(tmp_path / "a") == files(tmp_path / "alone")


@pytest.mark.slow
def test_commands_that_start_at_once_do_not_disturb_each_other(tmp_path: Path) -> None:
    """One of them works, the others say so; none does it twice."""
    (tmp_path / "sweep.toml").write_text('scene = "drive_m1"\n[vary]\n"output.until" = [4, 5, 6, 7, 8, 9]\n')
    run(tmp_path / "sweep.toml", tmp_path / "alone")
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])}
    go = command("sweep.toml", "out").split()
    every = [subprocess.Popen(go, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True) for _ in range(4)]
    told = [process.communicate()[1] for process in every]
    for process, line in zip(every, told, strict=True):
        assert line.count("\n") == 1
        assert process.returncode in (0, 2)
        assert ("6 done" if process.returncode == 0 else "another process computes into it") in line
    assert any(process.returncode == 0 for process in every)
    assert files(tmp_path / "out") == files(tmp_path / "alone")


@pytest.mark.slow
def test_labelled_arrays_are_the_summaries_of_their_scenes(tmp_path: Path) -> None:
    keep = {"summary": ["min", "max", "tau_max", "arrival"], "histories": 11}
    found = api.sweep({**SWEEP, "keep": keep}, tmp_path)
    assert dict(found.sizes) == {"output.until": 2, "system.kappa[0]": 3, "output": 5, "sample": 11}
    for until in (4, 5):
        for kappa in (0.25, 0.625, 1.0):
            scene = Scene.from_toml("drive_m1").with_({"output.until": until, "system.kappa[0]": kappa})
            case = found.sel({"output.until": until, "system.kappa[0]": kappa})
            told = api.summary(scene)
            values = api.evaluator(scene)(np.linspace(0, until, 11))
            np.testing.assert_allclose(case["history"], values, rtol=0, atol=1e-15 * np.abs(values).max())
            assert case["until"] == until
            for output in told.outputs:
                row = case.sel(output=output.name)
                assert (row["min"], row["max"]) == (output.min.value, output.max.value)
                assert row["tau_max"] == output.max.at.tau
                assert row["arrival"] == output.arrival.tau


def test_a_sweep_says_that_speeds_are_adjusted_case_by_case(tmp_path: Path, capsys: Any) -> None:
    system = 'speed_adjustment = "1 %", parts = ["free", { rod = 1 }, { rod = "1.2345678" }, "fixed"]'
    scene = f'name = "two"\nsystem = {{ type = "chain", {system} }}\noutput = {{ until = 1, velocity = [0] }}\n'
    for name, text in (("adjusted", scene), ("plain", scene.replace('speed_adjustment = "1 %",', ""))):
        (tmp_path / f"{name}.toml").write_text(text + "[[load]]\nat = 0\ntimes = [0]\nsteps = [1]\n")
        sweep = tmp_path / f"{name}_sweep.toml"
        sweep.write_text(f'scene = "{name}.toml"\n[vary]\n"load[0].steps[0]" = [1, 2]\n')
        assert main(["sweep", str(sweep), "-o", str(tmp_path / name)]) == 0
        assert ("changed in each case by itself" in capsys.readouterr().err) == (name == "adjusted")


@pytest.mark.slow
def test_a_case_that_refuses_leaves_its_reason_and_the_others_go_on(tmp_path: Path, capsys: Any) -> None:
    sweep = tmp_path / "sweep.toml"
    sweep.write_text('scene = "drive_m1"\n[vary]\n"system.kappa[0]" = [1, -1, "1/2"]\n')
    out = str(tmp_path / "out")
    assert main(["sweep", str(sweep), "-o", out]) == 1
    assert main(["sweep", out, "--status", "--format", "json"]) == 0
    told = capsys.readouterr()
    assert json.loads(told.out) == {
        "cases": 3,
        "done": 2,
        "failed": 1,
        "left": 0,
        "reasons": [
            {
                "case": 1,
                "values": {"system.kappa[0]": "-1"},
                "reason": "scene: system.kappa[0]: -1 is not positive; write a number above 0",
            }
        ],
        "notes": [],
    }
    assert main(["sweep", str(sweep), "-o", out]) == 1
    assert main(["sweep", str(sweep), "-o", out, "--retry-failed"]) == 1
    for name in ("t.csv", "t.parquet"):
        assert main(["sweep", out, "--table", str(tmp_path / name)]) == 0
    header, *rows = (tmp_path / "t.csv").read_text().splitlines()
    assert header.startswith("system.kappa[0],strain@0.min,strain@0.max,strain@0.tau_min,strain@0.tau_max,")
    assert [row.split(",")[0] for row in rows] == ["1.0", "-1.0", "0.5"]
    assert set(rows[1].split(",")[1:]) == {""}
    import pandas

    table = pandas.read_parquet(tmp_path / "t.parquet")
    again = pandas.read_csv(tmp_path / "t.csv")
    assert list(table) == header.split(",")
    np.testing.assert_array_equal(table.to_numpy(), again.to_numpy())
    strain = api.summary(Scene.from_toml("drive_m1")).outputs[0]
    assert table["strain@0.max"][0] == strain.max.value


@pytest.mark.slow
def test_zipped_cases_have_one_dimension(tmp_path: Path) -> None:
    found = api.sweep({**SWEEP, "zip": True, "vary": {"output.until": [4, 5], "system.kappa[0]": [1, 2]}}, tmp_path)
    assert found["max"].dims == ("case", "output")
    assert found["output.until"].values.tolist() == [4, 5]
    assert found["case"].values.tolist() == [0, 1], "0 is a number, and none that stands for a missing one"
    api.sweep_table(tmp_path, tmp_path / "t.csv")
    assert (tmp_path / "t.csv").read_text().startswith("output.until,system.kappa[0],strain@0.min,")


@pytest.mark.slow
def test_outputs_may_differ_from_case_to_case(tmp_path: Path) -> None:
    found = api.sweep({"scene": "drive_m1", "vary": {"output.strain[0]": ["1/4", "3/4"]}}, tmp_path)
    assert {"strain@1/4", "strain@3/4", "strain@1"} < set(found["output"].values.tolist())
    missing = np.isnan(found["max"].sel(output="strain@1/4"))
    assert missing.values.tolist() == [False, True]


@pytest.mark.slow
def test_a_read_only_folder_is_refused_before_the_work(tmp_path: Path) -> None:
    sweep = tmp_path / "sweep.toml"
    sweep.write_text('scene = "drive_m1"\n[vary]\n"system.kappa[0]" = [1, 2]\n')
    if shutil.which("unshare") is None:
        pytest.skip("no unshare here, which makes folders read-only for everybody")
    (tmp_path / "out").mkdir()
    done = in_namespace(
        tmp_path, f"mount --bind out out && mount -o remount,bind,ro out && {command('sweep.toml', 'out')}"
    )
    assert done.returncode == 2, done.stderr
    assert done.stderr.count("\n") == 1
    assert "ead-only" in done.stderr or "ermission" in done.stderr


@pytest.mark.slow
def test_a_full_disk_loses_nothing(tmp_path: Path) -> None:
    """A disk of 300 kB: what fits stays, the command says why it ends, and goes on when there is more."""
    sweep = tmp_path / "sweep.toml"
    sweep.write_text('scene = "drive_m1"\n[vary]\n"output.until" = [4, 5, 6, 7, 8, 9]\n[keep]\nhistories = 2001\n')
    run(sweep, tmp_path / "alone")
    (tmp_path / "small").mkdir()
    go = command("sweep.toml", "small/out")
    done = in_namespace(
        tmp_path,
        f"mount -t tmpfs -o size=360k none small && {go}; echo exit $?; {command('small/out', None)}; "
        f"mount -o remount,size=20m small && {go}; echo exit $?; cp -r small/out kept",
    )
    assert "exit 2\n" in done.stdout, done
    assert "No space left" in done.stderr
    assert "exit 0\n" in done.stdout
    assert " 0 failed" in done.stdout
    assert "6 done" not in done.stdout.partition("exit 0")[0]
    assert files(tmp_path / "kept") == files(tmp_path / "alone")


def command(source: str, out: str | None) -> str:
    import sys

    options = f"-o {out}" if out else "--status"
    return f"{sys.executable} -m wavesym sweep {source} {options}"


def in_namespace(folder: Path, script: str) -> subprocess.CompletedProcess[str]:
    """A script where mounts are its own; skips where that is not allowed."""
    own = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c"]
    try:
        allowed = subprocess.run([*own, "mount -t tmpfs none /mnt"], capture_output=True, check=False).returncode == 0
    except FileNotFoundError:
        allowed = False
    if not allowed:
        pytest.skip("no mounts of one's own here")
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])}
    return subprocess.run([*own, script], cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_what_is_missing_is_said(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(WavesymError, match=r"zarr not installed: pip install .*\[sweep\]'"):
        run(SWEEP, tmp_path)


def test_no_folder_of_a_sweep_is_said(tmp_path: Path) -> None:
    with pytest.raises(WavesymError, match=r"no manifest.json in it"):
        status(tmp_path)
    with pytest.raises(SceneError):
        run(tmp_path / "none.toml", tmp_path)


def test_a_table_has_times_in_the_unit_of_results(tmp_path: Path) -> None:
    """The times of `summary`, in ms; tau stays beside them."""
    bar = '{ rod = "1 m", A = "8 cm^2", E = "210 GPa", rho = "7850 kg/m^3" }'
    (tmp_path / "bar.toml").write_text(
        'name = "bar"\nunits = { time = "ms" }\noutput = { until = "1 ms", force = ["0.5 m"] }\n'
        f'system = {{ type = "chain", parts = [{{ mass = "2 kg", velocity = "5 m/s" }}, {bar}, "fixed"] }}\n'
    )
    sweep, folder, table = tmp_path / "sweep.toml", tmp_path / "out", tmp_path / "t.csv"
    sweep.write_text('scene = "bar.toml"\n[vary]\n"system.parts[0].velocity" = ["5 m/s", "8 m/s"]\n')
    assert main(["sweep", str(sweep), "-o", str(folder)]) == 0
    assert main(["sweep", str(folder), "--table", str(table)]) == 0
    header, *rows = (line.split(",") for line in table.read_text().splitlines())
    assert header[-4:] == [f"force@0.5 m.{name}" for name in ("tau_min", "tau_max", "time_min [ms]", "time_max [ms]")]
    output = api.summary(Scene.from_toml(str(tmp_path / "bar.toml"))).outputs[0]
    times = [peak.at.in_scene_time for peak in (output.min, output.max)]
    for row in rows:
        assert [float(cell) for cell in row[-2:]] == pytest.approx(times, rel=1e-12)

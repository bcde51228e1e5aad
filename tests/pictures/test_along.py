"""What happens along a chain: values, envelopes and cells are those of outputs there; what pictures keep of curves."""

from __future__ import annotations

import zlib
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

import wavesym
from wavesym.mechanics.loads import AppliedLoad
from wavesym.pictures.line_histories import Band, LineHistories, Spot, cells, envelope, extremes, limit, line_histories
from wavesym.pictures.loads import load_histories, stretches
from wavesym.pictures.page.png import SHADES, colours, encode_png
from wavesym.pictures.reduction import reduce_vertices
from wavesym.scene import Scene, lower

GROUND = Scene(
    name="ground",
    system={"type": "building", "m": 3, "kappa": ["1/4", "3/5", "1/5", "2/5"], "base": "ground"},
    load=[{"times": ["1/3", 2], "a": [1, -1], "b": [0, "1/2"]}],
    output={"until": 9, "strain": ["1/7"]},
)
ALLOWED = 1e-4  # of the largest value: what a picture shows


def exact(scene: Scene, quantity: str, places: list[str], taus: np.ndarray) -> np.ndarray:
    return wavesym.evaluator(scene.with_({"output.strain": [], f"output.{quantity}": places}))(taus)


def test_floors_and_storeys_are_those_of_outputs() -> None:
    relative, drift = line_histories(GROUND, lower(GROUND))
    assert [spot.position for spot in drift.bands[0].spots] == ["1", "2", "3"]
    at = relative.taus[::37]
    floors = exact(GROUND, "displacement", ["0", "1", "2", "3"], at)
    size = np.max(np.abs(floors))
    assert np.allclose(relative.bands[0].values[:, ::37], floors - floors[0], rtol=0, atol=ALLOWED * size)
    assert np.allclose(drift.bands[0].values[:, ::37], np.diff(floors, axis=0), rtol=0, atol=ALLOWED * size)
    assert not np.allclose(drift.bands[0].values[::-1, ::37], np.diff(floors, axis=0), rtol=0, atol=ALLOWED * size)


def test_numbers_from_units_may_be_longer_than_text() -> None:
    storey = {"height": "11.4829396 ft", "stiffness": "3871.6543217 kip/in", "floor_mass": "17163.2 slug"}
    slope = "-12345678901234567/381381381381381 kip/slug/min"
    shaken = {"times": ["0 s"], "a": ["0.3188212345678 g"], "b": [slope]}
    scene = Scene(
        name="us",
        units={},
        system={"type": "building", "base": "ground", "storey": [storey | {"column_mass": "733.29 slug"}] * 2},
        load=[shaken],
        output={"until": "50 ms", "strain": [0]},
    )
    assert len(str(scene.load[0].b[0])) > 100
    _, drift = line_histories(scene, lower(scene))
    at = drift.taus[::37]
    found = exact(scene, "drift", ["1", "2"], at)
    assert np.allclose(drift.bands[0].values[:, ::37], found, rtol=0, atol=ALLOWED * np.max(np.abs(found)))


def test_strains_run_from_end_to_end_of_each_rod() -> None:
    drive = Scene.from_toml("drive_m1")
    _, strain = line_histories(drive, lower(drive))
    written = [spot.position for spot in strain.bands[0].spots]
    assert (written[0], written[-1]) == ("0+", "1-")
    assert strain.bands[0].spots[0].low == 0
    assert strain.bands[0].spots[-1].high == 1
    at = strain.taus[::41]
    found = exact(drive.with_({"output.velocity": [], "output.displacement": []}), "strain", written, at)
    assert np.allclose(strain.bands[0].values[:, ::41], found, rtol=0, atol=ALLOWED * np.max(np.abs(found)))


@pytest.mark.slow
def test_sides_that_are_one_place_are_asked_for_once() -> None:
    """A contact that counts as closed has one strain and one velocity, and stands for both of its sides."""
    collision = Scene.from_toml("collision_m4")
    for quantity in line_histories(collision, lower(collision)):
        spots = quantity.bands[0].spots
        assert [spot.low for spot in spots[1:]] == [spot.high for spot in spots[:-1]]
        assert sum(spot.x == 2 for spot in spots) == 1
        assert np.isnan(quantity.bands[0].values).any(), "what comes after its opening is formal"


def fabricated(values: np.ndarray) -> tuple[LineHistories, Band]:
    spots = tuple(Spot(str(k), str(k), k, k - 0.5, k + 0.5) for k in range(len(values)))
    band = Band("", spots, values)
    return LineHistories("strain", "", np.linspace(0, 1, values.shape[1]), (band,), None), band


@settings(max_examples=40, deadline=None)
@given(st.integers(1, 60), st.integers(1, 25), st.integers(0, 2**32))
def test_no_peak_is_lost(instants: int, columns: int, seed: int) -> None:
    values = np.random.default_rng(seed).uniform(-1, 1, (3, instants + 1))
    quantity, band = fabricated(values)
    found = cells(quantity, band, columns)
    assert np.array_equal(np.max(np.abs(found), axis=1), np.max(np.abs(values), axis=1))
    greatest, least = extremes(quantity, band)
    assert (greatest.value, least.value) == (values.max(), values.min())
    assert values[int(greatest.x), np.searchsorted(quantity.taus, greatest.tau)] == values.max()
    assert np.array_equal(envelope(band), [values.min(axis=1), values.max(axis=1)])


def test_what_is_formal_has_no_cells_and_no_extremes() -> None:
    values = np.array([[0.0, 1, 2, np.nan, np.nan], [0, -1, -2, -3, -9]])
    quantity, band = fabricated(values)
    found = cells(quantity, band, 4)
    assert np.isnan(found[0]).tolist() == [False, False, False, True]
    assert [each.value for each in extremes(quantity, band)] == [2, -9]
    assert limit([found]) < 9


@settings(max_examples=40, deadline=None)
@given(st.integers(2, 400), st.integers(1, 30), st.integers(0, 2**32))
def test_reduced_curves_keep_the_extremes_of_every_column(count: int, columns: int, seed: int) -> None:
    points = np.column_stack([np.linspace(0, 3, count), np.random.default_rng(seed).integers(-4, 5, count)])
    kept = reduce_vertices(points, 3.0, columns)
    assert set(map(tuple, kept)) <= set(map(tuple, points))
    assert np.all(np.diff(kept[:, 0]) > 0)
    assert tuple(kept[0]) == tuple(points[0])
    assert tuple(kept[-1]) == tuple(points[-1])
    assert len(kept) <= 3 * columns + 2 or len(points) <= 3 * columns
    # what lies between corners that are kept goes no farther than they do, in a column and up to the next
    part = np.minimum((points[:, 0] / 3 * columns + 1e-6).astype(int), columns)
    for column in np.unique(part):
        inside, up_to = (points[part == column], kept[np.searchsorted(kept[:, 0], points[part > column, 0][:1])])
        corners = np.vstack([kept[np.isin(kept[:, 0], inside[:, 0])], up_to])
        assert corners[:, 1].min() <= inside[:, 1].min()
        assert corners[:, 1].max() >= inside[:, 1].max()


@given(st.integers(0, 173))
def test_a_spike_is_kept_wherever_it_is(place: int) -> None:
    points = np.column_stack([np.linspace(0, 3, 174), np.zeros(174)])
    points[place, 1] = -1
    assert reduce_vertices(points, 3.0, 11)[:, 1].min() == -1


def test_loads_are_the_sums_that_scenes_state() -> None:
    """(3.2): sum of (a + b (tau - t)) H(tau - t), to the right of each jump."""
    (load,) = load_histories(lower(GROUND))
    assert load.name == "acceleration of the base"
    for tau in (0.0, 0.3, 1.0, 1.9, 2.1, 9.0):
        stretch = next(each for each in reversed(load.stretches) if each[0, 0] <= tau)
        right = 1.0 * (tau >= 1 / 3) + (-1 + (tau - 2) / 2) * (tau >= 2)
        assert np.interp(tau, *stretch.T) == pytest.approx(right, abs=1e-15)
    ramp = list(stretches([(AppliedLoad("b", fmpq(1), fmpq(2)), 1)], fmpq(3)))
    assert [each.tolist() for each in ramp] == [[[0, 0], [1, 0], [3, 4]]]


def test_cells_are_pixels(tmp_path: Path) -> None:
    """Read by a decoder of its own: shades from the least to the greatest, and one for what is no number."""
    values = np.array([[-5.0, -1, 0], [0.1, 1, np.nan]])
    data = encode_png(values, -1.0, 1.0, signed=True)
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    start = data.index(b"IDAT") + 4
    size = int.from_bytes(data[start - 8 : start - 4], "big")
    rows = zlib.decompress(data[start : start + size])
    pixels = [
        [byte >> 4 if k % 2 == 0 else byte & 15 for byte in row for k in (0, 1)] for row in (rows[1:3], rows[4:6])
    ]
    middle = SHADES // 2
    assert [row[:3] for row in pixels] == [[0, 0, middle], [middle + 1, SHADES - 1, SHADES]]


def test_sizes_go_from_light_to_dark_and_values_with_a_sign_from_white() -> None:
    sizes, signed = ([sum(colour) for colour in colours(signed=each)[:-1]] for each in (False, True))
    assert all(later < before for before, later in pairwise(sizes))
    assert signed.index(max(signed)) == SHADES // 2
    assert signed[0] < signed[SHADES // 2] > signed[-1]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["envelope", "map"])
def test_the_same_picture_again(kind: str, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    from wavesym import api

    for file in ("one.svg", "other.svg"):
        api.plot(GROUND, tmp_path / file, kind)
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "other.svg").read_bytes()

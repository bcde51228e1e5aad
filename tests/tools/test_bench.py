"""The scenes of the benchmark are what their names say, and what they are compared with has their degree."""

from pathlib import Path

import pytest
from flint import fmpq

from tools.bench import equal_degree, frame_records, frames, record_response, report
from tools.bench.equal_degree import FittedPieces, at_degree, fit_pieces, ratios
from wavesym.exact.breakpoints import Breakpoints
from wavesym.exact.contacts.events import events
from wavesym.numbers.doubles import rational
from wavesym.running.native import FAST
from wavesym.scene import lower
from wavesym.sweeps.kinds import kind
from wavesym.sweeps.plan import plan
from wavesym.sweeps.request import SweepRequest

FOLDER = Path(__file__).parents[2] / "bench"
CHAINS = report.scenes(FOLDER, report.CHAINS)


@pytest.mark.slow
def test_the_chains_have_what_they_are_for():
    lengths, spring, wagons = (lower(CHAINS[label]) for label in "LSE")
    assert len({bar.delay for bar in lengths.network.bars}) == 3
    assert spring.network.links[0].stiffness == 10
    assert len(events(wagons)) == 20


def test_three_lengths_cost_their_knots():
    """A common grid would have 2e11 steps; the ways from the pushed mass and back are few."""
    model = lower(CHAINS["L"])
    rods = [bar.delay for bar in model.network.bars]
    coming = [(fmpq(0), 0)]  # at the mass between rods `place - 1` and `place`
    met = {(fmpq(0), 0)}
    while coming:
        time, place = coming.pop()
        for other, rod in ((place - 1, place - 1), (place + 1, place)):
            if 0 <= rod < 3 and (at := (time + rods[rod], other)) not in met and at[0] <= 20:
                met.add(at)
                coming.append(at)
    ways = {time for time, place in met if place == 0}
    knots = Breakpoints(model, rational(model.horizon())).joints[0]
    assert {knot for knot in knots if knot <= fmpq(39, 2)} == {way for way in ways if way <= fmpq(39, 2)}


@pytest.mark.slow
def test_a_chain_is_fitted_to_a_degree(monkeypatch):
    monkeypatch.setattr(equal_degree, "_DIGITS", (4, 6, 8))
    aim = fit_pieces(CHAINS["S"], fmpq(1, 10**6))
    found = at_degree(CHAINS["S"], aim.degree)
    assert isinstance(found, FittedPieces)
    assert found.degree == aim.degree
    assert min(aim.form.degrees) <= aim.degree <= max(aim.form.degrees)


@pytest.mark.slow
def test_a_scene_takes_as_long_as_itself():
    """Nothing is asserted of the time itself."""
    one = fit_pieces(CHAINS["S"], fmpq(1, 10**6))
    assert all(0 < ratio < 100 for ratio in ratios(one, one, FAST))


@pytest.mark.slow
def test_a_record_has_rows_of_modes_and_elements(monkeypatch):
    monkeypatch.setattr(record_response, "SAMPLES", 120)
    monkeypatch.setattr(record_response, "medians", lambda ways, **_: [1.0] * len(ways))
    assert len(record_response.frame().outputs) == 31
    (_, _, error), *elements = record_response.rows()
    assert float(error) < 1e-6
    errors = [float(error) for _, _, error in elements]
    assert errors[0] > 2 * errors[-1] > 0


@pytest.mark.slow
def test_frames_have_a_row(monkeypatch):
    """Errors are within estimates."""
    monkeypatch.setattr(frames, "_SETS", (3,))
    monkeypatch.setattr(frames, "_HELD", 1)
    (row,) = frames.rows(FOLDER.parent / "examples" / "records")
    assert 0 < float(row[-1]) < 1


@pytest.mark.slow
def test_many_records_go_through_many_frames(monkeypatch, tmp_path):
    """All records differ, and so do all frames; nothing is asserted of the time itself."""
    pytest.importorskip("zarr")
    records = FOLDER.parent / "examples" / "records"
    text = frame_records.inputs(tmp_path, records / "elcentro_1940_ns_peknold.at2", 15, 3)
    (tmp_path / "sweep.toml").write_text(text)
    assert len({path.read_text() for path in (tmp_path / "records").iterdir()}) == 15
    file, request = SweepRequest.read(tmp_path / "sweep.toml")
    planned = plan(request, file)
    assert planned.shape == (3, 15)
    assert kind(planned)[0] == "recorded"
    monkeypatch.setattr(frame_records, "STOREYS", 2)
    monkeypatch.setattr(frame_records, "RECORDS", 3)
    monkeypatch.setattr(frame_records, "FRAMES", 2)
    (row,) = frame_records.rows(records)
    assert row[0] == "3 x 2"
    assert len(row) == len(frame_records.HEAD)
    assert all(float(each) > 0 for each in row[1:])

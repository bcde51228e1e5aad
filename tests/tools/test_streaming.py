"""What is measured of records is what it says: all floors of a frame under El Centro, by modes, and its stream."""

from pathlib import Path

import numpy as np
import pytest

from tools.bench import panels, streaming
from wavesym.programs.choice import choose
from wavesym.programs.making import program
from wavesym.running.native import FAST
from wavesym.scene import Scene, lower

RECORD = Path(__file__).parents[2] / "examples" / "records" / "elcentro_1940_ns_peknold.at2"


def test_frames_have_all_floors(tmp_path):
    path = tmp_path / "frame.toml"
    path.write_text(streaming.frame(RECORD, 40))
    model = lower(Scene.from_toml(path))
    assert len(model.probes) == 121
    assert len(model.network.bars) == 40
    assert sum(load.source == "b" for load in model.loads) > 900  # many samples lie on a line


def test_a_stream_is_measured_sample_by_sample(tmp_path):
    """Nothing is asserted of the time itself."""
    path = tmp_path / "frame.toml"
    path.write_text(streaming.frame(RECORD, 2).replace("1e-5", "1e-2"))
    model = lower(Scene.from_toml(path))
    made = choose(model, "modes").evaluator
    assert 0 < streaming._stepping(program(model, made), FAST) < 1e-3
    assert np.isfinite(made.scheme.evaluate(made.tau_max)).all()


@pytest.mark.slow
def test_panels_are_measured_of_scenes_whose_streams_go_on():
    """Nothing is asserted of the time itself."""
    found = list(panels.rows(steps=50))
    assert {row[0] for row in found} == {"ten discs", "building_m2", "drive_m1", "geared_drive"}
    assert all(len(row) == len(panels.HEAD) and float(row[-2]) > 0 for row in found)
    assert len(panels.discs().outputs) == 4

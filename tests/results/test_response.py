"""What `wavesym.evaluator` and models at run time do with instants that have no value."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import wavesym
from wavesym.cli import main
from wavesym.errors import WavesymError
from wavesym.scene import Scene

OUTSIDE = [-1.0, np.nan, 1.0, 10.5]


@pytest.mark.parametrize("of", ["evaluator", "model"])
def test_values_outside_the_horizon_are_said_once(of):
    scene = Scene.from_toml("drive_m1")
    values = wavesym.evaluator(scene) if of == "evaluator" else wavesym.model(scene, runtime=["kappa"]).run
    with pytest.warns(UserWarning, match="values are nan") as said:
        found = values(OUTSIDE)
    assert [str(each.message) for each in said] == ["3 of 4 tau are outside 0 to 10, where values are nan"]
    assert said[0].filename == __file__
    assert np.isnan(found[..., [0, 1, 3]]).all()
    assert np.isfinite(found[..., 2]).all()
    with pytest.raises(WavesymError, match=r"^tau: 3 of 4 tau are outside 0 to 10, where there are no values"):
        values(OUTSIDE, strict=True)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        values([0.0, 1.0, 10.0])
        values([0.0, 1.0, 10.0], strict=True)


def test_the_command_says_it_in_its_own_words(tmp_path, capfd):
    (tmp_path / "at").write_text("1\n10.5\n")
    assert main(["run", "drive_m1", "--at", str(tmp_path / "at")]) == 0
    error = capfd.readouterr().err
    assert "1 of 2 tau are outside 0 to 10, where values are nan" in error
    assert "Warning" not in error

"""A sweep keeps any statistic of a summary, also those that only whole scenes have."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import wavesym
from wavesym.results.statistics import ARRAYS


def test_every_statistic_is_kept(tmp_path: Path, thorough: bool) -> None:
    pytest.importorskip("zarr")
    kappa = [f"{k}/4" for k in range(2, 12 if thorough else 4)]
    request = {"scene": "drive_m1", "vary": {"system.kappa[0]": kappa}, "keep": {"summary": list(ARRAYS)}}
    found = wavesym.sweep(request, tmp_path / "made", workers=1)
    assert set(ARRAYS) <= set(found.data_vars)
    scene = wavesym.Scene.from_toml("drive_m1").with_({"system.kappa[0]": kappa[1]})
    for name, values in wavesym.peaks(scene, keep=list(ARRAYS)).items():
        np.testing.assert_array_equal(found[name].values[1], values, name)

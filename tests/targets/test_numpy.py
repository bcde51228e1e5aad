"""Generated NumPy where tau is out of range, beyond every number included."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from tests.support.builds import SOURCES, scene
from tests.support.generated import files
from wavesym.running.compilation import import_text
from wavesym.scene import lower


@pytest.mark.quick(2)
@pytest.mark.parametrize(("evaluator", "precision"), SOURCES)
def test_what_is_out_of_range_is_nan_without_a_warning(evaluator: str, precision: str) -> None:
    made = files(lower(scene("range", "1e-9" if precision == "double" else "1e-2")), "numpy", evaluator, precision)
    module = import_text(made["range.py"], "made")
    outside = [-np.inf, -1e30, -1e-30, np.nextafter(np.float32(6), np.float32(7)), 1e30, np.inf, np.nan]
    inside = [0.0, 1.5, 6.0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        values = module.evaluate([*outside, *inside])
        alone = [module.evaluate(tau) for tau in outside]
    assert np.isnan(values[:, : len(outside)]).all()
    assert np.isnan(alone).all()
    assert np.isfinite(values[:, len(outside) :]).all()

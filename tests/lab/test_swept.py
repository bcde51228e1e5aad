"""What is measured of sweeps is sweeps that are done."""

from pathlib import Path

import pytest

pytest.importorskip("zarr", reason="the extra `sweep` is not installed")

from wavesym.lab import swept
from wavesym.scene import Scene, lower


@pytest.mark.slow
def test_sweeps_are_measured_that_fail_nowhere(tmp_path: Path) -> None:
    """Nothing is asserted of the time itself."""
    swept.inputs(tmp_path, records=3, samples=300)
    for text in (swept.FRAMES.format(structures=2), swept.SHAFTS.format(sets=9)):
        seconds, megabytes = swept._swept(tmp_path, text)
        assert float(seconds) > 0
        assert float(megabytes) > 0
    assert swept._rival(lower(Scene.from_toml(tmp_path / "drive.toml")), 3) > 0

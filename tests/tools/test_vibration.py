"""What is measured of frequencies are structures as long as the page says, and commands that answer."""

from pathlib import Path

import pytest

from tools.bench import vibration
from wavesym.scene import Scene, lower

RECORDS = Path(__file__).parents[2] / "examples" / "records"


def bars(text: str, folder: Path) -> int:
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return len(lower(Scene.from_toml(path)).network.bars)


def test_chains_have_so_many_rods(tmp_path: Path) -> None:
    """The rock below the soil is one more; most layers differ."""
    assert bars(vibration.soil(20), tmp_path) == 21
    assert bars(vibration.drill_string(10), tmp_path) == 10
    layers = [line for line in vibration.soil(vibration.LAYERS).split("{ rod") if "speed" in line]
    assert len(set(layers)) > vibration.LAYERS / 2


@pytest.mark.slow
def test_each_command_has_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    """None is refused; nothing is asserted of the time itself."""
    monkeypatch.setattr(vibration, "LAYERS", 6)
    monkeypatch.setattr(vibration, "PIPES", 10)
    monkeypatch.setattr(vibration, "POINTS", 5)
    found = list(vibration.rows(RECORDS))
    assert len(found) == 6
    assert "6 layers" in found[2][0]
    assert all(float(busy) > 0 and float(peak) > 0 for _, busy, peak in found)


@pytest.mark.slow
def test_what_is_refused_has_no_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(vibration, "POINTS", 0)
    monkeypatch.setattr(vibration, "LAYERS", 6)
    monkeypatch.setattr(vibration, "PIPES", 10)
    assert [row[1:] for row in vibration.rows(RECORDS) if "frf" in row[0]] == [("refused", "")] * 3

"""Bars with thin layers and a contact between them: waves are constant between fronts, and known exactly for long."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import fmpq

from tests.support.generated import numpy_text
from tests.support.parting import Rod, Struck
from wavesym.exact.motion import Motion
from wavesym.mechanics.model import Model
from wavesym.programs.choice import attempt
from wavesym.running.compilation import import_text
from wavesym.scene import Scene, lower

# a specimen in two steps: cut from the bars, and of another material, with the digits that SI units leave
CUT = [{"rod": "1/40", "impedance": "1/4"}, {"rod": "1/100", "impedance": "1/8"}]
OTHER = [
    {"rod": "1/50", "speed": "0.98444641272513672", "impedance": "0.084649895683146318"},
    {"rod": "1/100", "speed": "0.98444641272513672", "impedance": "0.16929979136629264"},
]
WATCHED = ((1, Fraction(1, 2)), (2, Fraction(1, 3)), (4, Fraction(1, 7)))


def chain(specimen: list[dict[str, Any]], until: object, end: str = "free") -> Model:
    """A striker, a gap, a bar, the specimen, a bar."""
    parts = [{"rod": 1, "velocity": 1}, {"contact": "1/10"}, {"rod": 2}, *specimen, {"rod": 3}, end]
    begin = np.cumsum([0, 1, 2, *(Fraction(str(each["rod"])) for each in specimen)])
    lengths = [1, 2, *(Fraction(str(each["rod"])) for each in specimen), 3]
    places = [str(begin[rod] + part * lengths[rod]) for rod, part in WATCHED]
    output = {"until": until, "tolerance": 1e-9, "strain": places, "velocity": places}
    return lower(Scene(name="steps", system={"type": "chain", "parts": parts}, output=output))


def fraction(value: fmpq) -> Fraction:
    return Fraction(int(value.p), int(value.q))


def truth(model: Model, taus: list[float], end: str = "free") -> np.ndarray[Any, Any]:
    """Strains, then velocities."""
    bars = model.network.bars
    rods = [Rod(fraction(bar.delay), fraction(bar.impedance), fraction(bar.velocity)) for bar in bars]
    struck = Struck(rods, ["free", Fraction(1, 10), *["joint"] * (len(rods) - 2), end])
    assert [kind for _, kind, _ in struck.events(Fraction(model.horizon()))][:2] == ["closes", "opens"]
    waves = [[rods[rod].waves(part, Fraction(tau)) for tau in taus] for rod, part in WATCHED]
    strains = [
        [(left - right) / fraction(bars[rod].speed) for right, left in row]
        for (rod, _), row in zip(WATCHED, waves, strict=True)
    ]
    return np.array([*strains, *([right + left for right, left in row] for row in waves)], dtype=float)


@pytest.mark.parametrize(
    ("specimen", "until", "end"),
    [
        (CUT, 5, "free"),
        pytest.param(OTHER, 5, "absorbing", marks=pytest.mark.slow),
        pytest.param(CUT, 26, "absorbing", marks=pytest.mark.slow),
        pytest.param(OTHER, 12, "free", marks=pytest.mark.slow),
    ],
)
def test_crossings_of_thin_layers_cost_no_digits(specimen: list[dict[str, Any]], until: object, end: str) -> None:
    """Two bits each would be more than pieces have."""
    model = chain(specimen, until, end)
    tried = attempt(model, "pieces")
    assert tried.form
    assert not tried.refusal
    taus = tried.form.check_points[::3]
    found = import_text(numpy_text(model, tried.form), "layers").evaluate(np.array(taus))
    true = truth(model, taus, end)
    assert len(set(true[-1])) > 50
    sizes = np.abs(true).max(axis=1)
    bounds = [(output.bound + 2.0**-53) * size for output, size in zip(tried.form.outputs, sizes, strict=True)]
    assert (np.abs(found - true).max(axis=1) <= bounds).all()
    assert tried.form.error_bound < 1e-15


@pytest.mark.parametrize(
    ("part", "until", "helps"),
    [
        ({"mass": 1}, 30, "a shorter horizon or longer rods"),
        ({"mass": "1e-4"}, 1, "heavier bodies"),
        ({"joint": True, "spring": 50000}, 1, "softer springs"),
        ({"mass": "1e-3", "spring": 5000}, 1, "heavier bodies or softer springs"),
    ],
)
def test_what_would_help_is_what_costs_most(part: dict[str, Any], until: object, helps: str) -> None:
    parts = [{"rod": 1, "velocity": 1}, {"velocity": 0, **part}, {"rod": "1/20"}]
    scene = Scene(name="s", system={"type": "chain", "parts": parts}, output={"until": until, "velocity": ["1/2"]})
    model = lower(scene)
    assert Motion(model, model.until).helps == helps


def test_pieces_refuse_by_bits_that_series_need_and_name_what_helps() -> None:
    """Where layers are as thin, and bodies make series of what crosses them."""
    parts = [{"rod": 1, "velocity": 1}, {"mass": 1, "velocity": 0}, *CUT, {"rod": 3}]
    model = lower(Scene(name="s", system={"type": "chain", "parts": parts}, output={"until": 8, "velocity": ["1/2"]}))
    tried = attempt(model, "pieces")
    assert tried.refusal == (
        "output.until: 1280 bits would be needed for pieces to tau = 8, the limit is 1024 (a shorter horizon or "
        "longer rods help)"
    )

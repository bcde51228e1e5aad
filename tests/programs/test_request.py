"""What a program is asked to be, and what comes of it."""

from __future__ import annotations

import pytest

from tests.support.builds import scene
from tests.support.generated import files
from wavesym.errors import WavesymError
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.scene import lower


@pytest.fixture(scope="module")
def model():
    return lower(scene("made", "1e-4"))


@pytest.mark.quick(1)
@pytest.mark.parametrize("precision", ["double", "single"])
def test_small_is_smaller_and_fast_is_shorter(model, precision):
    """Of the same kind: less bytes of tables, and a higher degree of polynomials to be evaluated."""
    fast, small = (make(model, Request("pieces", precision, optimize=aim)) for aim in ("speed", "size"))
    assert small.bytes < fast.bytes
    assert max(small.error_bound, fast.error_bound) <= 1e-4
    lengths = [len(made.tables["coefficient"]) / (len(made.tables["first_power"]) - 1) for made in (small, fast)]
    assert lengths[0] > lengths[1]


def test_unless_it_is_said_double_is_fast_and_single_small(model):
    for precision, aim in (("double", "speed"), ("single", "size")):
        usual, said = (make(model, Request("auto", precision, optimize=word)) for word in (None, aim))
        assert usual.tables == said.tables


def test_of_all_kinds_the_smallest_is_taken(model):
    tried = [make(model, Request(kind, optimize="size")) for kind in ("closed", "pieces")]
    assert make(model, Request(optimize="size")).bytes == min(program.bytes for program in tried)


def test_what_was_asked_for_is_in_the_files(model):
    made = files(model, "c", "pieces", "single", "speed")["made.h"]
    assert "wavesym generate made.toml --evaluator pieces --precision single --optimize speed" in made


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        (Request(evaluator="spline"), "evaluator: spline is unknown; write auto, closed, pieces, march or modes"),
        (Request(precision="half"), "precision: half is unknown; write double or single"),
        (Request(optimize="cost"), "optimize: cost is unknown; write speed or size"),
    ],
)
def test_a_word_that_is_none_of_those_is_refused(request_, words):
    with pytest.raises(WavesymError, match=f"^{words}$"):
        request_.refuse_unknown()

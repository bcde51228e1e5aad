"""What tests break on purpose is in today's C: most do so slowly, and would not see for long that a place has gone."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.running import test_chain_bounds, test_fmu_parameters, test_fmu_simulated
from tests.targets import test_march_c, test_modes_c, test_stream_c, test_stream_parameters, test_stream_sampled
from tests.verification import test_damped

TEMPLATES = Path(__file__).parents[2] / "templates"
TABLES = {
    "march": test_march_c.BREAKS,
    "modes": test_modes_c.BREAKS,
    "mode sets": test_damped.FAULTS,
    "streams": test_stream_c.BREAKS,
    "streams with parameters": test_stream_parameters.FAULTS,
    "streams under samples": test_stream_sampled.FAULTS,
    "models": dict(enumerate((*test_chain_bounds.BLOCKS, *test_chain_bounds.BODIES, *test_chain_bounds.POINTS))),
    "FMUs": test_fmu_simulated.FAULTS,
    "FMUs with parameters": test_fmu_parameters.FAULTS,
}


@pytest.mark.parametrize("table", TABLES)
def test_what_is_broken_on_purpose_is_in_a_template(table: str) -> None:
    texts = [file.read_text(encoding="utf-8") for file in TEMPLATES.rglob("*.*")]
    gone = [fault for fault, (right, _) in TABLES[table].items() if not any(right in text for text in texts)]
    assert gone == []

"""What is measured of links with corners: slips that are as many as said, and a section that stands once."""

from __future__ import annotations

import pytest

from tools.bench.__main__ import replace_section
from tools.bench.corners import _reckon, block
from wavesym.exact.contacts.events import events
from wavesym.scene import lower


def test_the_block_slips_and_sticks_each_time_that_its_load_turns() -> None:
    assert [event.kind for event in events(lower(block(5)))] == ["slips", "sticks"] * 5


def test_steps_are_those_of_the_first_grid_within_a_target_or_reckoned() -> None:
    taken = [(100, 1.0, 4e-3), (200, 2.0, 1e-3), (400, 4.0, 2.5e-4)]
    assert _reckon(taken, 1e-3) == ("200", "2.000", "2.0")
    assert _reckon(taken, 2.5e-6) == ("4.0e+03 (reckoned)", "4.0e+02 (reckoned)", "2.0")


def test_a_section_takes_the_place_of_itself() -> None:
    page = "# A\n\n## B\n\nold\n\n## Charts\n\nc\n"
    once = replace_section(page, "## B\n\nnew\n")
    assert once == "# A\n\n## B\n\nnew\n\n## Charts\n\nc\n"
    assert replace_section(once, "## B\n\nnew\n") == once
    assert replace_section(once, "## Charts\n\nd\n") == "# A\n\n## B\n\nnew\n\n## Charts\n\nd\n"
    with pytest.raises(SystemExit, match="## D: no such section"):
        replace_section(page, "## D\n\nnew\n")

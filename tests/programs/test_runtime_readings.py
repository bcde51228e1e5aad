"""What is read together of models built at run time: every strand of a section once, in an order that adds up."""

import pytest

from tests.targets.test_runtime_c import BUILDING
from wavesym.programs.request import Request
from wavesym.programs.runtime.making import runtime_program
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import amplitudes

SCENES = {
    "building": (BUILDING, ("kappa", "load")),
    "chain": (Scene.from_toml("stepped_shaft").with_({"output.until": 2, "output.velocity": [0, "1/2", 1]}), ("mass",)),
}


@pytest.mark.parametrize("case", SCENES)
def test_every_strand_of_a_section_is_read_once(case):
    scene, runtime = SCENES[case]
    tables = runtime_program(lower(scene), Request(runtime=runtime), amplitudes(scene)).tables
    outputs, together = len(scene.outputs), 0
    for section in range(len(tables["first_reading"]) - 1):
        first, last = tables["first_strand"][section * outputs], tables["first_strand"][(section + 1) * outputs]
        read, begun = [], set()
        for reading in range(*tables["first_reading"][section : section + 2]):
            start = tables["reading_strand"][reading]
            strands = range(start, start + tables["reading_strands"][reading])
            own = {tables["strand_output"][strand] for strand in strands}
            assert len(own) == len(strands)
            assert len({(tables["strand_start"][s], tables["strand_scale"][s]) for s in strands}) == 1
            assert own & begun == (own if tables["reading_more"][reading] else set())
            read += strands
            begun |= own
            together += len(strands) > 1
        assert sorted(read) == sorted(tables["strand_at"][first:last])
    assert together > 0

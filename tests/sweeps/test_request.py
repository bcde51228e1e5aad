"""Files of sweeps: what they come to, exactly, and what is wrong with them, in one line."""

from __future__ import annotations

from fractions import Fraction
from math import prod
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wavesym.errors import SceneError
from wavesym.scene import Scene
from wavesym.sweeps.plan import SweepPlan, plan
from wavesym.sweeps.request import SweepRequest

AT2 = """PEER
MADE
ACCELERATION TIME SERIES IN UNITS OF G
NPTS= 4, DT= .0100 SEC
 0.0 {} .2 .1
"""
FRAME = """
name = "frame"
[units]
[system]
type = "building"
base = "ground"
damping = 0.05
[[system.storey]]
count = 2
height = "3.5 m"
stiffness = "678 MN/m"
column_mass = "10.871 t"
floor_mass = "350 t"
[[load]]
record = "a.at2"
[output]
until = "0.1 s"
tolerance = 1e-4
drift = [1]
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "frame.toml").write_text(FRAME)
    for k, name in enumerate("abc"):
        (tmp_path / f"{name}.at2").write_text(AT2.format(f".{k + 1}"))
    return tmp_path


def planned(folder: Path, text: str) -> SweepPlan:
    (folder / "sweep.toml").write_text(text)
    file, request = SweepRequest.read(folder / "sweep.toml")
    return plan(request, file)


def refused(folder: Path, text: str) -> str:
    with pytest.raises(SceneError) as error:
        planned(folder, text)
    message = str(error.value)
    assert "\n" not in message
    assert message.startswith(str(folder))
    return message.removeprefix(f"{folder}/")


DRIVE = 'scene = "drive_m1"\n'


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x =", "sweep.toml: not TOML"),
        ('[vary]\n"output.until" = [1]', "sweep.toml: scene: missing; write the path of a scene"),
        (DRIVE, "sweep.toml: nothing is varied; write a table [vary], or records"),
        (DRIVE + "[vari]", "sweep.toml: vari: unknown key; write scene, records, zip, vary or keep. Did you"),
        ('scene = "nowhere.toml"\n[vary]\n"output.until" = [1]', "nowhere.toml: No such file"),
        (DRIVE + '[vary]\n"output.until" = []', 'vary."output.until": no values; write at least 1'),
        (DRIVE + '[vary]\n"output.until" = 3', 'vary."output.until": 3 is not a list of values'),
        (DRIVE + '[vary]\n"output.till" = [3]', 'vary."output.till": unknown key'),
        (DRIVE + '[vary]\n"system.kappa[7]" = [3]', 'vary."system.kappa[7]": nothing at [7]'),
        (DRIVE + '[vary]\n"sistem.kappa[0]" = [3]', 'vary."sistem.kappa[0]": nothing called "sistem". Did you mean'),
        (
            DRIVE + '[vary]\n"a b" = [3]',
            'vary."a b": not a path; write one such as "output.until" or "load[0].times[2]"',
        ),
        (DRIVE + '[vary]\n"output.until" = [3, 4, "6/2"]', '"6/2" stands at [0] and again at [2]; write it once'),
        (
            DRIVE + '[vary]\n"output.until" = { from = 1, to = 1, count = 2 }',
            '"1" stands at [0] and again at [1]; write it once',
        ),
        (DRIVE + '[vary]\n"output.until" = { from = 1, to = 2, count = 0 }', ".count: 0 values; write at least 1"),
        (
            DRIVE + '[vary]\n"output.until" = { from = 1, to = 2, count = 1 }',
            'vary."output.until".count: 1 value, but `from` and `to` differ; write 2 or more',
        ),
        (DRIVE + '[vary]\n"output.until" = { from = 0, to = 2, count = 3, log = true }', "two numbers of one sign"),
        (DRIVE + '[vary]\n"output.until" = { from = 1, to = "2 s", count = 3 }', "write a number in no unit"),
        (
            DRIVE + '[vary]\n"output.until" = { from = 1, to = 2, count = 1_000_000_000 }',
            "vary: 1000000000 cases, the limit is 10000000; write fewer values",
        ),
        (
            DRIVE + "[vary]\n" + "".join(f'"{p}" = {{ from = 1, to = 2, count = 1000 }}\n' for p in ("a", "b", "c")),
            "vary: 1000000000 cases, the limit is 10000000; write fewer values",
        ),
        (
            DRIVE + '[vary]\nzip = true\n"output.until" = [3, 4]\n"system.kappa[0]" = [1]',
            "2 of output.until, 1 of system",
        ),
        (
            DRIVE + '[vary]\n"system.kappa" = [[1]]\n"system.kappa[0]" = [1]',
            'vary."system.kappa[0]": "system.kappa" is varied too, and one is part of the other',
        ),
        (
            DRIVE + '[vary]\n"output.until" = [3]\n[keep]\nsummary = ["median"]',
            'keep.summary[0]: "median" is not a statistic; write min, max, tau_min, tau_max, arrival, mean, rms',
        ),
        (
            DRIVE + '[vary]\n"output.until" = [3]\n[keep]\nhistories = 1',
            "keep.histories: 1 samples; write 2 to 1000000",
        ),
        (
            DRIVE + '[vary]\n"output.until" = [3]\n[keep]\nsummary = []',
            "keep: keeps nothing; write a summary or histories",
        ),
        (DRIVE + 'records = "*.at2"', "records: 0 loads of the scene have a record; write one that has"),
        (
            DRIVE + "[vary]\n" + "".join(f'"load[{k}].body" = [1]\n' for k in range(31)),
            "vary: 31 dimensions, the limit is 30",
        ),
        (
            DRIVE + '[vary]\n"output.until" = ["\\u0000", 1979-05-27]\n"output.tolerance" = ["x"]\nx = [1]',
            'vary."x": a whole table',
        ),
        (
            'scene = "frame.toml"\nrecords = "\\u0000"',
            'records[0]: no file at "\\x00"; write that of an AT2 or CSV file',
        ),
        ('scene = "frame.toml"\nrecords = "*.csv"', 'records[0]: no file at "*.csv"; write that of an AT2 or CSV file'),
        (
            DRIVE + '[vary]\n"output" = [{ until = 3, strain = [0] }]',
            'vary."output": a whole table; write a field in it, such as "output.until"',
        ),
    ],
)
def test_what_is_wrong_with_a_sweep_is_one_line(folder: Path, text: str, expected: str) -> None:
    assert expected in refused(folder, text)


def test_a_sweep_is_the_product_of_what_is_varied(folder: Path) -> None:
    made = planned(
        folder,
        DRIVE + '[vary]\n"system.kappa[0]" = { from = "1/20", to = "1/2", count = 4 }\n"output.until" = [0.1, 5]',
    )
    assert made.shape == (4, 2)
    scenes = [made.scene(made.place(case)) for case in range(made.cases)]
    assert [scene.system.kappa[0] for scene in scenes[::2]] == [Fraction(1, 20) + k * Fraction(3, 20) for k in range(4)]
    assert [scene.output.until for scene in scenes[:2]] == [Fraction(1, 10), 5]
    assert made.labels_at(made.place(3)) == {"system.kappa[0]": "1/5", "output.until": "5"}


def test_ratios_are_equal_and_their_ends_exact(folder: Path) -> None:
    made = planned(folder, DRIVE + '[vary]\n"system.kappa[0]" = { from = "1/3", to = 300, count = 4, log = true }')
    values = made.dimensions[0].columns[0].coordinate
    assert [made.scene((k,)).system.kappa[0] for k in (0, 3)] == [Fraction(1, 3), 300]
    assert values == pytest.approx([1 / 3, 900 ** (1 / 3) / 3, 900 ** (2 / 3) / 3, 300], rel=1e-15)


def test_zipped_fields_run_side_by_side(folder: Path) -> None:
    text = DRIVE + 'zip = true\n[vary]\n"system.kappa[0]" = [1, 2, 1]\n"output.until" = [3, 4, 5]'
    made = planned(folder, text)
    assert [dimension.name for dimension in made.dimensions] == ["case"]
    assert [(made.scene((k,)).system.kappa[0], made.scene((k,)).output.until) for k in range(3)] == [
        (1, 3),
        (2, 4),
        (1, 5),
    ]
    inside = text.replace("zip = true\n[vary]\n", "[vary]\nzip = true\n")
    assert planned(folder, inside).sha256 == made.sha256
    assert "again at [2]; write it once" in refused(
        folder, text.replace("[1, 2, 1]", "[1, 2, 1]").replace("[3, 4, 5]", "[3, 4, 3]")
    )


@pytest.mark.slow
def test_quantities_with_one_unit_are_numbers_in_it(folder: Path) -> None:
    made = planned(
        folder,
        'scene = "frame.toml"\nrecords = "*.at2"\n[vary]\n'
        '"system.storey[0].stiffness" = { from = "400 MN/m", to = "900 MN/m", count = 3 }\n'
        '"system.damping" = ["1/50", 0.05]',
    )
    assert made.shape == (3, 2, 3)
    stiffness, damping, record = (dimension.columns[0] for dimension in made.dimensions)
    assert (stiffness.coordinate, stiffness.unit) == ((400.0, 650.0, 900.0), "MN/m")
    assert (damping.coordinate, damping.unit) == ((0.02, 0.05), "")
    assert record.coordinate == ("a.at2", "b.at2", "c.at2")
    highest = [made.scene((0, 0, k)).load[0].record.samples[1] for k in range(3)]
    assert [each / highest[0] for each in highest] == [1, 2, 3]


@pytest.mark.slow
def test_the_hash_is_that_of_all_that_goes_in(folder: Path) -> None:
    text = 'scene = "frame.toml"\nrecords = "*.at2"\n[vary]\n"system.damping" = [0.02, 0.05]'
    first = planned(folder, text).sha256
    assert planned(folder, text.replace("0.02", '"1/50"')).sha256 != first  # another text, which tables show
    (folder / "b.at2").write_text(AT2.format(".9"))
    assert planned(folder, text).sha256 != first
    (folder / "b.at2").write_text(AT2.format(".2"))
    assert planned(folder, text).sha256 == first
    (folder / "frame.toml").write_text(FRAME.replace("350 t", "351 t"))
    assert planned(folder, text).sha256 != first


@pytest.mark.slow
def test_a_damaged_record_is_a_case_that_fails(folder: Path) -> None:
    (folder / "b.at2").write_text(AT2.format("x"))
    made = planned(folder, 'scene = "frame.toml"\nrecords = "*.at2"')
    assert isinstance(made.scene((0,)), Scene)
    with pytest.raises(SceneError, match=r"b\.at2: line 5"):
        made.scene((1,))


def one_line(error: SceneError) -> None:
    assert str(error).isprintable()


VALUES = st.one_of(
    st.integers(-2, 9),
    st.fractions(0, 9, max_denominator=40).map(str),
    st.sampled_from(["1/0", "x", True, [], "3 m", 10**400, "1e-999"]),
)
PATHS = st.sampled_from(["system.kappa[0]", "output.until", "system.inertia[1]", "load[0].steps[0]", "nope", "load[9]"])
SPANS = st.fixed_dictionaries(
    {"from": VALUES, "to": VALUES, "count": st.integers(-1, 2**40)}, optional={"log": st.booleans()}
)


@settings(max_examples=15)
@given(
    vary=st.dictionaries(PATHS, st.one_of(st.lists(VALUES, max_size=4), SPANS), max_size=3),
    zipped=st.booleans(),
)
def test_any_sweep_is_refused_in_a_line_or_has_all_its_cases(vary: dict, zipped: bool) -> None:
    """Whatever is varied: the counts are right, and each case has its values exactly, or says why it is none."""
    fields = {"scene": "drive_m1", "vary": vary, "zip": zipped}
    try:
        file, request = SweepRequest.read(fields)
        made = plan(request, file)
    except SceneError as error:
        one_line(error)
        return
    counts = [each["count"] if isinstance(each, dict) else len(each) for each in vary.values()]
    assert made.cases == (counts[0] if zipped else prod(counts))
    for case in {0, made.cases // 2, made.cases - 1}:
        told = made.labels_at(made.place(case))
        assert set(told) == set(vary)
        try:
            scene = made.scene(made.place(case))
        except SceneError as error:
            one_line(error)
            continue
        if "system.kappa[0]" in told:
            assert scene.system.kappa[0] == Fraction(told["system.kappa[0]"])
        if "output.until" in told:
            assert scene.output.until == Fraction(told["output.until"])

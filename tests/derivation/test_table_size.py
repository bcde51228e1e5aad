"""What is told of a table before it is made, against the table."""

from itertools import product

import pytest
from flint import fmpq

import wavesym
from wavesym.derivation import table_size as room
from wavesym.derivation.table import full_table
from wavesym.derivation.table_size import LARGEST, table_size
from wavesym.errors import CostError

EQUAL, UNEQUAL = lambda i: "1", lambda i: f"{(37 * i) % 101 + 1}/{i % 7 + 3}"
LOADS = {"drive": [{"body": 1, "times": [0], "steps": [1]}], "building": [{"times": [0], "a": [1], "b": [0]}]}


def system(kind, m, kappa):
    numbers = [kappa(i) for i in range(m + 1)]
    fields = {
        "drive": lambda: {"kappa": numbers[:m], "inertia": numbers[::-1]},
        "building": lambda: {"kappa": numbers, "base": "force"},
        "collision": lambda: {"kappa": numbers[: m // 2], "velocity": [1] + [0] * (m // 2 - 1)},
    }[kind]()
    scene = wavesym.Scene(
        name="sized",
        system={"type": kind, "m": m, **fields},
        load=LOADS.get(kind, []),
        output={"until": 1, "tolerance": "1e-6", "strain": ["1/2"]},
    )
    return scene.system.chain


def told(made, interval, intervals):
    wanted = {(function, rod): intervals for function in "fg" for rod in range(1, made.m + 1)}
    return table_size(made, interval, wanted, made.sources)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("kind", "m", "kappa", "intervals", "most"),
    [
        ("drive", 1, UNEQUAL, 80, 1.1),
        ("drive", 6, UNEQUAL, 14, 2),
        ("drive", 12, EQUAL, 20, 2),
        ("drive", 60, EQUAL, 2, 2),
        ("building", 2, UNEQUAL, 30, 2),
        ("building", 40, UNEQUAL, 2, 2),
        ("building", 80, EQUAL, 2, 2.5),
        ("collision", 4, UNEQUAL, 40, 2),
        ("collision", 20, UNEQUAL, 10, 6),  # contacts reflect nothing there
    ],
)
def test_a_table_is_about_as_large_as_told(kind, m, kappa, intervals, most):
    made = system(kind, m, kappa)
    table = full_table(made, intervals, fmpq(0))
    increments = [one for response in table.responses.values() for row in response.values() for one in row]
    values = [value for increment in increments for powers in increment.values() for value in powers]
    digits = sum(int(v.p).bit_length() + int(v.q).bit_length() for v in values) / 8
    size = told(made, table.interval, intervals)
    assert 0.8 * len(values) <= size.coefficients <= most * len(values)
    kept = digits + 100 * len(values) + 72 * len(increments)
    assert 0.5 * kept <= size.bytes <= 2 * most * kept


@pytest.mark.parametrize(
    ("kind", "m", "intervals"), [("drive", 1, 10**9), ("drive", 1, 2000), ("drive", 3000, 2), ("building", 3000, 1)]
)
def test_an_absurd_table_is_refused_before_it_is_made(kind, m, intervals, monkeypatch):
    def made(*_):
        raise AssertionError("the table was begun")

    monkeypatch.setattr("wavesym.derivation.table.unit_response", made)
    with pytest.raises(CostError, match=r"^--intervals: the tables of coefficients would take"):
        full_table(system(kind, m, EQUAL), intervals, fmpq(0))


def test_what_is_asked_of_tables_is_served():
    for kind, m, intervals in (("drive", 12, 24), ("building", 10, 30), ("building", 300, 2)):
        assert told(system(kind, m, UNEQUAL), 1 + (kind == "building"), intervals).bytes < LARGEST


def test_more_sources_and_larger_numbers_make_more():
    few, many = system("drive", 4, EQUAL), system("drive", 4, UNEQUAL)
    wanted = {("f", 2): 20}
    one, all_ = table_size(many, 1, wanted, ["M1"]), table_size(many, 1, wanted, many.sources)
    assert one.bytes < all_.bytes
    assert table_size(few, 1, wanted, few.sources).bytes < all_.bytes


def test_detours_counted_at_once_are_those_counted_one_by_one(monkeypatch):
    """A horizon of a million has as many detours: one by one they would take half a minute only to be refused."""
    made = system("building", 5, UNEQUAL)
    wanted = {("f", 1): 400, ("g", 3): 150, ("f", 5): 7}
    at_once = table_size(made, 2, wanted, made.sources)
    monkeypatch.setattr(room, "_AT_ONCE", 1)
    assert table_size(made, 2, wanted, made.sources) == pytest.approx(at_once, rel=1e-12)


@pytest.mark.parametrize("most", [10, 1e3, 1e5, room.MOST_WORK])
def test_what_is_small_at_a_glance_is_small(most):
    """The glance must never let a table pass that counting would refuse; and it must let some pass."""
    seen = set()
    for kind, m, kappa in product(("drive", "building", "collision"), (4, 12), (EQUAL, UNEQUAL)):
        made = system(kind, m, kappa)
        for interval, intervals in product((1, 2), (1, 3, 10, 30)):
            wanted = {(function, rod): intervals for function in "fg" for rod in range(1, made.m + 1)}
            small = room._small(made, interval, wanted, set(made.sources), most)
            size = table_size(made, interval, wanted, made.sources)
            assert not small or (size.work <= most and size.bytes <= LARGEST)
            seen.add(small)
    assert seen == ({False} if most == 10 else {True, False})

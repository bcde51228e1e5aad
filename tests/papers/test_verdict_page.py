"""Records asked for by name."""

import pytest

from tests.papers.small import entry
from wavesym.errors import WavesymError
from wavesym.papers.verdict_page import requested_entries

IDS = {
    "(2.4).5": "section 2, (2.4)",
    "(4.1)": "section 4, (4.1)",
    "(4.10)": "section 4, (4.10)",
    "III.1": "section 4, coefficients",
    "III.14": "section 4, coefficients",
    "T2.g_1.K_1": "Table 2, row g_1, column K_1",
    "T2.g_1.j_1": "Table 2, row g_1, column j_1",
    "T3.d": "Table 3, head",
    "text.2": "section 1, first paragraph",
    "text.22": "section 5, Fig. 7",
}
ENTRIES = tuple(entry(id, "n = n", where) for id, where in IDS.items())


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("(4.10)", ["(4.10)"]),
        ("4.10", ["(4.10)"]),
        ("4.1", ["(4.1)"]),
        ("2.4", ["(2.4).5"]),
        ("(2.4)_5", ["(2.4).5"]),
        ("2.4.5", ["(2.4).5"]),
        ("III", ["III.1", "III.14"]),
        ("iii.14", ["III.14"]),
        ("T2", ["T2.g_1.K_1", "T2.g_1.j_1"]),
        ("T2.g_1.K_1", ["T2.g_1.K_1"]),
        ("text.2", ["text.2"]),
        ("section 4", ["(4.1)", "(4.10)", "III.1", "III.14"]),
        ("Table 3", ["T3.d"]),
    ],
)
def test_a_name_means_an_id_a_group_or_a_place(name: str, found: list[str]) -> None:
    assert [each.id for each in requested_entries(ENTRIES, [name])] == found


def test_several_names_come_in_the_order_of_print_and_once() -> None:
    assert [each.id for each in requested_entries(ENTRIES, ["text", "4.1", "text.22"])] == [
        "(4.1)",
        "text.2",
        "text.22",
    ]


@pytest.mark.parametrize(
    ("name", "meant"), [("4.11", "4.1"), ("III.41", "III.14"), ("T2.g_1.K1", "T2.g_1.K_1"), ("txt.22", "text.22")]
)
def test_a_name_that_is_not_there_is_answered_with_one_that_is(name: str, meant: str) -> None:
    with pytest.raises(WavesymError, match=rf"^{name}: no such record.*Did you mean .*{meant}") as caught:
        requested_entries(ENTRIES, ["III.1", name])
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["", "(", "section", "4.1.", "drive_m1"])
def test_what_is_no_name_at_all(name: str) -> None:
    with pytest.raises(WavesymError, match="no such record"):
        requested_entries(ENTRIES, [name])

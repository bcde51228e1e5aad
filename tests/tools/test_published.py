"""docs/published.md: printed numbers beside ours, computed again."""

from __future__ import annotations

import pytest

from tools.published_numbers import PAGE, ComparedNumber, cases, compare_numbers, page


@pytest.fixture(scope="module")
def found(thorough: bool) -> dict[tuple[str, int], list[ComparedNumber]]:
    """All numbers, computed once; without --run-slow those of each sixth scene."""
    chosen = list(cases())[:: 1 if thorough else 6]
    return {
        (case["scene"], k): compare_numbers(case, each) for case in chosen for k, each in enumerate(case["numbers"])
    }


@pytest.mark.slow
def test_the_page_is_what_is_computed_now(found: dict[tuple[str, int], list[ComparedNumber]]) -> None:
    text = "".join(page(lambda case, numbers: found[case["scene"], case["numbers"].index(numbers)]))
    assert PAGE.read_text(encoding="utf-8") == text


def test_what_differs_has_a_reason(found: dict[tuple[str, int], list[ComparedNumber]]) -> None:
    told = {"error", "approximation"}
    groups = {(case["scene"], k): each for case in cases() for k, each in enumerate(case["numbers"])}
    assert found
    for key, numbers in found.items():
        assert all(each.same for each in numbers) == (not (told | {"elements", "rock_damping"}) & groups[key].keys()), (
            key
        )
        if not told & groups[key].keys():  # or an approximation that is computed gives what is printed
            assert all(each.same or each.is_approximation for each in numbers), key


@pytest.mark.parametrize(
    ("printed", "own", "same"),
    [("10.304", 10.30449, True), ("10.304", 10.3046, False), ("11.8e6", 11849050.0, True), ("0.0008", 0.00086, False)],
)
def test_the_last_printed_digit_decides(printed: str, own: float, same: bool) -> None:
    assert ComparedNumber(printed, own).same == same

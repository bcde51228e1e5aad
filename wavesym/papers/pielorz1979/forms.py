"""(4.9)-(4.12): which rates occur with which powers, and the rates of a drive."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from flint import fmpq

from wavesym.papers.exact_tables import Exact, building, collision, drive, gammas
from wavesym.papers.pielorz1979.powers import Index, present
from wavesym.papers.pielorz1979.table_2_collision import ROWS, rods
from wavesym.papers.pielorz1979.table_3_drive import HEADS
from wavesym.papers.record import Case, Claim, Slip

Rates = Callable[[Exact], Any]


def claims() -> Iterator[Claim[Any]]:
    """The forms of the solutions."""
    yield from _collision()
    yield from _drive()
    yield from _rates()
    yield from _building()


def _collision() -> Iterator[Claim[Any]]:
    yield Claim(
        "(4.9)",
        "section 4, (4.9)",
        r"F'_{i, n+1}(z) = F'_{i, n}(z) + F^{i, n+1} + e^{-2\kappa_1(z-2n)} \sum_{k=0}^{\kappa_1} F_{1, k}^{i, "
        r"n+1} (z-2n)^k "
        r"+ \sum_{s=1}^2 \sum_{j=J_{0, s}}^{J_s} e^{-2\kappa_{2j+1}(z-2n)} \sum_{k=0}^{E(K_{j, s}/2)} "
        r"F_{2j+1, k}^{i, n+1} (z-2n)^k + e^{-2\kappa_{m-1}(z-2n)} \sum_{k=0}^{K_{m-1}} F_{m-1, k}^{i, n+1} (z-2n)^k, "
        r"F'_{i, 0}(z) = 0",
        "the functions of Table 2; 2n <= z < 2n+2, n = 0, 1, ...",
        "exact tables, m = 4, 6, 8: the upper limit at rate 2 kappa_1, and which rates occur",
        _first_sum,
        lambda table, row, at: table.chain.parameters.kappa[1],
        {"K_1 + 1": lambda table, row, at: ROWS[row]["K_1"].right(at) + 1, "K_(m-1)": _last_limit},
        Slip(
            "unreadable",
            r"\sum_{k=0}^{K_1}",
            lambda table, row, at: ROWS[row]["K_1"].right(at),
            "The limit is read as kappa_1, which is no whole number; the text below and Table 2 have K_1: beyond "
            "doubt.",
        ),
    )


def _drive() -> Iterator[Claim[Any]]:
    yield Claim(
        "(4.10)",
        "section 4, (4.10)",
        r"F'_{i, a}(z) = F'_{i, a-1}(z) + \sum_{\alpha=1}^2 \{ \sum_{r=s_\alpha}^{R_\alpha} [ \sum_{k=0}^{m_s} "
        r"\bar{M}_{s, k} \{ F^{i, s, a} + \sum_{\beta=1}^3 [ \sum_{l=L_{\beta-1}+1}^{L_\beta} e^{-\gamma_l w} "
        r"( \sum_{j=0}^{K_\beta} F_{L, j}^{i, s, a} w^j ) ] \} ] \}, F'_{i, 0}(z) = 0",
        "d-1 <= z < d",
        "the heads of Table 3 and the rates of the exact tables, m = 1 ... 5",
        _drive_form,
        ("a", "L", gammas),
        {"gamma doubled": ("d", "l", _doubled), "a for d": ("a", "l", gammas), "L for l": ("d", "L", gammas)},
        Slip(
            "unreadable",
            r"d for a, F_{l, j}^{i, s, d} for F_{L, j}^{i, s, a}",
            ("d", "l", gammas),
            "Table 3 and the text below have d, the sum runs over l: beyond doubt.",
        ),
    )


def _rates() -> Iterator[Claim[Any]]:
    yield _gamma(
        "(4.11).1",
        r"\gamma_1 = \kappa_1, \gamma_i = \kappa_1 + \kappa_{i-1} \frac{J_{i-1}}{J_i}",
        "i = 2, 3, ..., m",
        lambda m: range(1, m + 1),
        lambda t, i: _gamma_i(t, i, 1),
        Slip(
            "misprint",
            r"\gamma_i = \kappa_i + \kappa_{i-1} \frac{J_{i-1}}{J_i}",
            lambda t, i: _gamma_i(t, i, i),
            "Index: kappa_1 for kappa_i; (4.7).4 has kappa_i.",
        ),
    )
    yield _gamma(
        "(4.11).2",
        r"\gamma_{m+1} = \kappa_m \frac{J_m}{J_{m+1}}",
        "",
        lambda m: range(m + 1, m + 2),
        lambda t, i: _transmitted(t, i),
        None,
    )
    for name, even, odd, value, parity in (
        ("r_0", 1, 0, lambda i: 1 - i % 2, 0),
        ("r_1", 0, 1, lambda i: i % 2, 1),
    ):
        yield _flag(name, even, odd, value, parity)


def _building() -> Iterator[Claim[Any]]:
    yield Claim(
        "(4.12)",
        "section 4, (4.12)",
        r"F'_{i,n+1}(z) = F'_{i,n}(z) + \sum_{k=0}^{m_1} H(z-2n-\tau_k) [F^{k, \cdot, n+1} + "
        r"F_0^{k, i, n+1}(z-2n-\tau_k) + e^{-2\kappa_1(z-2n-\tau_k)} \sum_{j=0}^{K_1} F_{1,j}^{k, i, "
        r"n+1}(z-2n-\tau_k)^j "
        r"+ e^{-2\kappa_m(z-2n-\tau_k)} \sum_{j=0}^{K_m} F_{m,j}^{k, i, n+1}(z-2n-\tau_k)^j], F'_{i,0}(z) = 0",
        "2n <= z < 2n+2, n = 0, 1, ...",
        "the rates of the exact tables with equal floors, m = 2 ... 7, and the highest power at rate 0",
        _building_form,
        lambda k, m: {fmpq(0): 1, 2 * k[1]: None, 2 * k[m]: None},
        {"kappa_1 for 2 kappa_1": lambda k, m: {fmpq(0): 1, k[1]: None, k[m]: None}, "no F_0": _no_linear},
        Slip(
            "misprint",
            r"e^{-\kappa_m(z-2n-\tau_k)}, F^{k, i, n+1}",
            lambda k, m: {fmpq(0): 1, 2 * k[1]: None, k[m]: None},
            "The roof has a column on one side only, so that its rate is kappa_m, as in (4.8).4. In the first "
            "coefficient the "
            "index i cannot be read.",
        ),
        scan=r"z \in (2n, 2n+2)",
    )


def _first_sum(limit: Callable[[Exact, str, Index], Any]) -> Iterator[Case]:
    for m in (4, 6, 8):
        table = collision(m)
        kappa = table.chain.parameters.kappa
        rates = {fmpq(0), *(2 * k for k in kappa.values())}
        for n in range(9):
            for row in ROWS:
                letter, numbers = rods(row, m)
                for i in numbers:
                    true = table.degree(letter, i, n + 1, 2 * kappa[1])
                    printed = present(limit(table, row, Index(m, n, i)))
                    yield Case({"m": m, "n": n, "F": f"{letter}_{i}", "kappa_1": kappa[1]}, printed, true, true >= 0)
                    found = set(table.increment("impact", letter, i, n + 1))
                    yield Case(
                        {"m": m, "n": n, "F": f"{letter}_{i}", "claim": "rates"}, found <= rates, True, bool(found)
                    )


def _last_limit(table: Exact, row: str, at: Index) -> Any:
    return ROWS[row]["K_m-1"].right(at)


def _doubled(table: Exact) -> dict[int, fmpq]:
    return {l: 2 * rate for l, rate in gammas(table).items()}  # noqa: E741 - the paper's letter


def _drive_form(reading: tuple[str, str, Rates]) -> Iterator[Case]:
    interval, body, rates = reading
    yield Case({"claim": "letter of the interval"}, interval, next(key for key in HEADS["even"] if key != "w"))
    yield Case({"claim": "letter of the body"}, body, "l")
    for m in range(1, 6):
        table = drive(m)
        found = {
            rate for response in table.responses.values() for parts in response.values() for p in parts for rate in p
        }
        yield Case({"m": m, "claim": "rates"}, {fmpq(0), *rates(table).values()}, found)


def _transmitted(table: Exact, i: int) -> fmpq:
    p = table.chain.parameters
    return p.kappa[i - 1] * p.inertia[i - 1] / p.inertia[i]  # type: ignore[no-any-return]


def _gamma_i(table: Exact, i: int, own: int) -> fmpq:
    kappa = table.chain.parameters.kappa
    return kappa[1] if i == 1 else kappa[own] + _transmitted(table, i)  # type: ignore[no-any-return]


def _gamma(
    id: str,
    text: str,
    ranges: str,
    span: Callable[[int], range],
    value: Callable[[Exact, int], fmpq],
    slip: Slip[Callable[[Exact, int], fmpq]] | None,
) -> Claim[Callable[[Exact, int], fmpq]]:
    right = slip.reading if slip else value

    def cases(reading: Callable[[Exact, int], fmpq]) -> Iterator[Case]:
        for m in range(1, 6):
            table = drive(m)
            p = table.chain.parameters
            for i in span(m):
                numbers = {"kappa": dict(p.kappa), "J": dict(p.inertia)}
                yield Case({"m": m, "i": i, **numbers}, reading(table, i), gammas(table)[i])

    return Claim(
        id,
        f"section 4, {id}",
        text,
        ranges,
        "half the sum of what the two shafts do to a disc, by its node, m = 1 ... 5",
        cases,
        value,
        {"twice": lambda t, i: 2 * right(t, i), "sign": lambda t, i: -right(t, i)},
        slip,
    )


def _flag(name: str, even: int, odd: int, value: Callable[[int], int], parity: int) -> Claim[Callable[[int], int]]:
    def cases(reading: Callable[[int], int]) -> Iterator[Case]:
        for i in range(1, 7):
            first = next(s for s in (1, 2) if (s - i) % 2 == parity)
            yield Case({"i": i, "claim": f"first moment, s = {name} + 1"}, reading(i) + 1, first)

    return Claim(
        f"(4.11).{name}",
        "section 4, under (4.11)",
        f"{name} = {even} for even i, {odd} for odd i",
        "",
        "the first moment of the right parity in Table 3, s = 2r+1 - flag with r = flag",
        cases,
        value,
        {"turned": lambda i: 1 - value(i)},
        scan=rf"{name} = {even} dla i parzystych, {odd} dla i nieparzystych",
    )


def _no_linear(k: Any, m: int) -> dict[fmpq, int | None]:
    return {fmpq(0): 0, 2 * k[1]: None, k[m]: None}


def _building_form(reading: Callable[[Any, int], dict[fmpq, int | None]]) -> Iterator[Case]:
    """All rates, and at rate 0 the constant and the linear part."""
    for m in range(2, 8):
        table = building(m)
        kappa = table.chain.parameters.kappa
        parts = [p for response in table.responses.values() for increments in response.values() for p in increments]
        form = reading(kappa, m)
        where = {"m": m, "kappa_1": kappa[1], "kappa_m": kappa[m]}
        yield Case({**where, "claim": "rates"}, set(form), {rate for part in parts for rate in part})
        yield Case(
            {**where, "claim": "highest power at rate 0"},
            form[fmpq(0)],
            max(len(p.get(fmpq(0), ())) for p in parts) - 1,
        )

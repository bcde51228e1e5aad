"""III.1 ... III.22: the coefficient recurrences of example III as they are printed, term by term, and as corrected."""

from __future__ import annotations

from flint import fmpq

from wavesym.papers.pielorz1979.recurrence import (
    At,
    Correction,
    Count,
    Family,
    PrintedLine,
    PrintedTarget,
    PrintedTerm,
    down,
    first,
    minus,
    n_1,
    n_2,
    plus,
    rod,
    roof,
    second,
    this_rod,
    top_rod,
    under_roof,
    up,
    visits,
    zero,
)

_FIRST = (PrintedTarget("f", "c", first, first), PrintedTarget("f", "0", first, first))


def _constants(number: int, family: Family) -> PrintedLine:
    """III.2 and III.3, the same but for the index 0."""
    mark = "_0" if family == "0" else ""
    return PrintedLine(
        number,
        f"f{mark}^{{k,1,n+1}} = f{mark}^{{k,2,n}} + H(n-2) g{mark}^{{k,2,n}} - f{mark}^{{k,1,n}}",
        "n >= 1",
        (PrintedTarget("f", family, first, first, start=1),),
        (
            PrintedTerm(f"f{mark}^{{k,2,n}}", plus, "f", family, rod(2), 1, zero),
            PrintedTerm(f"H(n-2) g{mark}^{{k,2,n}}", plus, "g", family, rod(2), 1, zero, (n_2,)),
            PrintedTerm(f"-f{mark}^{{k,1,n}}", minus, "f", family, rod(1), 1, zero),
        ),
    )


def _left_going(number: int, family: Family) -> PrintedLine:
    """III.4 and III.7, the same but for the index 0."""
    mark = "_0" if family == "0" else ""
    return PrintedLine(
        number,
        f"g{mark}^{{k,j,n+1}} = H(n-1) (f{mark}^{{k,j+1,n}} - f{mark}^{{k,j,n}}) + H(n-2) g{mark}^{{k,j+1,n}}",
        "j = 2, 3, ..., m-1",
        (PrintedTarget("g", family, second, under_roof),),
        (
            PrintedTerm(f"H(n-1) f{mark}^{{k,j+1,n}}", plus, "f", family, this_rod(1), 1, zero, (n_1,)),
            PrintedTerm(f"-H(n-1) f{mark}^{{k,j,n}}", minus, "f", family, this_rod(), 1, zero, (n_1,)),
            PrintedTerm(f"H(n-2) g{mark}^{{k,j+1,n}}", plus, "g", family, this_rod(1), 1, zero, (n_2,)),
        ),
    )


def _roof_constant(family: Family) -> PrintedLine:
    """III.5; the linear part's index 0 is missing as printed."""
    mark = "_0" if family == "0" else ""
    return PrintedLine(
        5,
        rf"g^{{k,m,n+1}} = H(n-1) (f^{{k,m,n}} - \frac{{2}}{{\kappa_m}} f{mark}^{{k,m,n}})",
        "",
        (PrintedTarget("g", "c", roof, roof),),
        (
            PrintedTerm("H(n-1) f^{k,m,n}", plus, "f", "c", top_rod(), 1, zero, (n_1,)),
            PrintedTerm(
                rf"-H(n-1) \frac{{2}}{{\kappa_m}} f{mark}^{{k,m,n}}",
                lambda at: -2 / at.kappa[at.m],
                "f",
                family,
                top_rod(),
                1,
                zero,
                (n_1,),
            ),
        ),
    )


def _right_constant(letter: str) -> PrintedLine:
    """III.6; the linear part of the other wave has the wrong letter as printed."""

    def lag(at: At) -> fmpq:
        return -1 / (2 * at.kappa[1])

    return PrintedLine(
        6,
        r"f^{k,j,n+1} = f^{k,j-1,n+1} - \frac{1}{2\kappa_1} "
        f"[H(n-1) {letter}_0^{{k,j,n+1}} + f_0^{{k,j-1,n+1}}]",
        "j = 2, 3, ..., m",
        (PrintedTarget("f", "c", second, roof),),
        (
            PrintedTerm("f^{k,j-1,n+1}", plus, "f", "c", this_rod(-1), 0, zero),
            PrintedTerm(
                rf"-\frac{{1}}{{2\kappa_1}} H(n-1) {letter}_0^{{k,j,n+1}}",
                lag,
                letter,
                "0",
                this_rod(),
                0,
                zero,
                (n_1,),
            ),
            PrintedTerm(r"-\frac{1}{2\kappa_1} f_0^{k,j-1,n+1}", lag, "f", "0", this_rod(-1), 0, zero),
        ),
    )


def _left_power(shift: int, begun: tuple[Count, ...] = ()) -> PrintedLine:
    """III.12; the rod of the wave that returns is j+1 as printed. `begun`: see `_next_to_roof`."""

    def guard(at: At) -> int:
        return 2 * at.n + at.j - 4 - at.i

    returned = "f_{1,i}^{k,j+1,n}" if shift else "f_{1,i}^{k,j,n}"
    return PrintedLine(
        12,
        f"g_{{1,i}}^{{k,j,n+1}} = f_{{1,i}}^{{k,j+1,n}} + H(2n+j-4-i)(g_{{1,i}}^{{k,j+1,n}} - {returned})",
        "j = 2, 3, ..., m-2; i = 2n+j-3, 2n+j-4, ..., 0",
        (PrintedTarget("g", "1", second, lambda m: m - 2, top=lambda at: 2 * at.n + at.j - 3),),
        (
            PrintedTerm("f_{1,i}^{k,j+1,n}", plus, "f", "1", this_rod(1), 1),
            PrintedTerm("H(2n+j-4-i) g_{1,i}^{k,j+1,n}", plus, "g", "1", this_rod(1), 1, guards=(guard, *begun)),
            PrintedTerm(f"-H(2n+j-4-i) {returned}", minus, "f", "1", this_rod(shift), 1, guards=(guard,)),
        ),
        strict=1,
    )


def _next_to_roof(begun: tuple[Count, ...] = ()) -> PrintedLine:
    """III.13. `begun` = (n-2,): g has no coefficients in the first interval, whatever H(2n+m-6-i) says for n = 1."""
    return PrintedLine(
        13,
        "g_{1,i}^{k,m-1,n+1} = f_{1,i}^{k,m,n} + H(2n+m-6-i)g_{1,i}^{k,m,n} - H(2n+m-5-i)f_{1,i}^{k,m-1,n}",
        "i = 2n+m-4, 2n+m-5, ..., 0",
        (PrintedTarget("g", "1", under_roof, under_roof, top=lambda at: 2 * at.n + at.m - 4),),
        (
            PrintedTerm("f_{1,i}^{k,m,n}", plus, "f", "1", top_rod(), 1),
            PrintedTerm(
                "H(2n+m-6-i)g_{1,i}^{k,m,n}",
                plus,
                "g",
                "1",
                top_rod(),
                1,
                guards=(lambda at: 2 * at.n + at.m - 6 - at.i, *begun),
            ),
            PrintedTerm(
                "-H(2n+m-5-i)f_{1,i}^{k,m-1,n}",
                minus,
                "f",
                "1",
                top_rod(-1),
                1,
                guards=(lambda at: 2 * at.n + at.m - 5 - at.i,),
            ),
        ),
        strict=1,
    )


def _roof_power(index: str, power: Count) -> PrintedLine:
    """III.14; an index is i+n as printed."""

    def guard(at: At) -> int:
        return 2 * at.n + at.m - 5 - at.i

    def raised(at: At) -> fmpq:
        return (at.i + 1) / at.gap

    return PrintedLine(
        14,
        rf"g_{{1,i}}^{{k,m,n+1}} = \frac{{1}}{{2\kappa_1 - \kappa_m}} [(i+1)(g_{{1,{index}}}^{{k,m,n+1}} + "
        r"f_{1,i+1}^{k,m,n})H(2n+m-5-i) - (2\kappa_1 + \kappa_m)f_{1,i}^{k,m,n}]",
        "i = 2n+m-4, 2n+m-5, ..., 0",
        (PrintedTarget("g", "1", roof, roof, top=lambda at: 2 * at.n + at.m - 4),),
        (
            PrintedTerm(
                rf"\frac{{i+1}}{{2\kappa_1 - \kappa_m}} H(2n+m-5-i) g_{{1,{index}}}^{{k,m,n+1}}",
                raised,
                "g",
                "1",
                top_rod(),
                0,
                power,
                (guard,),
            ),
            PrintedTerm(
                r"\frac{i+1}{2\kappa_1 - \kappa_m} H(2n+m-5-i) f_{1,i+1}^{k,m,n}",
                raised,
                "f",
                "1",
                top_rod(),
                1,
                up,
                (guard,),
            ),
            PrintedTerm(
                r"-\frac{2\kappa_1 + \kappa_m}{2\kappa_1 - \kappa_m} f_{1,i}^{k,m,n}",
                lambda at: -(2 * at.kappa[1] + at.kappa[at.m]) / at.gap,
                "f",
                "1",
                top_rod(),
                1,
            ),
        ),
        strict=1,
        scan=r"H(2n+m-5-i) + - (2\kappa_1 + \kappa_m)f_{1,i}^{k,m,n}",
    )


def _roof_start(own: str, family: Family) -> PrintedLine:
    """III.17; as printed the coefficient stands on both sides."""
    return PrintedLine(
        17,
        f"g_{{m,0}}^{{k,m,n+1}} = -{own}^{{k,m,n+1}} - g_{{1,0}}^{{k,m,n+1}}H(n-1)",
        "n >= 1, where III.16 ends",
        (PrintedTarget("g", "m", roof, roof, start=1),),
        (
            PrintedTerm(f"-{own}^{{k,m,n+1}}", minus, "g", family, top_rod(), 0, zero),
            PrintedTerm("-g_{1,0}^{k,m,n+1}H(n-1)", minus, "g", "1", top_rod(), 0, zero, (n_1,)),
        ),
    )


def _floor_start(own: str, family: Family, shift: int) -> PrintedLine:
    """III.22; as printed the coefficient stands on both sides, and H switches f_(m,0) on one interval early."""
    guard = "H(n-m+j-1)" if shift else "H(n-m+j)"
    return PrintedLine(
        22,
        f"f_{{1,0}}^{{k,j,n+1}} = -{own}^{{k,j,n+1}} - {guard}f_{{m,0}}^{{k,j,n+1}}",
        "j = 2, 3, ..., m",
        (PrintedTarget("f", "1", second, roof),),
        (
            PrintedTerm(f"-{own}^{{k,j,n+1}}", minus, "f", family, this_rod(), 0, zero),
            PrintedTerm(
                f"-{guard}f_{{m,0}}^{{k,j,n+1}}",
                minus,
                "f",
                "m",
                this_rod(),
                0,
                zero,
                (lambda at: at.n - at.m + at.j - shift,),
            ),
        ),
    )


PRINTED: tuple[PrintedLine, ...] = (
    PrintedLine(
        1,
        r"f^{k,1,1} = -\frac{1}{\kappa_0} \bar{a}_k, \quad f_0^{k,1,1} = -\frac{1}{\kappa_0} \bar{b}_k",
        "",
        _FIRST,
        (),
        {("a", "c"): lambda at: -1 / at.kappa[0], ("b", "0"): lambda at: -1 / at.kappa[0]},
    ),
    _constants(2, "c"),
    _constants(3, "0"),
    _left_going(4, "c"),
    _roof_constant("c"),
    _right_constant("f"),
    _left_going(7, "0"),
    PrintedLine(
        8,
        "g_0^{k,m,n+1} = H(n-1) f_0^{k,m,n}",
        "",
        (PrintedTarget("g", "0", roof, roof),),
        (PrintedTerm("H(n-1) f_0^{k,m,n}", plus, "f", "0", top_rod(), 1, zero, (n_1,)),),
    ),
    PrintedLine(
        9,
        "f_0^{k,j,n+1} = f_0^{k,j-1,n+1}",
        "j = 2, 3, ..., m",
        (PrintedTarget("f", "0", second, roof),),
        (PrintedTerm("f_0^{k,j-1,n+1}", plus, "f", "0", this_rod(-1), 0, zero),),
    ),
    PrintedLine(
        10,
        "f_{1,i}^{k,1,n+1} = f_{1,i}^{k,2,n} + H(2n-3-i) g_{1,i}^{k,2,n} - H(2n-4-i) f_{1,i}^{k,1,n}",
        "i = 2n-2, 2n-3, ..., 0",
        (PrintedTarget("f", "1", first, first, top=lambda at: 2 * at.n - 2),),
        (
            PrintedTerm("f_{1,i}^{k,2,n}", plus, "f", "1", rod(2), 1),
            PrintedTerm(
                "H(2n-3-i) g_{1,i}^{k,2,n}", plus, "g", "1", rod(2), 1, guards=(lambda at: 2 * at.n - 3 - at.i,)
            ),
            PrintedTerm(
                "-H(2n-4-i) f_{1,i}^{k,1,n}", minus, "f", "1", rod(1), 1, guards=(lambda at: 2 * at.n - 4 - at.i,)
            ),
        ),
    ),
    PrintedLine(
        11,
        "f_{m,i}^{k,1,n+1} = f_{m,i}^{k,2,n} + g_{m,i}^{k,2,n} - H(n-m-1-i) f_{m,i}^{k,1,n}",
        "i = n-m, n-m-1, ..., 0",
        (PrintedTarget("f", "m", first, first, top=lambda at: at.n - at.m),),
        (
            PrintedTerm("f_{m,i}^{k,2,n}", plus, "f", "m", rod(2), 1),
            PrintedTerm("g_{m,i}^{k,2,n}", plus, "g", "m", rod(2), 1),
            PrintedTerm(
                "-H(n-m-1-i) f_{m,i}^{k,1,n}", minus, "f", "m", rod(1), 1, guards=(lambda at: at.n - at.m - 1 - at.i,)
            ),
        ),
    ),
    _left_power(1),
    _next_to_roof(),
    _roof_power("i+n", lambda at: at.i + at.n),
    PrintedLine(
        15,
        "g_{m,i}^{k,j,n+1} = f_{m,i}^{k,j+1,n} + g_{m,i}^{k,j+1,n} - H(n-2-m+j-i)f_{m,i}^{k,j,n}",
        "j = 2, 3, ..., m-1; i = n-m+j-1, n-m+j-2, ..., 0",
        (PrintedTarget("g", "m", second, under_roof, top=lambda at: at.n - at.m + at.j - 1),),
        (
            PrintedTerm("f_{m,i}^{k,j+1,n}", plus, "f", "m", this_rod(1), 1),
            PrintedTerm("g_{m,i}^{k,j+1,n}", plus, "g", "m", this_rod(1), 1),
            PrintedTerm(
                "-H(n-2-m+j-i)f_{m,i}^{k,j,n}",
                minus,
                "f",
                "m",
                this_rod(),
                1,
                guards=(lambda at: at.n - 2 - at.m + at.j - at.i,),
            ),
        ),
    ),
    PrintedLine(
        16,
        r"g_{m,i}^{k,m,n+1} = -H(n-2-i)f_{m,i}^{k,m,n} + \frac{2\kappa_m}{i}f_{m,i-1}^{k,m,n}",
        "i = n-1, n-2, ..., 1",
        (PrintedTarget("g", "m", roof, roof, top=lambda at: at.n - 1, bottom=1),),
        (
            PrintedTerm(
                "-H(n-2-i)f_{m,i}^{k,m,n}", minus, "f", "m", top_rod(), 1, guards=(lambda at: at.n - 2 - at.i,)
            ),
            PrintedTerm(
                r"\frac{2\kappa_m}{i}f_{m,i-1}^{k,m,n}",
                lambda at: 2 * at.kappa[at.m] / at.i,
                "f",
                "m",
                top_rod(),
                1,
                down,
            ),
        ),
    ),
    _roof_start("g_{m,0}", "m"),
    PrintedLine(
        18,
        r"f_{1,i}^{k,2,n+1} = -H(2n-1-i)g_{1,i}^{k,2,n+1} + \frac{2\kappa_1}{i}[g_{1,i-1}^{k,2,n+1} + "
        "H(2n-1-i)f_{1,i-1}^{k,1,n+1}]",
        "i = 2n, 2n-1, ..., 1",
        (PrintedTarget("f", "1", second, second, top=lambda at: 2 * at.n, bottom=1),),
        (
            PrintedTerm(
                "-H(2n-1-i)g_{1,i}^{k,2,n+1}", minus, "g", "1", rod(2), 0, guards=(lambda at: 2 * at.n - 1 - at.i,)
            ),
            PrintedTerm(r"\frac{2\kappa_1}{i} g_{1,i-1}^{k,2,n+1}", visits, "g", "1", rod(2), 0, down),
            PrintedTerm(
                r"\frac{2\kappa_1}{i} H(2n-1-i)f_{1,i-1}^{k,1,n+1}",
                visits,
                "f",
                "1",
                rod(1),
                0,
                down,
                (lambda at: 2 * at.n - 1 - at.i,),
            ),
        ),
    ),
    PrintedLine(
        19,
        r"f_{1,i}^{k,j,n+1} = -H(2n+j-3-i)H(n-1)g_{1,i}^{k,j,n+1} + \frac{2\kappa_1}{i}[H(n-1)g_{1,i-1}^{k,j,n+1} + "
        "f_{1,i-1}^{k,j-1,n+1}]",
        "j = 3, 4, ..., m-1; i = 2n+j-2, 2n+j-3, ..., 1",
        (PrintedTarget("f", "1", lambda m: 3, under_roof, top=lambda at: 2 * at.n + at.j - 2, bottom=1),),
        (
            PrintedTerm(
                "-H(2n+j-3-i)H(n-1)g_{1,i}^{k,j,n+1}",
                minus,
                "g",
                "1",
                this_rod(),
                0,
                guards=(lambda at: 2 * at.n + at.j - 3 - at.i, n_1),
            ),
            PrintedTerm(
                r"\frac{2\kappa_1}{i} H(n-1)g_{1,i-1}^{k,j,n+1}", visits, "g", "1", this_rod(), 0, down, (n_1,)
            ),
            PrintedTerm(r"\frac{2\kappa_1}{i} f_{1,i-1}^{k,j-1,n+1}", visits, "f", "1", this_rod(-1), 0, down),
        ),
    ),
    PrintedLine(
        20,
        r"f_{1,i}^{k,m,n+1} = -H(2n+m-4-i)H(n-1)g_{1,i}^{k,m,n+1} + "
        r"\frac{2\kappa_1}{i}[H(2n+m-3-i)H(n-1)g_{1,i-1}^{k,m,n+1} + f_{1,i-1}^{k,m-1,n+1}]",
        "i = 2n+m-2, 2n+m-3, ..., 1",
        (PrintedTarget("f", "1", roof, roof, top=lambda at: 2 * at.n + at.m - 2, bottom=1),),
        (
            PrintedTerm(
                "-H(2n+m-4-i)H(n-1)g_{1,i}^{k,m,n+1}",
                minus,
                "g",
                "1",
                top_rod(),
                0,
                guards=(lambda at: 2 * at.n + at.m - 4 - at.i, n_1),
            ),
            PrintedTerm(
                r"\frac{2\kappa_1}{i} H(2n+m-3-i)H(n-1)g_{1,i-1}^{k,m,n+1}",
                visits,
                "g",
                "1",
                top_rod(),
                0,
                down,
                (lambda at: 2 * at.n + at.m - 3 - at.i, n_1),
            ),
            PrintedTerm(r"\frac{2\kappa_1}{i} f_{1,i-1}^{k,m-1,n+1}", visits, "f", "1", top_rod(-1), 0, down),
        ),
    ),
    PrintedLine(
        21,
        r"f_{m,i}^{k,j,n+1} = \frac{1}{2\kappa_1 - \kappa_m} [-(i+1)H(n-m+j-2-i)(f_{m,i+1}^{k,j,n+1} + "
        r"g_{m,i+1}^{k,j,n+1}) + \kappa_m g_{m,i}^{k,j,n+1} + 2\kappa_1 H(n-m+j-2-i)f_{m,i}^{k,j-1,n+1}]",
        "j = 2, 3, ..., m; i = n-m+j-1, n-m+j-2, ..., 0",
        (PrintedTarget("f", "m", second, roof, top=lambda at: at.n - at.m + at.j - 1),),
        (
            *(
                PrintedTerm(
                    rf"-\frac{{i+1}}{{2\kappa_1 - \kappa_m}} H(n-m+j-2-i){letter}_{{m,i+1}}^{{k,j,n+1}}",
                    lambda at: -(at.i + 1) / at.gap,
                    letter,
                    "m",
                    this_rod(),
                    0,
                    up,
                    (lambda at: at.n - at.m + at.j - 2 - at.i,),
                )
                for letter in "fg"
            ),
            PrintedTerm(
                r"\frac{\kappa_m}{2\kappa_1 - \kappa_m} g_{m,i}^{k,j,n+1}",
                lambda at: at.kappa[at.m] / at.gap,
                "g",
                "m",
                this_rod(),
                0,
            ),
            PrintedTerm(
                r"\frac{2\kappa_1}{2\kappa_1 - \kappa_m} H(n-m+j-2-i)f_{m,i}^{k,j-1,n+1}",
                lambda at: 2 * at.kappa[1] / at.gap,
                "f",
                "m",
                this_rod(-1),
                0,
                guards=(lambda at: at.n - at.m + at.j - 2 - at.i,),
            ),
        ),
    ),
    _floor_start("f_{1,0}", "1", 0),
)


def _corrected(line: PrintedLine, note: str) -> Correction:
    return Correction("misprint", line.printed, line, note)


CORRECTIONS: dict[int, Correction] = {
    5: _corrected(_roof_constant("0"), "The index 0 is missing: the derivative of the linear part is meant."),
    6: _corrected(_right_constant("g"), "Letter: f for g; f_0^{k,j,n+1} stands in the bracket already, by III.9."),
    12: _corrected(
        _left_power(0, (n_2,)),
        "Index: j+1 for j in what returns from floor j. H lets in g of the first interval, as in III.13.",
    ),
    13: Correction(
        "convention",
        "as printed, with 0 for the coefficients of g in the first interval: H(n-2) g_{1,i}^{k,m,n}",
        _next_to_roof((n_2,)),
        "For n = 1 and m >= 4 H lets in g of the first interval, which has none; the text says that it is 0.",
    ),
    14: _corrected(_roof_power("i+1", up), "Index: i+n for i+1."),
    17: _corrected(
        _roof_start("g", "c"), "As printed the coefficient stands on both sides; the constant of the rate 0 is meant."
    ),
    22: _corrected(
        _floor_start("f", "c", 1),
        "As printed the coefficient stands on both sides; the constant of the rate 0 is meant. H opens one interval "
        "too early, where f_{m,0} does not exist yet.",
    ),
}

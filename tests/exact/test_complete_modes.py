"""All modes of chains with dashpots: those at 0, of polynomials, of equal branches, and below where some meet."""

from __future__ import annotations

from fractions import Fraction
from math import exp, hypot, log, pi
from typing import Any

import mpmath
import numpy as np
import pytest

import wavesym
from wavesym.cli import main
from wavesym.exact.modes import damped_spectrum
from wavesym.exact.modes.equal_branches import Part, take_apart
from wavesym.exact.modes.turns import Circles
from wavesym.mechanics.network import Network
from wavesym.scene import Scene, lower

G = {"mass": 2, "dashpot": "1/20", "name": "g"}
TWIG = [{"rod": 1, "impedance": "1/2"}, {"mass": 1, "dashpot": "1/100"}]


def scene(parts: list[Any], branches: list[list[Any]] | None = None, ratio: int = 1) -> Scene:
    branch = [{"from": "g", "name": f"b{k}", "ratio": ratio, "parts": each} for k, each in enumerate(branches or [])]
    system = {"type": "chain", "parts": parts, "branch": branch}
    return Scene(name="s", system=system, output={"until": 1, "velocity": ["0-"]})


def zeros(found: wavesym.Modes) -> int:
    """Of the determinant, that its modes are."""
    return sum(1 if mode.damping >= 1 else 2 for mode in found)


SHIFTED: list[tuple[list[Any], list[float]]] = [
    ([{"mass": 1}, {"rod": 1}, {"mass": 2, "dashpot": "1/3"}], [1.0]),
    ([{"mass": 1, "dashpot": 2}], [1.0]),
    (["free", {"rod": 1}, "absorbing"], [1.0]),
    ([{"mass": 1}, {"rod": 1}, "absorbing"], [1.0]),
    (["free", {"rod": 1}, {"mass": 1}, {"dashpot": 1}, {"mass": 1}], [0.0, 1.0]),
    ([{"mass": 1}, {"dashpot": 1}, {"mass": 1}, {"dashpot": 1}, {"rod": 1}, "free"], [0.0, 1.0, 1.0]),
    ([{"mass": 1}, {"spring": 2, "dashpot": 1}, {"mass": 1}], [0.0]),
    (["fixed", {"dashpot": 1}, {"mass": 1}, {"spring": 2}, {"mass": 1}, {"dashpot": 3}, {"mass": 5}], [1.0, 1.0]),
    (["fixed", {"rod": 1}, {"mass": 1, "dashpot": 1}], []),
]


@pytest.mark.parametrize(("parts", "ratios"), SHIFTED)
def test_shifts_that_stay_are_the_zeros_at_0(parts: list[Any], ratios: list[float]) -> None:
    """As often as the power series of the determinant begins with zeros, of which rigid motion is two."""
    made = scene(parts)
    found = wavesym.modes(made, 6)
    assert [mode.damping for mode in found if mode.omega == 0] == ratios
    assert sum(1 if ratio else 2 for ratio in ratios) == Circles(lower(made).network)._at_rest
    assert found.complete
    assert any("a shift stays" in note for note in found.notes) == (1.0 in ratios)


WIDE: list[tuple[list[list[float]], list[list[float]], list[float], list[Any]]] = [
    (
        [[2, -1], [-1, 1]],
        [[1e6, 0], [0, 0]],
        [1, 1],
        ["fixed", {"spring": 1}, {"mass": 1, "dashpot": 1000000}, {"spring": 1}, {"mass": 1}],
    ),
    (
        [[1e6 + 1, -1, 0], [-1, 1 + 1e-6, -1e-6], [0, -1e-6, 1e-6]],
        [[1 + 1e-6, -1e-6, 0], [-1e-6, 2e-6, -1e-6], [0, -1e-6, 1e-6]],
        [1e-6, 1e6, 1],
        [
            "fixed",
            {"spring": 1000000, "dashpot": 1},
            {"mass": "1/1000000"},
            {"spring": 1, "dashpot": "1/1000000"},
            {"mass": 1000000},
            {"spring": "1/1000000", "dashpot": "1/1000000"},
            {"mass": 1},
        ],
    ),
]


@pytest.mark.parametrize(("stiffness", "damping", "masses", "parts"), WIDE)
def test_without_rods_none_is_missed_however_slow(
    stiffness: list[list[float]], damping: list[list[float]], masses: list[float], parts: list[Any]
) -> None:
    """Eigenvalues with 60 digits; doubles of a search had lost the slowest beside one 10^12 times as fast."""
    found = wavesym.modes(scene(parts), 6)
    with mpmath.workdps(60):
        n, matrix = len(masses), mpmath.zeros(2 * len(masses))
        for i in range(n):
            matrix[i, n + i] = 1
            for j in range(n):
                exact = [mpmath.mpf(repr(each)) for each in (stiffness[i][j], damping[i][j], masses[i])]
                matrix[n + i, j], matrix[n + i, n + j] = -exact[0] / exact[2], -exact[1] / exact[2]
        roots = [s for s in mpmath.eig(matrix, left=False, right=False) if s.imag > -1e-30]
        expected = sorted((float(abs(s)), float(-s.real / abs(s))) for s in roots)
    assert [mode.omega for mode in found] == pytest.approx([size for size, _ in expected], rel=1e-9)
    assert [mode.damping for mode in found] == pytest.approx([ratio for _, ratio in expected], rel=1e-6)
    assert found.complete


TINY = {"mass": "1/500000000"}
ARM = [{"spring": 100000}, TINY, {"dashpot": "1/10000"}, {"mass": 3, "spring": 20000000}]
FEET: list[tuple[list[Any], int]] = [
    (["fixed", {"spring": 2000}, TINY | {"name": "g"}, {"spring": 1}, {"mass": 1, "dashpot": 10**8}], 8),
    (["fixed", {"spring": 2000}, TINY | {"name": "g"}, {"spring": 10**5, "dashpot": "1/50"}, {"mass": "3/1000000"}], 7),
]


@pytest.mark.parametrize(("foot", "count"), FEET)
def test_branches_equal_but_for_their_ratios_leave_no_root_out(foot: list[Any], count: int) -> None:
    """Eigenvalues with 90 digits; of two that are one in doubles one had no shape, and one mode of all was told."""
    arms = [{"from": "g", "name": f"b{k}", "ratio": ratio, "parts": ARM} for k, ratio in enumerate((1, -2))]
    tip = [{"spring": "1/500"}, TINY]
    made = Scene(
        name="s",
        system={"type": "chain", "parts": [*foot, *tip], "branch": arms},
        output={"until": 1, "velocity": ["0-"]},
    )
    found = wavesym.modes(made, 20)
    parts = [(None, 0, 1, foot[1]), (0, 1, 1, foot[3]), (1, 2, 1, tip[0])]
    bodies = [foot[2], foot[4], tip[1]]
    for ratio in (1, -2):
        here = len(bodies)
        parts += [(0, here, ratio, ARM[0]), (here, here + 1, 1, ARM[2])]
        bodies += [ARM[1], ARM[3]]
    parts += [(None, k, 1, body) for k, body in enumerate(bodies)]
    with mpmath.workdps(90):
        n = len(bodies)
        fractions = [Fraction(body["mass"]) for body in bodies]
        masses = [mpmath.mpf(mass.numerator) / mass.denominator for mass in fractions]
        matrix = mpmath.zeros(2 * n)
        for near, far, ratio, part in parts:
            for shift, key in ((0, "spring"), (n, "dashpot")):
                size = Fraction(part.get(key, 0))
                moved = {far: 1} if near is None else {near: -ratio, far: 1}
                for i, a in moved.items():
                    for j, b in moved.items():
                        matrix[n + i, shift + j] -= mpmath.mpf(a * b * size.numerator) / size.denominator / masses[i]
        for k in range(n):
            matrix[k, n + k] = 1
        roots = [s for s in mpmath.eig(matrix, left=False, right=False) if s.imag > -1e-30 * abs(s)]
        expected = sorted((float(abs(s)), float(-s.real / abs(s))) for s in roots)
    assert (len(found), found.complete) == (count, True)
    assert [mode.omega for mode in found] == pytest.approx([size for size, _ in expected], rel=1e-15)
    assert [mode.damping for mode in found] == pytest.approx([ratio for _, ratio in expected], rel=1e-12)


def test_critical_damping_is_one_mode_twice() -> None:
    """(s + 1)^2, and of two such bodies tied by a dashpot (s + 1)^2 (s^2 + 4 s + 1): they were refused."""
    one = {"mass": 1, "spring": 1, "dashpot": 2}
    alone = wavesym.modes(scene([one]), 6)
    assert [(mode.omega, mode.damping) for mode in alone] == [(1.0, 1.0)] * 2
    (note,) = alone.notes
    assert note.startswith("modes 1, 2 are one shape")
    both = wavesym.modes(scene([one, {"dashpot": 1}, one]), 6)
    assert [mode.omega for mode in both] == pytest.approx([2 - 3**0.5, 1, 1, 2 + 3**0.5], rel=1e-15)
    assert [list(mode.shape.values()) for mode in both] == [[1, -1] if k in (0, 3) else [1, 1] for k in range(4)]


def test_critical_damping_by_what_absorbs_is_one_mode_twice() -> None:
    """(s + 1)^2 of a body before two rods of one impedance: ends move as exp(-s T) = exp(T), and modes ended there."""
    parts = ["absorbing", {"rod": 3, "impedance": "1/2", "speed": 2}, {"joint": True, "name": "a"}]
    parts += [{"rod": 1, "impedance": "1/2"}, {"mass": 1, "spring": 1, "dashpot": "3/2", "name": "m"}]
    found = wavesym.modes(scene(parts), 6)
    assert ([(mode.omega, mode.damping) for mode in found], found.complete) == ([(1.0, 1.0)] * 2, True)
    for mode in found:
        moved = list(mode.shape.values())
        assert [each / moved[-1] for each in moved] == pytest.approx([exp(2.5), exp(1), 1], rel=1e-14)


def test_equal_bodies_without_rods_have_shapes_of_their_own() -> None:
    """Three equal oscillators on one body: two modes (s^2 + s/10 + 1), in which it rests."""
    arm = [{"spring": 1, "dashpot": "1/10"}, {"mass": 1}]
    found = wavesym.modes(scene(["fixed", {"spring": 3}, G], [arm] * 3), 9)
    assert zeros(found) == 8
    same = [mode for mode in found if abs(mode.omega - 1) < 1e-12]
    assert [mode.damping for mode in same] == pytest.approx([0.05] * 2, rel=1e-14)
    shapes = np.array([list(mode.shape.values()) for mode in same])
    assert np.linalg.matrix_rank(shapes) == 2
    assert not np.abs(shapes.sum(axis=1)).max() > 1e-12


def test_equal_branches_with_rods_are_told_apart() -> None:
    """Two of three modes have w^2 - i w/100 = (w/2) cot w, and the body at rest; a count of the whole has no more."""
    made = scene(["fixed", {"rod": 1}, G], [TWIG] * 3, ratio=-2)
    found = wavesym.modes(made, 9)
    assert (len(found), found.complete) == (9, True)
    resting = [k for k, mode in enumerate(found) if mode.shape["g"] == 0]
    assert resting == [1, 2, 5, 6]
    w = np.array([complex(found.exact[k].frequency) for k in resting])
    assert np.abs(w**2 - 0.01j * w - w / 2 / np.tan(w)).max() < 1e-12
    for k in resting:  # at right angles, and in balance
        tips = np.array([value for name, value in found[k].shape.items() if name not in ("g", "0")])
        assert abs(tips.sum()) < 1e-12
    gap = (found[7].omega * found[8].omega) ** 0.5
    assert Circles(lower(made).network).count(gap) == zeros(found) - 2


def test_equal_branches_of_equal_branches_are_told_apart() -> None:
    """Two branches with three twigs each: twigs of one against each other, twice; all are counted in the whole."""
    twigs = [{"from": f"h{k}", "name": f"t{k}{n}", "parts": TWIG} for k in range(2) for n in range(3)]
    arms = [{"from": "g", "name": f"a{k}", "parts": [{"rod": "1/2"}, {"mass": 1, "name": f"h{k}"}]} for k in range(2)]
    system = {"type": "chain", "parts": ["fixed", {"rod": 1}, G], "branch": [*arms, *twigs]}
    made = Scene(name="s", system=system, output={"until": 1, "velocity": ["g"]})
    parts = take_apart(lower(made).network)
    assert sorted(len(part.ways) for part in parts) == [1, 1, 2, 2]
    found = wavesym.modes(made, 14)
    assert found.complete
    sizes = [mode.omega for mode in found]
    assert sum(abs(each - sizes[3]) < 1e-12 for each in sizes) == 4
    k = max(k for k in range(4, 14) if sizes[k] > sizes[k - 1] * 1.01)
    inside = sum(2 for each in sizes if each < sizes[k])
    assert Circles(lower(made).network).count((sizes[k - 1] * sizes[k]) ** 0.5) == inside


def test_below_where_frequencies_meet_modes_are_printed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    """Not taken apart, equal branches meet: those before are told, and that they are all, where all were refused."""

    def whole(network: Network) -> list[Part]:
        ways = take_apart(Network(network.points[:1], (), ()))[0].ways[0]
        every = [[[(n, ways[0][0][0][1])] for n in range(len(each))] for each in (network.points, network.bars)]
        return [Part(network, ((every[0], every[1]),))]

    made = scene(["fixed", {"rod": 1}, G], [TWIG] * 3, ratio=-2)
    every = wavesym.modes(made, 3)
    monkeypatch.setattr(damped_spectrum, "take_apart", whole)
    file = tmp_path / "s.toml"
    twig = '{ rod = 1, impedance = "1/2" }, { mass = 1, dashpot = "1/100" }'
    branches = [f'[[system.branch]]\nfrom = "g"\nname = "b{k}"\nratio = -2\nparts = [{twig}]\n' for k in range(3)]
    parts = '["fixed", { rod = 1 }, { mass = 2, dashpot = "1/20", name = "g" }]'
    file.write_text("\n".join(['name = "s"', "[system]", 'type = "chain"', f"parts = {parts}", *branches]))
    assert main(["modes", str(file)]) == 0
    said = capsys.readouterr().out
    assert "near 0.653271 rad/tau two or more meet" in said
    found = wavesym.modes(made, 10)
    assert [mode.omega for mode in found] == pytest.approx([every[0].omega], rel=1e-15)
    assert 0.212 < float(found.why.split()[5]) < 0.6532
    assert not found.complete  # it was said to be, as none is missed up to the one that is there
    assert wavesym.modes(made, 1).complete
    assert wavesym.modes(made, below=every[0].omega * 1.001).complete
    assert not wavesym.modes(made, below=1).complete


def test_a_long_list_without_rods_is_complete_where_it_has_all() -> None:
    """Of 61 bodies a polynomial is of degree 122, whose roots are sought: as many as its degree are all."""
    made = scene(["fixed", *[{"spring": 1, "dashpot": "1/9"}, {"mass": 1}] * 61])
    every = wavesym.modes(made, 99)
    assert (zeros(every), every.complete) == (122, True)


def test_rods_of_which_two_swing_as_they_like_are_told_apart() -> None:
    """Four rods that resonate at pi between nodes at rest, two with a free end: two modes, at which the list ended."""
    parts = ["free", {"rod": "1/2"}, {"joint": True, "dashpot": 5, "name": "g"}, {"rod": 1}]
    parts += [{"mass": 2, "dashpot": "1/2"}, {"rod": 1, "impedance": 7}, "fixed"]
    found = wavesym.modes(scene(parts, [[{"rod": "3/2", "impedance": 3}]]), 8)
    assert found.complete
    assert [mode.omega for mode in found if mode.damping == 0] == pytest.approx([pi, pi], rel=1e-15)


def test_rods_with_free_ends_swing_beside_a_node_at_rest() -> None:
    """Three of them, which pull at it by Z a sin w: two modes at every odd pi/2; others solve the node's equation."""
    rods = [2, 3]
    parts = ["fixed", {"rod": 1}, {"mass": 1, "dashpot": "1/2", "name": "g"}, {"rod": 1}, "free"]
    found = wavesym.modes(scene(parts, [[{"rod": 1, "impedance": z}, "free"] for z in rods]), 12)
    assert found.complete
    plain = [mode for mode in found if mode.damping == 0]
    assert [mode.omega for mode in plain] == pytest.approx([pi / 2, pi / 2, 1.5 * pi, 1.5 * pi, 2.5 * pi, 2.5 * pi])
    one, other = (np.array([mode.shape[end] for end in ("2", "b0:1", "b1:1")]) for mode in plain[:2])
    assert abs(np.dot([1, *rods], one * other)) < 1e-14  # at right angles, and with no pull
    assert np.abs([np.dot([1, *rods], each) for each in (one, other)]).max() < 1e-14
    for mode in found:
        if mode.damping:
            w = mpmath.mpc(mode.omega) * mpmath.expj(mpmath.asin(mode.damping))
            terms = [w * mpmath.cot(w), -w * w, 0.5j * w, -6 * w * mpmath.tan(w)]
            assert abs(sum(terms)) < 1e-12 * max(map(abs, terms))


@pytest.mark.parametrize("dashpot", ["1.000000001", "0.999999999", "1.000001"])
def test_a_rod_that_ends_in_nearly_its_impedance(dashpot: str) -> None:
    """exp(2 i w) = 1/r and -1/r, r what returns: a search of seconds found every second one, or none."""
    found = wavesym.modes(scene(["fixed", {"rod": 1}, {"joint": True, "dashpot": dashpot, "name": "g"}]), 10)
    assert found.complete
    r = (1 - Fraction(dashpot)) / (1 + Fraction(dashpot))
    turns = [k * pi + (pi / 2 if r > 0 else 0) for k in range(10)]
    expected = [hypot(turn, log(abs(r)) / 2) for turn in turns]
    assert [mode.omega for mode in found] == pytest.approx(expected, rel=1e-14)


def test_with_rods_the_slowest_are_known_from_the_first_powers() -> None:
    """A body of 3 10^9 and a little on a rod (a spring of 6) before a dashpot: a search of 30 s lost 1/20000."""
    parts = [
        {"mass": 1, "dashpot": 10},
        {"spring": "10/13", "dashpot": "1/1000000000"},
        {"mass": 1, "dashpot": 1000000},
    ]
    parts += [{"rod": 1, "impedance": 2, "speed": 3}, {"mass": 1000000000, "dashpot": "1/1000000000"}]
    parts += [{"rod": 2, "impedance": 1000000000, "speed": 1}, {"mass": "31/12"}]
    found = wavesym.modes(scene(parts), 4)
    assert found.complete
    s = np.roots([3e9, 6 * 3e9 / 1e6, 6])[0]  # 6 and 10^6 s in series
    assert found[1].omega == pytest.approx(abs(s), rel=1e-5)
    assert found[1].damping == pytest.approx(-s.real / abs(s), rel=1e-3)

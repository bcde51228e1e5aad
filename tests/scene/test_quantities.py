"""Quantities are exact whatever units they are written in, and whatever is none is refused at once."""

from __future__ import annotations

import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from time import process_time

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic_core import PydanticCustomError

from wavesym.fields import quantity
from wavesym.fields.dimensions import DIMENSIONS
from wavesym.fields.quantity import si_value, unit

# from the definitions: the international yard and pound of 1959, and 9.80665 m/s^2
FOOT, POUND, GRAVITY = Fraction(3048, 10000), Fraction(45359237, 10**8), Fraction(980665, 10**5)
DEGREE = 3.141592653589793 / 180


@pytest.mark.parametrize(
    ("text", "dimension", "expected"),
    [
        ("3.5 m", "length", Fraction(7, 2)),
        ("1/3 mm", "length", Fraction(1, 3000)),
        ("-2e3 um", "length", Fraction(-2, 1000)),
        ("3 \u00b5m", "length", Fraction(3, 10**6)),
        ("3 \u03bcm", "length", Fraction(3, 10**6)),
        ("10ft", "length", 10 * FOOT),
        ("0.1 in", "length", FOOT / 120),
        ("350 t", "mass", 350000),
        ("3 g", "mass", Fraction(3, 1000)),
        ("0.3 g", "acceleration", 3 * GRAVITY / 10),
        ("1 g_0", "acceleration", GRAVITY),
        ("2 g/s", "jerk", 2 * GRAVITY),
        ("3 Gal", "acceleration", Fraction(3, 100)),
        ("1 kip", "force", 1000 * POUND * GRAVITY),
        ("1 kip/ft", "stiffness", 1000 * POUND * GRAVITY / FOOT),
        ("1 ksi", "modulus", 1000 * POUND * GRAVITY / (FOOT / 12) ** 2),
        ("150 lb/ft^3", "density", 150 * POUND / FOOT**3),
        ("210 GPa", "modulus", 210 * 10**9),
        ("57680 cm^4", "second moment of area", Fraction(57680, 10**8)),
        ("4 kN*s/m", "damping constant", 4000),
        ("4 kg*m^2/s^2", "moment", 4),
        ("4 m*s^-2*kg", "force", 4),
        ("4 N*m/rad", "rotational stiffness", 4),
        ("4 N*m", "rotational stiffness", 4),
        ("0 m", "length", 0),
    ],
)
def test_what_quantities_are(text: str, dimension: str, expected: Fraction) -> None:
    assert si_value(text, dimension) == expected


@pytest.mark.parametrize("text", ["350 ton", "3 tons", "2 kton", "3 ton/m^3", "4 ton*m/s^2", "4 ton_force"])
def test_a_ton_is_two_units(text: str) -> None:
    """pint takes it for 2000 lb, an engineer most often for 1000 kg."""
    with pytest.raises(PydanticCustomError, match=r"is two units; write (t .* or short_ton|tf .* or kip)"):
        si_value(text, "mass")
    assert si_value("1 short_ton", "mass") == 2000 * POUND
    assert si_value("1 tf", "force") == 1000 * GRAVITY == si_value("1 kip", "force") / POUND


@pytest.mark.parametrize(("text", "meant"), [("3 gal", "Gal"), ("3 gals", "Gal"), ("3 mgal", "mGal")])
def test_a_gallon_is_no_acceleration(text: str, meant: str) -> None:
    with pytest.raises(PydanticCustomError, match=rf'Did you mean "{meant}"\?'):
        si_value(text, "acceleration")


def test_angles_have_pi_in_them() -> None:
    assert float(si_value("90 deg", "angle")) == pytest.approx(90 * DEGREE, rel=1e-15)
    assert float(si_value("60 rpm", "angular velocity")) == pytest.approx(360 * DEGREE, rel=1e-15)


def test_units_alone() -> None:
    assert unit("kN*m", "moment") == 1000
    assert unit("g", "acceleration") == GRAVITY
    for wrong in ("3 m", "s", "", 1, None, "m" * 101):
        with pytest.raises(PydanticCustomError):
            unit(wrong, "length")


def test_examples_of_messages_are_right() -> None:
    for name, dimension in DIMENSIONS.items():
        assert si_value(dimension.example, name) > 0


LENGTHS = {
    "m": Fraction(1),
    "km": Fraction(1000),
    "ft": FOOT,
    "yard": 3 * FOOT,
    "inch": FOOT / 12,
    "mm": Fraction(1, 1000),
}
MASSES = {"kg": Fraction(1), "t": Fraction(1000), "lb": POUND, "g": Fraction(1, 1000)}
TIMES = {"s": Fraction(1), "ms": Fraction(1, 1000), "min": Fraction(60)}
POWERS = st.integers(-3, 3).filter(bool)


@given(
    st.fractions(max_denominator=10**9, min_value=-(10**9), max_value=10**9),
    st.sampled_from(list(DIMENSIONS)),
    st.sampled_from(list(LENGTHS)),
    st.sampled_from(list(MASSES)),
    st.sampled_from(list(TIMES)),
)
def test_any_mixture_of_units_is_exact(number: Fraction, name: str, length: str, mass: str, time: str) -> None:
    dimension = DIMENSIONS[name]
    if name in ("acceleration", "jerk"):
        mass = "kg"  # no g of the other kind
    size = LENGTHS[length] ** dimension.length * MASSES[mass] ** dimension.mass * TIMES[time] ** dimension.time
    powers = ((length, dimension.length), (mass, dimension.mass), (time, dimension.time), ("rad", dimension.angle or 0))
    text = "*".join(f"{unit}^{power}" for unit, power in powers if power)
    assert si_value(f"{number} {text}", name) == number * size


@pytest.mark.parametrize(
    ("value", "dimension", "expected"),
    [
        ("3 kg", "length", '"3 kg" is a mass, not a length; write one such as "3.5 m"'),
        ("3 m/s^5", "length", '"3 m/s^5" is m*s^-5, not a length; write one such as "3.5 m"'),
        ("1.2", "length", '"1.2" is not a length; write one such as "3.5 m"'),
        ("1e5", "length", '"1e5" is not a length; write one such as "3.5 m"'),
        ("3 m/m", "length", '"3 m/m" is a plain number, not a length; write one such as "3.5 m"'),
        ("3 Hz", "angular velocity", '"3 Hz" is a frequency, not an angular velocity; write one such as "1500 rpm"'),
        ("3 g", "length", '"3 g" is a mass, not a length; write one such as "3.5 m"'),
        (3, "length", '3 is not a length; write one such as "3.5 m"'),
        (3.5, "force", '3.5 is not a force; write one such as "12 kN"'),
        ("3", "length", '"3" is not a length'),
        (True, "area", 'true is not an area; write one such as "8 cm^2"'),
        (None, "time", "not a time; write one such as"),
        ([], "time", 'a list is not a time; write one such as "20 ms"'),
        ({}, "time", 'a table is not a time; write one such as "20 ms"'),
        ("nan m", "length", '"nan m" is not a length; write one such as "3.5 m"'),
        ("inf m", "length", '"inf m" is not a length; write one such as "3.5 m"'),
        ("1e400 m", "length", "write an exponent from -300 to 300"),
        ("1e999999999 m", "length", "write an exponent from -300 to 300"),
        ("1e300 km", "length", "write 0 or a size from 1e-300 to 1e300 in SI base units"),
        ("1/0 m", "length", "write another denominator"),
        ("3 m**999999999", "length", "powers up to ^9"),
        ("3 m^999999999", "length", "powers up to ^9"),
        ("3 m^0", "length", "powers up to ^9"),
        ("3 m^0.5", "length", "powers up to ^9"),
        ("3 N m", "moment", "joined by * and /"),
        ("3 kNm", "moment", 'not a moment; write one such as "15 kN*m". Did you mean "kN*m"?'),
        ("3 Nm/rad", "rotational stiffness", '. Did you mean "N*m/rad"?'),
        ("3 Nm", "length", 'not a length; write one such as "3.5 m"'),
        ("3 (m)", "length", "joined by * and /"),
        ("3 1/s", "jerk", "not a jerk; write one such as"),
        ("3 m\n", "length", "3 m"),
        (" 3 m", "length", "a length"),
        ("3  m", "length", "3  m"),
        ("\u0663 m", "length", "a length"),  # the Arabic digit 3
        ("3 \uff4d", "length", "is not a"),  # a full-width m
        ("3 m\u00b2", "area", "is not a"),  # a superscript 2
        ("3 \u212b", "length", "is not a"),  # the Angstrom sign
        (
            "3 cm4",
            "length",
            '"cm4" is not a known unit; write a length in m, mm, cm or km. Did you mean "cm^4"?',
        ),
        ("3 KN", "force", '"KN" is not a known unit; write a force in N, kN, MN or GN. Did you mean "kN"?'),
        ("4.2 mtr", "length", '"4.2 mtr": "mtr" is not a known unit; write a length in m, mm, cm or km'),
        ("4.2 mtr/s", "velocity", '"mtr" is not a known unit; write a velocity in m/s'),
        ("4,2 m", "length", '"4,2 m" has a comma; write a decimal point, as in "4.2 m"'),
        ("4,2", "length", '"4,2" has a comma; write a decimal point, as in "3.5 m"'),
        ("1,234,567 m", "length", '"1,234,567 m" has a comma; write a decimal point, as in "3.5 m"'),
        ("3 Mpa", "modulus", 'Did you mean "MPa"?'),
        ("3 dB", "angle", '"dB" is not a known unit'),
        ("3 degC", "angle", '"degC" is not a known unit'),
        ("3 percent", "angle", '"percent" is not a known unit'),
        ("3 A", "force", '"A" is not a known unit'),
        ("3 dimensionless", "length", '"dimensionless" is not a known unit'),  # pint knows these, and stumbles
        ("3 mins", "time", '"mins" is not a known unit'),
        ("3 decibels", "angle", '"decibels" is not a known unit'),
        ("3 __import__('os')", "length", "is not a quantity"),
        ("3 __class__", "length", "is not a quantity"),
        ("3 m" + "*m" * 40, "length", "at most 12"),
        ("3 " + "m" * 10**6, "length", "at most 100 characters"),
        ("9" * 10**6 + " m", "length", "at most 100 characters"),
    ],
)
def test_what_is_no_quantity(value: object, dimension: str, expected: str) -> None:
    si_value("1 m", "length")  # so that pint is there
    start = process_time()
    with pytest.raises(PydanticCustomError) as refused:
        si_value(value, dimension)
    assert process_time() - start < 1
    line = str(refused.value)
    assert expected in line
    assert line.isascii()
    assert "\n" not in line
    assert len(line) < 240


@given(st.text(alphabet="0123456789./eE+-*^ mskgNrad()_\u00b5\u0663", max_size=30), st.sampled_from(list(DIMENSIONS)))
def test_text_is_a_quantity_or_refused_in_a_line(text: str, dimension: str) -> None:
    try:
        line = str(si_value(text, dimension))
    except PydanticCustomError as refused:
        line = str(refused)
    assert line.isascii()
    assert line.isprintable()


def test_pint_waits_for_the_first_unit() -> None:
    code = "import wavesym.fields.quantity, sys; assert 'pint' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_usual_units_mean_what_pint_says() -> None:
    for name, meaning in quantity._USUAL.items():
        assert quantity._unit_of_pint(name) == meaning, name


@pytest.mark.slow
def test_modes_of_a_frame_in_usual_units_do_not_wait_for_pint() -> None:
    """Half a second of a command that takes less."""
    scene = Path(__file__).parents[2] / "examples" / "frames" / "concrete.toml"
    script = f"import sys; from wavesym import Scene, modes; modes(Scene.from_toml({str(scene)!r}), 10)"
    script += "; sys.exit('pint' in sys.modules)"
    subprocess.run([sys.executable, "-c", script], check=True)

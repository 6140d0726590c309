"""The functions of computed signals, by geometry and by the sentences of docs/bindings.md."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from fretc.logs.signals.measures import NameValues, number
from fretish import expressions as e
from fretish.bindings.functions import ROUNDED
from monitors.kernel.readings import Single, exact
from monitors.rounded_functions import ROUNDED_FUNCTIONS, rounded

INF, NAN, PI = math.inf, math.nan, math.pi
HALF = math.sqrt(0.5)

VALUES: Sequence[tuple[str, tuple[float, ...], float]] = (
    ("sqrt", (2.25,), 1.5),
    ("sqrt", (-1e-300,), NAN),
    ("sqrt", (INF,), INF),
    ("hypot", (3.0, -4.0), 5.0),
    ("hypot", (INF, 1.0), INF),
    ("hypot", (1e200, 0.0), INF),
    ("norm", (-7.0,), 7.0),
    ("norm", (2.0, 3.0, 6.0), 7.0),
    ("sign", (-0.001,), -1.0),
    ("sign", (0.0,), 0.0),
    ("sign", (INF,), 1.0),
    ("floor", (-1.5,), -2.0),
    ("ceil", (-1.5,), -1.0),
    ("ceil", (1e300,), 1e300),
    ("floor", (-INF,), -INF),
    ("exp", (0.0,), 1.0),
    ("exp", (1000.0,), INF),
    ("exp", (-INF,), 0.0),
    ("log", (1.0,), 0.0),
    ("log", (0.0,), NAN),
    ("log", (-1.0,), NAN),
    ("log", (INF,), INF),
    ("sin", (0.0,), 0.0),
    ("sin", (INF,), NAN),
    ("cos", (0.0,), 1.0),
    ("cos", (-INF,), NAN),
    ("tan", (0.0,), 0.0),
    ("tan", (INF,), NAN),
    ("asin", (1.0,), PI / 2),
    ("asin", (1.0000001,), NAN),
    ("acos", (1.0,), 0.0),
    ("acos", (-1.1,), NAN),
    ("atan", (INF,), PI / 2),
    ("atan2", (1.0, -1.0), 3 * PI / 4),
    ("atan2", (0.0, -1.0), PI),
    ("wrap_angle", (0.5,), 0.5),
    ("wrap_angle", (3 * PI / 2,), -PI / 2),
    ("wrap_angle", (PI,), PI),
    ("wrap_angle", (-PI,), PI),
    ("wrap_angle", (INF,), NAN),
    ("yaw", (0.0, 0.0, HALF, HALF), PI / 2),
    ("yaw", (0.0, 0.0, 0.0, 0.0), NAN),
    ("yaw", (0.0, 0.0, INF, 1.0), NAN),
    ("pitch", (0.0, HALF, 0.0, HALF), PI / 2),
    ("pitch", (0.0, 0.0, 0.0, 0.0), NAN),
    ("roll", (2 * HALF, 0.0, 0.0, 2 * HALF), PI / 2),
    ("roll", (0.0, 0.0, 0.0, 0.0), NAN),
    ("angle_between", (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 3.0, 0.0), PI),
    ("angle_between", (0.0, 0.0, HALF, HALF, 0.0, 0.0, -HALF, -HALF), 0.0),
    ("angle_between", (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0), NAN),
    ("angle_between", (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0), NAN),
    ("haversine", (0.0, 0.0, 0.0, PI), PI * 6371008.8),
    ("haversine", (PI / 2, 1.0, -PI / 2, 2.0), PI * 6371008.8),
    ("haversine", (0.3, 0.4, 0.3, 0.4), 0.0),
    ("haversine", (INF, 0.0, 0.0, 0.0), NAN),
)


@pytest.mark.parametrize(("name", "args", "value"), VALUES)
def test_values_are_those_of_geometry(name: str, args: tuple[float, ...], value: float) -> None:
    got = ROUNDED_FUNCTIONS[name](*args)
    assert got == pytest.approx(value, rel=1e-15, abs=1e-16, nan_ok=True)
    assert type(got) is float


def test_each_function_of_the_bindings_has_a_value() -> None:
    assert ROUNDED_FUNCTIONS.keys() == ROUNDED.keys() == {name for name, _, _ in VALUES}


@pytest.mark.parametrize("name", ROUNDED)
def test_an_unknown_argument_makes_every_function_unknown(name: str) -> None:
    count = ROUNDED[name].least
    for place in range(count):
        args: list[float | None] = [0.5] * count
        assert rounded(name, *args) is not None
        args[place] = None
        assert rounded(name, *args) is None, place
        args[place] = INF
        for other in range(count):
            if other != place:
                assert (
                    rounded(name, *(None if i == other else args[i] for i in range(count))) is None
                )


def test_readings_of_every_kind_are_arguments() -> None:
    assert rounded("hypot", Single(3.0), exact("4")) == 5.0
    assert rounded("norm", 2**60) == 2.0**60
    assert rounded("sqrt", -1.0) is None


numbers = st.floats(-1e3, 1e3)
any_number = st.floats()


@given(st.data(), st.sampled_from([*ROUNDED]))
def test_no_number_is_an_error(data: st.DataObject, name: str) -> None:
    args = [data.draw(any_number) for _ in range(ROUNDED[name].least)]
    value = ROUNDED_FUNCTIONS[name](*args)
    assert isinstance(value, float)
    if any(map(math.isnan, args)):
        assert math.isnan(value)


@given(st.data(), st.sampled_from([*ROUNDED]))
def test_an_audit_computes_the_same_to_the_last_bit(data: st.DataObject, name: str) -> None:
    names = [f"n{i}" for i in range(ROUNDED[name].least)]
    rows = data.draw(st.lists(st.tuples(*[any_number] * len(names)), min_size=1, max_size=5))
    columns = {each: np.array([row[i] for row in rows]) for i, each in enumerate(names)}
    tree = e.Call(name, tuple(map(e.Name, names)))
    found = number(tree, NameValues(len(rows), columns))
    expected = np.array([ROUNDED_FUNCTIONS[name](*row) for row in rows])
    known = ~np.isnan(expected)
    assert (np.isnan(found) == ~known).all()
    assert (found[known] == expected[known]).all()


def turning(x: float, y: float, z: float, w: float) -> NDArray[Any]:
    """The rotation matrix of a quaternion: the images of the axes, by q v q*."""

    def product(p: NDArray[Any], q: NDArray[Any]) -> NDArray[Any]:
        scalar = p[3] * q[3] - p[:3] @ q[:3]
        return np.append(p[3] * q[:3] + q[3] * p[:3] + np.cross(p[:3], q[:3]), scalar)

    q = np.array([x, y, z, w]) / math.sqrt(x * x + y * y + z * z + w * w)
    back = q * [-1, -1, -1, 1]
    return np.array([product(product(q, np.append(axis, 0)), back)[:3] for axis in np.eye(3)]).T


quaternions = st.tuples(*[st.floats(-2, 2)] * 4)


@given(quaternions)
def test_yaw_pitch_and_roll_are_the_turns_about_z_y_and_x(q: tuple[float, ...]) -> None:
    assume(sum(part * part for part in q) > 1e-3)
    yaw, pitch, roll = (ROUNDED_FUNCTIONS[name](*q) for name in ("yaw", "pitch", "roll"))
    assume(abs(pitch) < 1.4)
    about_z = np.array(
        [[math.cos(yaw), -math.sin(yaw), 0], [math.sin(yaw), math.cos(yaw), 0], [0, 0, 1]]
    )
    about_y = np.array(
        [[math.cos(pitch), 0, math.sin(pitch)], [0, 1, 0], [-math.sin(pitch), 0, math.cos(pitch)]]
    )
    about_x = np.array(
        [[1, 0, 0], [0, math.cos(roll), -math.sin(roll)], [0, math.sin(roll), math.cos(roll)]]
    )
    np.testing.assert_allclose(about_z @ about_y @ about_x, turning(*q), atol=1e-9)


@given(quaternions, quaternions)
def test_the_angle_between_two_rotations_is_that_of_their_quotient(
    p: tuple[float, ...], q: tuple[float, ...]
) -> None:
    assume(min(sum(part * part for part in each) for each in (p, q)) > 1e-3)
    angle = ROUNDED_FUNCTIONS["angle_between"](*p, *q)
    quotient = turning(*p).T @ turning(*q)
    assert math.cos(angle) == pytest.approx((np.trace(quotient) - 1) / 2, abs=1e-9)
    assert 0 <= angle <= PI


@given(*[st.floats(-1.57, 1.57), st.floats(-7, 7)] * 2)
def test_haversine_is_the_angle_between_two_directions_from_the_centre(
    lat1: float, lon1: float, lat2: float, lon2: float
) -> None:
    one, other = (
        np.array([math.cos(a) * math.cos(b), math.cos(a) * math.sin(b), math.sin(a)])
        for a, b in ((lat1, lon1), (lat2, lon2))
    )
    angle = math.atan2(float(np.linalg.norm(np.cross(one, other))), float(one @ other))
    distance = ROUNDED_FUNCTIONS["haversine"](lat1, lon1, lat2, lon2)
    assert distance == pytest.approx(6371008.8 * angle, rel=1e-9, abs=0.1)


@given(numbers)
def test_a_wrapped_angle_has_the_same_direction(angle: float) -> None:
    wrapped = ROUNDED_FUNCTIONS["wrap_angle"](angle)
    assert -PI < wrapped <= PI
    assert math.cos(wrapped - angle) == pytest.approx(1, abs=1e-9)


@given(st.lists(numbers, min_size=1, max_size=4))
def test_a_norm_is_the_root_of_the_squares_from_left_to_right(args: list[float]) -> None:
    total = 0.0
    for each in args:
        total = total + each * each
    assert ROUNDED_FUNCTIONS["norm"](*args) == float(np.sqrt(np.float64(total)))

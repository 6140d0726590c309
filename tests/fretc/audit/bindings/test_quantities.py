"""The table of well-known fields, against the definitions themselves."""

from typing import Any

import pytest
from rosbags.typesys import Stores, get_typestore

from fretc.audit.bindings.quantities import QUANTITIES, NumberField
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.source import Source
from fretish.units import unit

ROS1, ROS2 = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_JAZZY)
_NUMBERS = {
    "bool", "float32", "float64", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32",
    "uint64",
}  # fmt: skip
QUANTITIES_OF_TYPES = [
    (store, type_, quantity)
    for type_, quantities in QUANTITIES.items()
    for quantity in quantities
    for store in (ROS1, ROS2)
    if type_.replace("/", "/msg/") in store.fielddefs
]


def kind(store: Any, name: str, fields: list[str]) -> tuple[str, bool]:
    """The primitive type at the end of the path, and whether it is an array."""
    for node, detail in (dict(store.fielddefs[name][1])[fields[0]],):
        if len(fields) > 1:
            return kind(store, detail, fields[1:])
        if node.name in ("ARRAY", "SEQUENCE"):
            return detail[0][1][0], True
        return detail[0], False
    raise AssertionError


def test_most_types_are_in_the_stores_that_they_are_checked_with() -> None:
    checked = {type_ for _, type_, _ in QUANTITIES_OF_TYPES}
    assert set(QUANTITIES) - checked <= {
        "ackermann_msgs/AckermannDrive",
        "ackermann_msgs/AckermannDriveStamped",
    }


@pytest.mark.parametrize(("store", "type_", "quantity"), QUANTITIES_OF_TYPES)
def test_each_field_is_one_of_the_type(store: Any, type_: str, quantity: NumberField) -> None:
    field = quantity.field.removesuffix("[:]")
    kind_of_field, many = kind(store, type_.replace("/", "/msg/"), field.split("."))
    is_text = type_ == "std_msgs/String"
    assert kind_of_field == "string" if is_text else kind_of_field in _NUMBERS
    assert many == quantity.field.endswith("[:]") == bool(quantity.reduce)
    assert (kind_of_field == "bool") == (type_ == "std_msgs/Bool")


@pytest.mark.parametrize("type_", QUANTITIES)
def test_units_are_known_and_names_differ(type_: str) -> None:
    names = [quantity.name for quantity in QUANTITIES[type_]]
    assert len(set(names)) == len(names)
    assert all(unit(quantity.unit or "1") is not None for quantity in QUANTITIES[type_])


@pytest.mark.parametrize("type_", ["sensor_msgs/LaserScan", "sensor_msgs/Range"])
def test_readings_out_of_range_are_what_rep_117_says(type_: str) -> None:
    (quantity,) = QUANTITIES[type_]
    reduce = f'reduce = "{quantity.reduce}"\n' if quantity.reduce else ""
    text = (
        f'[clock]\ntick = "1 s"\n[signal.x]\npath = "/x.{quantity.field}"\n{reduce}'
        f'valid = "{quantity.valid}"\ninvalid = {quantity.invalid}\n'
    )
    declarations, diagnostics = read_bindings(Source("b.toml", text))
    assert declarations is not None, diagnostics
    invalid = declarations.signals["x"].invalid
    assert (invalid.nan, invalid.positive_infinity) == ("drop", "far")
    assert (invalid.negative_infinity, invalid.other) == ("near", "drop")

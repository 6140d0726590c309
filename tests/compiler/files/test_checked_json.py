import pytest

from compiler.files.checked_json import JsonValue, SchemaError


def test_a_path_grows_with_every_look() -> None:
    whole = JsonValue({"results": [{"hashes": {"log": "ab"}}]})
    (result,) = whole.field("results").items()
    assert result.path == "results[0]"
    assert result.field("hashes").fields()["log"].path == 'results[0].hashes["log"]'


def test_what_stands_there_instead_is_shown_shortened() -> None:
    with pytest.raises(SchemaError) as caught:
        JsonValue("x" * 100, "reason").count()
    assert str(caught.value) == f"`reason` must be a whole number, and is `{'x' * 40}…`"


def test_true_is_no_number() -> None:
    with pytest.raises(SchemaError, match="must be a number, and is true"):
        JsonValue(True, "a").number()


def test_a_number_must_be_finite() -> None:
    with pytest.raises(SchemaError, match="must be a finite number"):
        JsonValue(float("inf"), "a").number()


def test_the_root_is_called_the_whole_file() -> None:
    with pytest.raises(SchemaError, match="the whole file must be an object, and is an array"):
        JsonValue([]).field("schema")

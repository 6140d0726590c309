"""`bindings.toml`: what each field means, and where each field's mistake is reported."""

from fractions import Fraction

import pytest

from fretish import expressions as e
from fretish.bindings.declarations import (
    REP_117,
    Aggregate,
    Declarations,
    InvalidReadings,
    Modality,
    Path,
    Reading,
    Reduce,
    Role,
    path,
)
from fretish.bindings.tables.reader import read_bindings
from fretish.clock import Clock, End, Rounding, TimeSource
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source

GOOD = """\
[clock]
time = "log_time"
tick = "100 ms"
end  = "inconclusive"

[signal.min_range]
path    = "/scan.ranges[:]"
type    = "sensor_msgs/LaserScan"
reduce  = "min"
unit    = "m"
valid   = "range_min <= x and x <= range_max"
invalid = { nan = "drop", "+inf" = "far", "-inf" = "near", other = "drop", empty = "unknown" }
max_age = "300 ms"

[signal.vx]
path = "/odom.twist.twist.linear.x"
unit = "m/s"

[proposition.too_close]
text = "an obstacle is nearer than 5 cm"
expr = "min_range < 5 cm"
role = "input"
agg  = "any"
on_unknown = "unknown"

[proposition.stopped]
expr = "abs(vx) < 0.01 m/s for 200 ms"
role = "output"
kind = "physical"
"""


def read(text: str) -> Declarations:
    found, wrong = read_bindings(Source("bindings.toml", text))
    assert wrong == ()
    assert found is not None
    return found


def mistakes(text: str) -> list[tuple[str, str]]:
    """`F303 bindings.toml:3:8` and the message, of each mistake."""
    found, wrong = read_bindings(Source("bindings.toml", text))
    assert found is None or found.mistakes
    return [
        (f"{d.code.number} {d.span.source.name}:{d.span.line}:{d.span.column}", d.message)
        for d in wrong
        if d.span is not None
    ]


def changed(old: str, new: str) -> str:
    assert GOOD.count(old) == 1, old
    return GOOD.replace(old, new)


def test_a_clock_is_read() -> None:
    assert read(GOOD).clock == Clock(10**8, None, TimeSource.LOG_TIME, End.INCONCLUSIVE)
    other = changed('end  = "inconclusive"', 'end = "violated"\nrounding = "conservative"')
    assert read(other.replace('"log_time"', '"header.stamp"')).clock == Clock(
        10**8, None, TimeSource.HEADER_STAMP, End.VIOLATED, Rounding.CONSERVATIVE
    )


def test_a_clock_may_tick_with_the_messages_of_a_topic() -> None:
    assert read(changed('"100 ms"\nend', '"/scan"\nend')).clock == Clock(None, "/scan")


@pytest.mark.parametrize("topic", ["scan", "robot/scan", "_hidden", "~scan"])
def test_the_topic_of_a_clock_needs_no_leading_slash(topic: str) -> None:
    assert read(changed('"100 ms"\nend', f'"{topic}"\nend')).clock == Clock(None, topic)


def test_a_signal_is_read() -> None:
    signal = read(GOOD).signals["min_range"]
    assert signal.path == Path("/scan", ("ranges",), None, each=True)
    assert (signal.type, signal.reduce) == ("sensor_msgs/LaserScan", Reduce.MIN)
    assert (signal.unit.factor, signal.unit_name) == (Fraction(1), "m")
    assert signal.max_age == 300_000_000
    assert signal.invalid == InvalidReadings(Reading.DROP, Reading.FAR, Reading.NEAR, Reading.DROP)
    within = e.Comparison("<=", e.Name("range_min"), e.Name("x"))
    assert signal.valid == e.And((within, e.Comparison("<=", e.Name("x"), e.Name("range_max"))))


def test_a_proposition_is_read() -> None:
    found = read(GOOD).propositions
    too_close, stopped = found["too_close"], found["stopped"]
    assert too_close.expression == e.Comparison("<", e.Name("min_range"), e.Quantity("5", "cm"))
    assert (too_close.role, too_close.aggregate) == (Role.INPUT, Aggregate.ANY)
    assert (too_close.text, too_close.on_unknown) == ("an obstacle is nearer than 5 cm", None)
    slow = e.Comparison("<", e.Call("abs", (e.Name("vx"),)), e.Quantity("0.01", "m/s"))
    assert stopped.expression == e.Persistence(slow, 200_000_000)
    assert (stopped.role, stopped.kind) == (Role.OUTPUT, "physical")


@pytest.mark.slow
@pytest.mark.parametrize("digits", ["1", "15", "1.5", "1e9", "15e12", "1.5E+3", "1e-5", "2e-10"])
@pytest.mark.parametrize("unit", ["m/s", "mm/s", "km/h"])
def test_a_number_may_have_an_exponent_with_and_without_a_unit(digits: str, unit: str) -> None:
    plain = read(GOOD.replace('unit = "m/s"\n', "").replace("0.01 m/s", digits))
    assert plain.propositions["stopped"].expression == e.Persistence(
        e.Comparison("<", e.Call("abs", (e.Name("vx"),)), e.Number(digits)), 200_000_000
    )
    for space in ("", " "):
        found = read(changed("0.01 m/s", f"{digits}{space}{unit}")).propositions["stopped"]
        assert found.expression == e.Persistence(
            e.Comparison("<", e.Call("abs", (e.Name("vx"),)), e.Quantity(digits, unit)), 200_000_000
        )


@pytest.mark.parametrize("modality", Modality)
def test_a_modality_is_read_of_propositions_and_variables(modality: Modality) -> None:
    assert read(GOOD).propositions["too_close"].modality is Modality.BELIEF
    given = f'modality = "{modality}"\n'
    found = read(changed('role = "input"\n', given) + f"[variable.go]\n{given}[variable.halt]\n")
    assert found.propositions["too_close"].modality is modality
    assert found.variables["go"].modality is modality
    assert found.variables["halt"].modality is Modality.BELIEF


def test_a_duration_holds_for_all_that_stands_before_it() -> None:
    text = changed("abs(vx) < 0.01 m/s for", "vx < 1 m/s and vx > 0 m/s or vx = 2 m/s for")
    held = read(text).propositions["stopped"].expression
    assert isinstance(held, e.Persistence)
    assert isinstance(held.arg, e.Or)


@pytest.mark.parametrize(("text", "value"), [("true", True), ("false", False)])
def test_what_counts_as_known_is_an_assumption(text: str, value: bool) -> None:
    found = read(changed('on_unknown = "unknown"', f"on_unknown = {text}"))
    assert found.propositions["too_close"].on_unknown is value
    assert (
        "proposition too_close: where its signals are unknown it counts as "
        f"{text}, as the bindings declare"
    ) in found.assumptions


def test_every_default_is_listed_as_an_assumption() -> None:
    assert read(GOOD).assumptions == (
        "signal vx: readings that are no measurement are unknown",
        "signal vx: a sample never grows too old (no max_age)",
        "proposition stopped: the last sample of a tick counts",
    )
    assert (
        "clock: time is log_time, the default"
        in read(changed('time = "log_time"\n', "")).assumptions
    )


def test_a_laser_scan_is_read_as_rep_117_says() -> None:
    line = next(line for line in GOOD.splitlines() if line.startswith("invalid"))
    found = read(GOOD.replace(line + "\n", ""))
    assert found.signals["min_range"].invalid == REP_117
    assert any("REP 117" in text for text in found.assumptions)


def test_windows_line_ends_change_nothing() -> None:
    crlf, plain = read(GOOD.replace("\n", "\r\n")), read(GOOD)
    assert (crlf.clock, crlf.signals, crlf.propositions) == (
        plain.clock,
        plain.signals,
        plain.propositions,
    )


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("/scan.ranges[:]", Path("/scan", ("ranges",), None, each=True)),
        ("/joints.position[3]", Path("/joints", ("position",), 3)),
        ("/a/b-c.x.y", Path("/a/b-c", ("x", "y"))),
        ("/scan", None),
        ("/scan.ranges[-1]", None),
        ("/scan.ranges[1:]", None),
        ("", None),
        ("/scan.", None),
        ("/scan..x", None),
    ],
)
def test_a_path_names_a_topic_and_a_field(text: str, expected: Path | None) -> None:
    assert path(text) == expected


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "place", "message"),
    [
        ('time = "log_time"', 'time = "sent"', "F303 {}:2:8", "`time` cannot be `sent`"),
        ('time = "log_time"', "time = 3", "F303 {}:2:8", "`time` cannot be `3`"),
        (
            'tick = "100 ms"',
            'tick = "0 ms"',
            "F303 {}:3:8",
            "`tick` must be a duration above 0, or a topic",
        ),
        (
            'tick = "100 ms"',
            "tick = 100 # ms",
            "F303 {}:3:8",
            "`tick` must be a duration above 0, or a topic",
        ),
        ("end  =", "ends =", "F302 {}:4:1", "unknown field `ends` in [clock]"),
        (
            'end  = "inconclusive"',
            'rounding = "up"',
            "F303 {}:4:12",
            "`rounding` cannot be `up`",
        ),
        (
            '"/scan.ranges[:]"',
            '"/scan"',
            "F303 {}:7:11",
            "`path` must name a topic and a field",
        ),
        (
            'path    = "/scan.ranges[:]"\n',
            "",
            "F303 {}:6:2",
            "the signal has no `path`",
        ),
        ('"sensor_msgs/LaserScan"', "7", "F303 {}:8:11", "`type` must be a message type in quotes"),
        ('"min"', '"median"', "F303 {}:9:11", "`reduce` cannot be `median`"),
        (
            'reduce  = "min"\n',
            "",
            "F303 {}:7:11",
            "a path that ends with `[:]` needs `reduce`",
        ),
        ('"m"', '"metre"', "F306 {}:10:11", "unknown unit `metre`"),
        ('unit    = "m"', "unit    = 3", "F303 {}:10:11", "`unit` must be a unit in quotes"),
        ("x <= range_max", "", "F308 {}:11:31", "the expression ends too early"),
        ('nan = "drop"', 'nan = "zero"', "F303 {}:12:19", "`nan` cannot be `zero`"),
        ("nan =", "nann =", "F302 {}:12:13", "unknown field `nann` in `invalid`"),
        (
            'empty = "unknown"',
            'empty = "far"',
            "F303 {}:12:84",
            "`empty` can only be `unknown`: no reading is no evidence",
        ),
        ('"300 ms"', '"soon"', "F303 {}:13:11", "`max_age` must be a duration above 0"),
        ('"300 ms"', "300", "F303 {}:13:11", '`max_age` must be a duration: `"300 ms"`'),
        (
            'unit = "m/s"',
            'unit = "m/s"\nreduce = "min"',
            "F303 {}:18:10",
            "`reduce` needs a path that ends with `[:]`",
        ),
        ("text =", "txt =", "F302 {}:20:1", "unknown field `txt` in [proposition.too_close]"),
        (
            '"an obstacle is nearer than 5 cm"',
            "7",
            "F303 {}:20:8",
            "`text` must be a text in quotes",
        ),
        (
            'expr = "min_range < 5 cm"\n',
            "",
            "F303 {}:19:2",
            "the proposition `too_close` has no `expr`",
        ),
        (
            'expr = "min_range < 5 cm"',
            "expr = 5",
            "F303 {}:21:8",
            '`expr` must be an expression in quotes: `"min_range < 5 cm"`',
        ),
        ('"min_range < 5 cm"', '"min_rnge < 5 cm"', "F309 {}:21:9", "`min_rnge` is not declared"),
        (
            '"min_range < 5 cm"',
            '"root(min_range) < 5 m"',
            "F309 {}:21:9",
            "unknown function `root`",
        ),
        ('"min_range < 5 cm"', '"min_range < 5 parsec"', "F306 {}:21:21", "unknown unit `parsec`"),
        ('"min_range < 5 cm"', '"min_range < "', "F308 {}:21:21", "the expression ends too early"),
        ('"min_range < 5 cm"', '"min_range < 5 cm!"', "F308 {}:21:25", "`!` does not fit here"),
        (
            '"min_range < 5 cm"',
            '"TODO: when is it true?"',
            "F308 {}:21:9",
            "the expression is not written yet",
        ),
        (
            '"min_range < 5 cm"',
            '"min_range"',
            "F308 {}:21:9",
            "`min_range` is in m, and a truth value is needed",
        ),
        (
            '"min_range < 5 cm"',
            '"min_range + 1 m"',
            "F308 {}:21:8",
            "a proposition must be true or false, and this is a number",
        ),
        ('role = "input"', 'role = "in"', "F303 {}:22:8", "`role` cannot be `in`"),
        ('"any"', '"some"', "F303 {}:23:8", "`agg` cannot be `some`"),
        (
            'on_unknown = "unknown"',
            'on_unknown = "maybe"',
            "F303 {}:24:14",
            "`on_unknown` must be true, false or `unknown`",
        ),
        ('role = "input"', 'modality = "K"', "F303 {}:22:12", "`modality` cannot be `K`"),
        ('role = "input"', "modality = 3", "F303 {}:22:12", "`modality` cannot be `3`"),
        (
            'role = "input"',
            'modality = "P"',
            "F316 {}:22:12",
            "`too_close` cannot be a percept (`P`): AJPF treats a percept as absent once the agent "
            "has read it",
        ),
        ("for 200 ms", "for 200 m", "F306 {}:27:32", "`200 m` is not a duration"),
        ('"physical"', '"real"', "F303 {}:29:8", "`kind` cannot be `real`"),
        (
            "[proposition.stopped]",
            "[propositions.stopped]",
            "F302 {}:26:2",
            "unknown field `propositions` in the bindings",
        ),
        (
            "[proposition.stopped]",
            "[proposition.stopped",
            "F301 {}:26:21",
            "the bindings file is not TOML: expected ']' at the end of a table declaration",
        ),
    ],
)
def test_a_mistake_is_told_once_at_its_place(old: str, new: str, place: str, message: str) -> None:
    assert mistakes(changed(old, new)) == [(place.format("bindings.toml"), message)]


def test_a_table_that_holds_no_tables_is_told_once() -> None:
    messages = mistakes(changed("[signal.vx]", "[signal]\nvx = 3"))
    assert len([message for _, message in messages if "must hold tables" in message]) == 1


@pytest.mark.parametrize("valid", ["x", "x + range_min", "1 m"])
def test_what_is_valid_must_be_true_or_false(valid: str) -> None:
    messages = mistakes(changed("range_min <= x and x <= range_max", valid))
    assert len(messages) == 1
    assert messages[0][0].split()[1].startswith("bindings.toml:11:")


def test_a_clock_is_asked_for() -> None:
    text = GOOD[GOOD.index("[signal.min_range]") :]
    assert mistakes(text) == [("F303 bindings.toml:1:1", "the bindings declare no clock")]


def test_all_mistakes_are_told_at_once() -> None:
    text = changed('"any"', '"some"').replace('"log_time"', '"sent"').replace('"m/s"', '"mps"')
    assert sorted(place for place, _ in mistakes(text)) == [
        "F303 bindings.toml:23:8",
        "F303 bindings.toml:2:8",
        "F306 bindings.toml:17:8",
    ]


def test_metres_are_not_compared_with_seconds() -> None:
    _, (wrong,) = read_bindings(Source("bindings.toml", changed('5 cm"\nrole', '5 s"\nrole')))
    assert render(wrong) == (
        "F305 a quantity in m cannot be compared with or added to a quantity in s\n"
        "  --> bindings.toml:21:21\n"
        '   | expr = "min_range < 5 s"\n'
        "   |                     ^^^\n"
        "help: give each number its unit: `min_range < 5 cm`"
    )


@pytest.mark.parametrize(
    ("expression", "message"),
    [
        (
            "min_range < 5",
            "a quantity in m cannot be compared with or added to a number without a unit",
        ),
        ("min_range < vx", "a quantity in m cannot be compared with or added to a quantity in m/s"),
        (
            "min_range + vx * 2 s < 5 cm and vx < 3",
            "a quantity in m/s cannot be compared with or added to a number without a unit",
        ),
        (
            "max(min_range, 3 s) < 1 m",
            "a quantity in m cannot be compared with or added to a quantity in s",
        ),
        (
            "vx < 3 rad/s",
            "a quantity in m/s cannot be compared with or added to a quantity in rad/s",
        ),
        ("min_range < 5 cm and 3", "a truth value is needed, and this is a number"),
        ("(min_range < 5 cm) + 3 < 1", "a number is needed, and this is a truth value"),
    ],
)
def test_two_dimensions_never_meet(expression: str, message: str) -> None:
    messages = mistakes(changed('"min_range < 5 cm"', f'"{expression}"'))
    assert [text for _, text in messages] == [message]


@pytest.mark.parametrize(
    "expression",
    [
        "min_range < 50 mm",
        "min_range / 2 s < vx",
        "min_range * 2 <= 1 km",
        "vx * vx < 1 m^2/s^2",
        "min(min_range, 3 m) - 2 cm > -1 m",
        "not (min_range < 5 cm) and !(vx > 3 km/h)",
        "min_range < 5cm",
        "min_range == 5 m or true",
    ],
)
def test_dimensions_that_agree_are_accepted(expression: str) -> None:
    read(changed('"min_range < 5 cm"', f'"{expression}"'))


PERCENT = """
[clock]
tick = "100 ms"
[signal.level]
path = "/battery.level"
unit = "%"
[signal.ratio]
path = "/battery.ratio"
[proposition.low]
expr = "{}"
"""


@pytest.mark.parametrize(
    "expression", ["level < 20", "20 > level", "abs(level) >= 20", "level > -5", "not (level = 2)"]
)
def test_a_plain_number_beside_percent_is_warned_of(expression: str) -> None:
    declarations, (warning,) = read_bindings(Source("bindings.toml", PERCENT.format(expression)))
    assert declarations is not None
    assert (warning.code.number, warning.is_error) == ("F338", False)
    assert warning.span is not None
    assert warning.span.text in {"20", "5", "2"}
    assert warning.help == f"write `{warning.span.text} %`"


@pytest.mark.parametrize(
    "expression",
    ["level < 20 %", "level < 0.2", "level <= 1", "level > 0", "ratio > 20", "level < 20 * ratio"],
)
def test_a_percentage_or_a_part_of_one_is_not(expression: str) -> None:
    declarations, diagnostics = read_bindings(Source("bindings.toml", PERCENT.format(expression)))
    assert (declarations is not None, diagnostics) == (True, ())


NAMED_AS_UNITS = """
[clock]
tick = "100 ms"
[signal.v]
path = "/v.data"
unit = "m/s"
[signal.s]
path = "/s.data"
unit = "s"
[proposition.p]
expr = "{}"
"""


@pytest.mark.parametrize(
    ("expression", "place"),
    [
        ("v > 10 m/s", "10 m/s"),
        ("v * s > 10 m*s/s", "10 m*s/s"),
        ("v > 1 m/s and s > 2 s", "1 m/s"),
    ],
)
def test_a_unit_that_may_be_a_signal_is_refused(expression: str, place: str) -> None:
    declarations, (wrong,) = read_bindings(Source("b", NAMED_AS_UNITS.format(expression)))
    assert declarations is not None
    assert declarations.mistakes == {("proposition", "p"): (wrong,)}
    assert wrong.code.number == "F339"
    assert wrong.span is not None
    assert wrong.span.text == place


def test_a_signal_of_another_dimension_than_the_unit_is_not_meant() -> None:
    read(NAMED_AS_UNITS.replace('unit = "s"', 'unit = "m"').format("v > 10 m/s"))


@pytest.mark.parametrize("expression", ["v > (10 m) / s", "v > 10 km/h", "s > 2 s", "v * s > 1 m"])
def test_a_signal_may_have_the_name_of_a_unit_that_is_not_at_stake(expression: str) -> None:
    read(NAMED_AS_UNITS.format(expression))


def test_a_signal_of_words_has_a_role_too() -> None:
    text = '[clock]\ntick = "1 s"\n[signal.mode]\npath = "/mode.data"\nvalues = ["idle"]\n'
    assert read(f'{text}role = "output"\n').signals["mode"].role is Role.OUTPUT
    assert read(text).signals["mode"].role is None

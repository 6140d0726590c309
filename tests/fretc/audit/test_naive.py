"""Audits of random small logs, against an auditor written from the documentation.

40 runs; `HYPOTHESIS_PROFILE=full`: 4000.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

from compiler.formalization.formalize import formalize
from compiler.targets.python.monitor import text
from fretc.audit.one_log import MonitoredRequirement, audit
from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from fretish.bindings.declarations import Declarations
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.source import Source
from fretish.documents import requirements
from monitors.kernel import Monitor
from monitors.loading import load
from tests.effort import FULL
from tests.fretc.audit.naive import (
    FACTORS,
    FORMS,
    Proposition,
    Run,
    Sample,
    Signal,
    verdicts,
)
from tests.fretc.audit.stepping import stepping
from tests.fretc.logs.logs import NONE, ZSTD, S, Sent, header, payload, store, write

BOUND = """
[signal.x]
path = "/x.data"
[proposition.p]
expr = "x < 1"
[proposition.q]
expr = "x < 2"
"""
RUNS = 4000 if FULL else 40
START = 5 * S
OPERATORS = ("<", "<=", ">", ">=", "=", "!=")
LARGE = (2**53 - 1, 2**53, 2**53 + 1, 2**53 + 2, 2**63 - 1, 2**63 - 2, -(2**53), -(2**53) - 1)
POOLS: dict[str, tuple[str, ...]] = {
    "m": ("0.35", "0.357", "0.29", "0.07", "1.1", "3", "-0.35"),
    "m/s": ("0.7", "0.35", "1.5", "-1.1"),
    "m/s^2": ("0.35", "9.81"),
    "m^2": ("0.35", "4"),
    "rad": ("0.35", "1.5708"),
    "1": ("0.35", "0.29", "0.07", "1", "0", "-0.9"),
}
"""Numbers near to each other, in base units."""
UNITS = {
    "m": ("m", "cm", "mm", "km"),
    "m/s": ("m/s", "cm/s", "km/h"),
    "m/s^2": ("m/s^2", "cm/s2"),
    "m^2": ("m^2", "cm^2"),
    "rad": ("rad", "mrad", "deg"),
    "1": ("1", "%"),
}


# Numbers


def decimal(value: Fraction, digits: int = 6) -> str | None:
    """As a decimal of at most so many digits that count; None where it is none."""
    for places in range(12):
        scaled = value * 10**places
        if scaled.denominator == 1:
            whole = abs(int(scaled))
            if len(str(whole).strip("0")) > digits:
                return None
            sign = "-" if value < 0 else ""
            body = f"{whole:0{places + 1}d}"
            return sign + (f"{body[:-places]}.{body[-places:]}" if places else body)
    return None


@dataclass(frozen=True)
class Kind:
    """How a signal is recorded."""

    topic: str
    """The kind of topic."""
    field: str
    family: str
    """Signals of one family, in one unit, are compared exactly."""


KINDS = (
    Kind("json", "x", "double"),
    Kind("json", "y.z", "double"),
    Kind("json", "v[:]", "double"),
    Kind("json", "v[1]", "double"),
    Kind("json", "n", "json whole"),
    Kind("point", "point.x", "double"),
    Kind("point", "point.y", "double"),
    Kind("range", "range", "single"),
    Kind("range", "min_range", "single"),
    Kind("Float64", "data", "double"),
    Kind("Float32", "data", "single"),
    Kind("Int64", "data", "whole"),
    Kind("UInt64", "data", "whole"),
    Kind("UInt8", "data", "byte"),
    Kind("Bool", "data", "truth"),
    Kind("Float32MultiArray", "data[:]", "single"),
    Kind("Float64MultiArray", "data[1]", "double"),
)
FLAT = {
    "Float64": "<d",
    "Float32": "<f",
    "Int64": "<q",
    "UInt64": "<Q",
    "UInt8": "<B",
    "Bool": "<?",
}
"""Messages of one number, and how it is packed."""


@dataclass(frozen=True)
class Bound:
    """A signal of the bindings."""

    name: str
    kind: Kind
    topic: str
    dimension: str
    unit: str
    reduce: str
    max_age: int | None

    @property
    def text(self) -> str:
        lines = [f"[signal.{self.name}]", f'path = "{self.topic}.{self.kind.field}"']
        lines += [f'unit = "{self.unit}"'] if self.unit != "1" else []
        lines += [f'reduce = "{self.reduce}"'] if self.reduce else []
        lines += [f'max_age = "{self.max_age} ns"'] if self.max_age else []
        return "\n".join(lines)


def drawn(random: Random, bound: Bound) -> Fraction | None:
    """A number in the unit of the field; None is no number."""
    family = bound.kind.family
    if family == "truth":
        return Fraction(random.randrange(2))
    if family == "byte":
        return Fraction(random.choice((0, 7, 29, 35, 255)))
    if family in ("whole", "json whole"):
        number = random.choice((*LARGE, 35, 29, 0, -35))
        return Fraction(abs(number) if bound.kind.topic == "UInt64" else number)
    if random.random() < 0.08:
        return None
    while True:
        value = Fraction(random.choice(POOLS[bound.dimension]))
        if bound.unit != "deg":
            value /= FACTORS[bound.unit]
        if decimal(value) is not None:
            return value


# Expressions


def constant(random: Random, bound: Bound) -> tuple[str, Any]:
    """Text and meaning of a constant beside a signal."""
    family = bound.kind.family
    if family in ("whole", "json whole", "byte", "truth"):
        unit, pool = bound.unit, (*LARGE, 35, 29, 7, 0, 1, -35)
        digits = str(random.choice(pool))
        if random.random() < 0.2:
            digits += ".5"
    else:
        while True:
            unit = random.choice(UNITS[bound.dimension])
            value = Fraction(random.choice(POOLS[bound.dimension]))
            digits_in_base = decimal(value if unit == "deg" else value / FACTORS[unit])
            if digits_in_base is not None:
                digits = digits_in_base
                break
    word = "" if unit == "1" else f" {unit}"
    sign, digits = ("-" if digits.startswith("-") else ""), digits.removeprefix("-")
    plain: Any = ("constant", digits, unit)
    plain = ("-", plain) if sign else plain
    text = f"{sign}{digits}{word}"
    match random.randrange(10):
        case 0:
            return f"({text} + {text}) / 2", ("/", ("+", plain, plain), ("constant", "2", "1"))
        case 1:
            return f"min({text}, {text})", ("min", plain, plain)
        case 2:
            return f"3 * ({text}) / 3", plain
        case _:
            return text, plain


def term(random: Random, bound: Bound, signals: Sequence[Bound]) -> tuple[str, Any]:
    """Text and meaning of a number that is measured."""
    alike = [
        one
        for one in signals
        if (one.kind.family, one.unit) == (bound.kind.family, bound.unit) and one.reduce == ""
    ]
    plain: Any = ("signal", bound.name)
    match random.randrange(8):
        case 0:
            return f"abs({bound.name})", ("abs", plain)
        case 1:
            return f"-{bound.name}", ("-", plain)
        case 2 if alike:
            other, end = random.choice(alike), random.choice(("min", "max"))
            return f"{end}({bound.name}, {other.name})", (end, plain, ("signal", other.name))
        case 3 if bound.kind.family == "double":
            return f"{bound.name} * 2", ("*", plain, ("constant", "2", "1"))
        case _:
            return bound.name, plain


def comparison(random: Random, signals: Sequence[Bound]) -> tuple[str, Any]:
    bound, op = random.choice(signals), random.choice(OPERATORS)
    alike = [
        one
        for one in signals
        if (one.kind.family, one.unit) == (bound.kind.family, bound.unit) and one != bound
    ]
    left, meaning = term(random, bound, signals)
    if alike and "*" not in left and random.random() < 0.2:
        other = random.choice(alike)
        return f"{left} {op} {other.name}", (op, meaning, ("signal", other.name))
    right, limit = constant(random, bound)
    if random.random() < 0.3:
        return f"{right} {op} {left}", (op, limit, meaning)
    return f"{left} {op} {right}", (op, meaning, limit)


def expression(
    random: Random, signals: Sequence[Bound], longest: int, depth: int = 0
) -> tuple[str, Any]:
    """Text and meaning of a truth value."""
    match random.randrange(8 if depth < 3 else 4):
        case 4:
            inner, meaning = expression(random, signals, longest, depth + 1)
            return f"not ({inner})", ("not", meaning)
        case 5:
            op = random.choice(("and", "or"))
            one, p = expression(random, signals, longest, depth + 1)
            two, q = expression(random, signals, longest, depth + 1)
            return f"({one}) {op} ({two})", (op, p, q)
        case 6 | 7 if longest:
            inner, meaning = expression(random, signals, longest, depth + 1)
            duration = random.randrange(longest)
            return f"(({inner}) for {duration} ns)", ("for", meaning, duration)
        case _:
            return comparison(random, signals)


# Messages


def as_json(random: Random, bound: Bound, value: Fraction | None) -> str | None:
    """How a number stands in a message; None: it is left out."""
    if value is None:
        return random.choice(("null", "NaN", '"Infinity"', None))
    if bound.kind.family == "json whole":
        return str(int(value))
    digits = decimal(value)
    assert digits is not None
    if value in (0, 1) and random.random() < 0.3:
        return "true" if value else "false"
    return digits


def floats(values: Sequence[Fraction | None], kind: Any) -> Any:
    return np.array([float("nan") if v is None else float(v) for v in values], kind)


def made(
    random: Random,
    kind: str,
    signals: Sequence[Bound],
    values: dict[str, list[Fraction | None]],
    stamp: int | None,
) -> tuple[str, str, bytes]:
    """Encoding, type and payload of a message."""
    if kind == "json":
        parts = []
        for bound in signals:
            some = [as_json(random, bound, value) for value in values[bound.name]]
            truths = [one for one in some if one is not None]
            match bound.kind.field:
                case "v[:]":
                    truths = ["null" if one is None else one for one in some]
                    parts.append(f'"v": [{", ".join(truths)}]')
                case "v[1]":
                    parts.append(f'"v": [5, {"null" if some[0] is None else some[0]}, 7]')
                case "y.z":
                    parts.append('"y": {' + "".join(f'"z": {one}' for one in truths) + "}")
                case name:
                    parts += [f'"{name}": {one}' for one in truths]
        if stamp is not None:
            sec, nanosec = divmod(stamp, S)
            parts.append(f'"header": {{"stamp": {{"sec": {sec}, "nanosec": {nanosec}}}}}')
        return "json", "Some", f"{{{', '.join(parts)}}}".encode()
    by_field = {bound.kind.field: values[bound.name] for bound in signals}
    if kind in FLAT:
        (value,) = by_field["data"]
        number: Any = float("nan") if value is None else value
        number = float(number) if kind.startswith("Float") else int(number)
        return "cdr", f"std_msgs/msg/{kind}", b"\0\1\0\0" + struct.pack(FLAT[kind], number)
    if kind.endswith("MultiArray"):
        name, width = f"std_msgs/msg/{kind}", np.float32 if "32" in kind else np.float64
        (array,) = by_field.values()
        if "data[1]" in by_field:
            array = [Fraction(5), *array]
        layout = store("cdr").types["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
        return "cdr", name, payload(name, layout=layout, data=floats(array, width))
    assert stamp is not None
    if kind == "point":
        name = "geometry_msgs/msg/PointStamped"
        point = store("cdr").types["geometry_msgs/msg/Point"]
        x, y = (floats(by_field.get(f"point.{a}", [Fraction(1)]), np.float64)[0] for a in "xy")
        return "cdr", name, payload(name, header=header(stamp), point=point(x=x, y=y, z=0.0))
    name = "sensor_msgs/msg/Range"
    one, two = (
        floats(by_field.get(f, [Fraction(1)]), np.float32)[0] for f in ("range", "min_range")
    )
    fields: dict[str, Any] = {"radiation_type": 0, "field_of_view": 0.1, "max_range": 9.0}
    fields |= {"header": header(stamp), "min_range": two, "range": one, "variance": 0.0}
    return "cdr", name, payload(name, **fields)


# Runs


@dataclass(frozen=True)
class Case:
    """A random log with bindings and a requirement; `run` is what the naive auditor is given."""

    bindings: str
    sent: tuple[Sent, ...]
    run: Run
    form: str
    timing: str
    ticks: int
    log: dict[str, Any]
    """How it is written."""


def case(seed: int) -> Case:
    random = Random(seed)
    coarse = random.random() < 0.25
    """Long enough for durations in microseconds; too long for `for`."""
    length = random.choice((2000, 5000)) if coarse else random.choice((0, 7, 40, 80))
    tick = random.choice((300, 340, 500, 700)) if coarse else random.choice((1, 4, 7, 12, 25))
    source = random.choice(("log_time", "log_time", "publish_time", "header.stamp"))
    topics = {
        topic: random.choice([kind.topic for kind in KINDS])
        for topic in ("/a", "/b")[: random.choice((1, 2, 2))]
    }
    signals: list[Bound] = []
    for topic, kind in topics.items():
        fields = [one for one in KINDS if one.topic == kind]
        for one in random.sample(fields, random.randint(1, min(2, len(fields)))):
            if one.field.startswith("v[") and any(
                "v[" in s.kind.field and s.topic == topic for s in signals
            ):
                continue
            whole = one.family in ("whole", "json whole", "byte", "truth")
            dimension = random.choice(list(POOLS)) if not whole else random.choice(("m", "1"))
            unit = random.choice(UNITS[dimension])
            age = random.choice((None, None, 3, 9, tick, 2 * tick + 1))
            reduce = random.choice(("min", "max")) if one.field.endswith("[:]") else ""
            name = f"s{len(signals)}"
            signals.append(Bound(name, one, topic, dimension, unit, reduce, age))
    by_message = not coarse and random.random() < 0.15
    phase = 0 if by_message else random.choice((0, 0, random.randrange(tick)))
    sent, samples, times = recorded(random, topics, signals, length, source)
    p, p_is = expression(random, signals, 0 if coarse else 15)
    q, q_is = expression(random, signals, 0 if coarse else 15)
    propositions, told = {}, []
    for name, body, meaning in (("p", p, p_is), ("q", q, q_is)):
        aggregate, known = (
            random.choice(("any", "all", "last")),
            random.choice((None, None, True, False)),
        )
        propositions[name] = Proposition(meaning, aggregate, known)
        told.append(f'[proposition.{name}]\nexpr = "{body}"\nagg = "{aggregate}"')
        told += [f"on_unknown = {str(known).lower()}"] if known is not None else []
    end = random.choice(("inconclusive", "inconclusive", "violated"))
    clock = [
        f'tick = "{"/a" if by_message else f"{tick} ns"}"',
        f'time = "{source}"',
        f'end = "{end}"',
    ]
    clock += [f'phase = "{phase} ns"'] if phase else []
    clock += ['rounding = "conservative"'] if coarse else []
    form, timing, count = timed(random, coarse, tick)
    bindings = "\n".join(["[clock]", *clock, *(one.text for one in signals), *told])
    run = Run(
        tick,
        phase,
        end,
        {one.name: Signal(one.unit, tuple(samples[one.name]), one.max_age) for one in signals},
        propositions,
        times,
        "/a" if by_message else None,
    )
    log = {
        "per_chunk": random.choice((1, 3, 50)),
        "compression": random.choice((NONE, ZSTD)),
        "crcs": random.random() < 0.5,
    }
    return Case(bindings, tuple(sent), run, form, timing, count, log)


def timed(random: Random, coarse: bool, tick: int) -> tuple[str, str, int]:
    """A form of sentence, the words of its timing, and how many ticks that counts."""
    form = random.choice([form for form in FORMS if not coarse or "{n}" in form])
    if not coarse or " after " in form:
        count = random.randint(1, 4)
        return form, f"{count} tick{'s' * (count > 1)}", count
    amount = random.choice((1, 2))
    words = f"{amount} microsecond{'s' * (amount > 1)}"
    exact = Fraction(amount * 1000, tick)
    fewer = int(exact)
    return form, words, fewer if " within " in form or exact == fewer else fewer + 1


def recorded(
    random: Random, topics: dict[str, str], signals: Sequence[Bound], length: int, source: str
) -> tuple[list[Sent], dict[str, list[Sample]], dict[str, tuple[int, ...]]]:
    """Messages in the order of the file, the samples in them, and the times of each topic."""
    sent: list[Sent] = []
    samples: dict[str, list[Sample]] = {bound.name: [] for bound in signals}
    times: dict[str, list[int]] = {topic: [] for topic in topics}
    zeros = random.random() < 0.1
    count = random.choice((1, 2, 6, 12, 25))
    places = [random.randint(0, length) for _ in range(count)]
    if random.random() < 0.7:
        places.sort()
    rows = [(random.choice(list(topics)), START + place) for place in places]
    rows += [(topic, START + random.randint(0, length)) for topic in topics]  # none is empty
    for topic, time in rows:
        own = [bound for bound in signals if bound.topic == topic]
        values = {
            bound.name: [
                drawn(random, bound) for _ in range(random.choice((1, 3)) if bound.reduce else 1)
            ]
            for bound in own
        }
        kind = topics[topic]
        others = {
            "log_time": START + random.randint(0, length),
            "publish_time": START + random.randint(0, length),
        }
        zero = zeros and bool(times[topic]) and random.random() < 0.2
        stated = 0 if zero else time
        stamp: int | None = (
            stated if source == "header.stamp" else START + random.randint(0, length)
        )
        bare = kind not in ("json", "point", "range")
        if bare or (kind == "json" and random.random() < 0.2):
            stamp = None
        if source in others:
            others[source] = stated
        elif stamp is None:
            others["log_time"], zero = time, False
        encoding, type_, body = made(random, kind, own, values, stamp)
        sent.append(Sent(topic, type_, body, others["log_time"], others["publish_time"], encoding))
        placed = times[topic][-1] if zero else time
        times[topic].append(placed)
        for bound in own:
            some = values[bound.name]
            known = [value for value in some if value is not None]
            whole = len(known) == len(some) and not zero
            end = {"min": min, "max": max, "": min}[bound.reduce]
            samples[bound.name].append(Sample(placed, end(known) if whole else None))
    return sent, samples, {topic: tuple(found) for topic, found in times.items()}


# The comparison


@cache
def monitor(sentence: str, clock: str) -> Monitor:
    read, _ = requirements(Source("R1.fret", sentence))
    requirement, diagnostics = formalize(read[0], declared(f"{clock}\n{BOUND}"))
    assert requirement is not None, diagnostics
    return load("monitor", text(requirement))


def declared(bindings: str) -> Declarations:
    declarations, diagnostics = read_bindings(Source("bindings.toml", bindings))
    assert declarations is not None, (bindings, diagnostics)
    return declarations


def watched(one: Case) -> Monitor:
    clock = one.bindings.partition("[signal")[0]
    lines = [line for line in clock.splitlines() if not line.startswith(("phase", "end", "time"))]
    return monitor(one.form.replace("{n}", one.timing), "\n".join(lines))


def differences(one: Case, path: Path) -> list[str]:
    """Where fretc and the naive auditor part; nothing where they agree."""
    write(path, one.sent, **one.log)
    declarations = declared(one.bindings)
    recording = read(str(path), declarations, list(declarations.signals))
    assert isinstance(recording, Recording), recording
    if not recording.intact:
        return [f"not intact: {[f.message for f in recording.findings]}"]
    run, apart = one.run, []
    watching = watched(one)
    (evidence,) = audit(recording, declarations, [MonitoredRequirement(watching, {})])
    with stepping():
        (stepped,) = audit(recording, declarations, [MonitoredRequirement(watching, {})])
    if (evidence.verdict, evidence.outcome) != (stepped.verdict, stepped.outcome):
        apart.append(f"engines: {evidence.verdict}, {stepped.verdict}")
    for name, tally in evidence.propositions.items():
        column, _ = run.columns(name)
        known = [value for value in column if value is not None]
        changes = sum(a != b for a, b in pairwise(known))
        counts = (known.count(True), known.count(False), column.count(None), changes)
        ours = (tally.true, tally.false, tally.unknown, tally.changes)
        if ours != counts:
            apart.append(f"{name}: {ours}, and not {counts}: {column}")
    apart += verdict_differences(evidence.verdict, one, run, "verdict")
    if evidence.phases is not None:
        for stretch in evidence.phases.stretches:
            every = range(stretch.first, stretch.last + 1)
            for phase in every if run.tick < 100 else {every[0], every[-1]}:
                at = replace(run, phase=phase)
                apart += verdict_differences(str(stretch.verdict), one, at, f"phase {phase}")
    return apart


def verdict_differences(verdict: str, one: Case, run: Run, what: str) -> list[str]:
    """What is wrong about one verdict."""
    may = verdicts(one.form, one.ticks, run)
    if may is None or may == {verdict}:
        return []
    certain = all(None not in part for name in "pq" for part in run.columns(name))
    if not certain and (verdict == "no data" or verdict == "inconclusive" in may):
        return []
    return [f"{what}: {verdict}, and not {sorted(may)}"]


@pytest.mark.slow
@pytest.mark.parametrize("part", range(4))
def test_audits_are_those_of_the_documentation(tmp_path: Path, part: int) -> None:
    for seed in range(part, RUNS, 4):
        assert differences(case(seed), tmp_path / "run.mcap") == [], f"seed {seed}"

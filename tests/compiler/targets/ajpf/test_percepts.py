"""The percepts in Java have the truth values that Python's perception has of the same messages."""

import random
import subprocess
from array import array
from collections.abc import Iterator, Mapping
from functools import cache
from math import inf, nan
from pathlib import Path
from struct import pack, unpack
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.ajpf import bundle
from compiler.targets.ajpf.runtime import emit, refusal
from compiler.targets.ajpf.safety_function import Sif, sif
from compiler.targets.python import perception
from fretc.rosbridge.encoding import as_cbor, as_json
from monitors.kernel.verdicts import Truth
from tests.bound_requirements import TABLES_OF_AGENT, bound_requirement
from tests.effort import FULL
from tests.programs import installed, needs

PLAIN = ("Cbor", "Json", "Percepts", "Reading", "Signal", "View")
FOOTPRINT = "[[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]]"
SHARED = f"""{TABLES_OF_AGENT}[clock]
tick = "100 ms"
[signal.q]
path = "/q.data"
type = "std_msgs/Float64"
unit = "1"
[proposition.stopped]
expr = "q > 1"
[signal.x]
path = "/s.x"
type = "a_msgs/S"
unit = "cm"
max_age = "300 ms"
[signal.y]
path = "/s.deep.y"
type = "a_msgs/S"
unit = "m"
"""
EXPRESSIONS = (
    ("", "x < 5 cm"),
    ("", "x <= 0.1 m and not (y >= 0.35 m)"),
    ("", "x + y >= 30 cm or x * 2 = 6 cm"),
    ("", "not (abs(x - 3 cm) < 1 cm) or y != 0.25 m"),
    ("", "x / 2 < y mod 1 m"),
    ("", "-y < 0.1 m and not (x / 3 > y)"),
    (
        '[signal.a]\npath = "/s.a[:]"\ntype = "a_msgs/S"\nunit = "m"\nreduce = "min"\n'
        'valid = "lo <= x and x <= hi"\n'
        'invalid = { nan = "drop", "+inf" = "far", "-inf" = "near", other = "drop" }\n',
        "a < 0.35 m",
    ),
    (
        '[signal.a]\npath = "/s.a[:]"\ntype = "a_msgs/S"\nunit = "m"\nreduce = "max"\n'
        'invalid = { nan = "unknown", "+inf" = "drop", "-inf" = "near", other = "drop" }\n',
        "a >= 0.1 m",
    ),
    ('[signal.a]\npath = "/s.a[1]"\ntype = "a_msgs/S"\nunit = "m"\n', "a < 0.1 m"),
    (
        '[signal.a]\npath = "/s.a[:]"\ntype = "a_msgs/S"\nunit = "m"\nreduce = "outline"\n'
        f"footprint = {FOOTPRINT}\nsensor = [0.1, 0.0, 0.5]\n"
        'valid = "lo <= x and x <= hi"\n'
        'invalid = { nan = "drop", "+inf" = "far", "-inf" = "near", other = "drop" }\n',
        "a < 20 cm",
    ),
    ('[signal.w]\npath = "/s.w"\ntype = "a_msgs/S"\nvalues = ["go", "st\\u00f6p"]\n', 'w = "go"'),
    (
        '[signal.w]\npath = "/s.n"\ntype = "a_msgs/S"\nvalues = { go = 2, halt = 3 }\n',
        "w != halt",
    ),
    ('[signal.v]\nvalue = "x + 2 * abs(y)"\nunit = "mm"\n', "v < 60 cm and v / 2 != y"),
    ('[signal.b]\npath = "/s.b"\ntype = "a_msgs/S"\nunit = "1"\n', "b"),
    ('[signal.b]\npath = "/s.b"\ntype = "a_msgs/S"\nunit = "1"\n', "not b or x < 3 cm"),
)
NEAR = (0.0, -0.0, 0.1, 0.25, 0.35, 3.0, 5.0, 7e8)


def subjects() -> Iterator[FormalizedRequirement]:
    for i, (signal, expression) in enumerate(EXPRESSIONS):
        meaning = f"[proposition.near]\nexpr = '{expression}'\n"
        sentence = "whenever near the sw shall eventually satisfy stopped"
        yield bound_requirement(sentence, f"{SHARED}{signal}{meaning}", f"R{i}")


def numbers(choose: random.Random) -> float:
    kind = choose.random()
    if kind < 0.1:
        return choose.choice((nan, inf, -inf))
    value = choose.choice(NEAR)
    single: float = unpack("f", pack("f", value))[0]
    if kind < 0.4:
        return value
    if kind < 0.7:
        return single
    return choose.uniform(-0.2, 0.9) if kind < 0.9 else float(choose.randint(-2, 31))


def messages(choose: random.Random) -> Iterator[dict[str, Any]]:
    """Messages of the type `a_msgs/S`; some of their fields are 32-bit floats in an array."""
    while True:
        yield {
            "x": numbers(choose),
            "deep": {"y": numbers(choose)},
            "a": array(
                choose.choice("ffd"), [numbers(choose) for _ in range(choose.randint(0, 5))]
            ),
            "lo": choose.choice((0.05, 0.0)),
            "hi": 5.0,
            "angle_min": -1.0,
            "angle_increment": 0.7,
            "w": choose.choice(("go", "st\xf6p", "other")),
            "n": choose.choice((2, 3, 4, 2**60)),
            "b": choose.choice((True, False)),
        }


def spaces(value: Any) -> Any:
    if isinstance(value, dict):
        return SimpleNamespace(**{name: spaces(each) for name, each in value.items()})
    return list(value) if isinstance(value, array) else value


@cache
def deployed(number: int) -> Mapping[str, Any]:
    """What the nodes of ROS packages execute, for one of the subjects."""
    text = perception.text([[*subjects()][number]])
    values: dict[str, Any] = {}
    exec(compile(text, "perception.py", "exec"), values)
    return values


def expected(number: int, message: Mapping[str, Any]) -> Truth:
    """The percept after one message; unknown if it matters whether a number has 32 bits."""
    setting, sample = deployed(number)["SETTING"], deployed(number)["sample"]
    (meaning,) = (each for each in setting.meanings if each.name == "near")
    policies = [each for each in setting.policies if each.topic == "/s"]
    is_double = message["a"].typecode == "d"
    truths = set()
    for singles in range(2 ** len(policies)):
        row = {}
        for place, policy in enumerate(policies):
            single = bool(singles >> place & 1)
            value = sample(policy, spaces(message), single)
            is_array = policy.fields == ("a",)
            if single is is_double if is_array else single and not _has_32_bits(value):
                break  # a number that this message cannot hold
            row[policy.name] = value
        else:
            truths.add(meaning.truth(row, ()))
    return truths.pop() if len(truths) == 1 else None


def _has_32_bits(number: object) -> bool:
    if not isinstance(number, float) or number != number or abs(number) > 1e38:
        return True
    return bool(unpack("f", pack("f", number))[0] == number)


MAIN = """
package %s;
import java.nio.ByteBuffer;
import java.util.Base64;
public final class Main {
    public static String truth(String form, String text) {
        View view = new View(false);
        try {
            byte[] bytes = Base64.getDecoder().decode(text);
            String json = new String(bytes, java.nio.charset.StandardCharsets.UTF_8);
            boolean isCbor = form.equals("cbor");
            Object message = isCbor ? Cbor.read(ByteBuffer.wrap(bytes)) : Json.read(json);
            view.arrive("/s", message, 1000);
        } catch (IllegalArgumentException error) {
            return "malformed " + error.getMessage();
        }
        return String.valueOf(view.truths(1000)[0]);
    }
    private Main() {}
}
"""
STAMPS = """
package r0_agent;
import java.util.*;
public final class Stamps {
    /** Each argument after the first: stamp and arrival in ms, and x; or a time. */
    public static void main(String[] args) {
        View view = new View(args[0].equals("simulated"));
        for (String each : Arrays.asList(args).subList(1, args.length)) {
            String[] parts = each.split(" ");
            long now = Long.parseLong(parts[parts.length > 1 ? 1 : 0]) * 1000000;
            if (parts.length > 1) {
                Map<String, Object> stamp = new HashMap<>();
                long time = Long.parseLong(parts[0]);
                stamp.put("sec", (double) (time / 1000));
                stamp.put("nanosec", (double) (time % 1000 * 1000000));
                Map<String, Object> header = new HashMap<>();
                header.put("stamp", stamp);
                Map<String, Object> message = new HashMap<>();
                message.put("header", header);
                message.put("x", Double.valueOf(parts[2]));
                view.arrive("/s", message, now);
            }
            System.out.println(view.truths(now)[0]);
        }
    }
    private Stamps() {}
}
"""
ALL = """
import java.io.*;
public final class All {
    public static void main(String[] args) throws IOException {
        BufferedReader lines = new BufferedReader(new InputStreamReader(System.in));
        for (String line = lines.readLine(); line != null; line = lines.readLine()) {
            String[] parts = line.split(" ");
            switch (parts[0]) {
%s
            }
        }
    }
    private All() {}
}
"""


def _unchecked(requirement: FormalizedRequirement, options: object) -> bundle.CheckedAgent:
    """The agent without its proof, which takes long and is not what is tested."""
    agent = sif(requirement)
    assert isinstance(agent, Sif)
    return bundle.CheckedAgent(agent, ())


def _no(requirement: FormalizedRequirement, options: object) -> None:
    """No refusal."""


@pytest.fixture(scope="module")
def classes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The compiled percepts of all subjects, with a program that takes messages."""
    folder = tmp_path_factory.mktemp("java")
    cases = []
    with patch.object(bundle, "checked_agent", _unchecked), patch.object(bundle, "refusal", _no):
        emitted = [emit([subject]) for subject in subjects() if refusal(subject) is None]
    assert len(emitted) == len(EXPRESSIONS)
    for artifacts in emitted:
        name = ""
        for artifact in artifacts:
            name = artifact.path.parent.name
            (folder / name).mkdir(exist_ok=True)
            if artifact.path.suffix == ".java" and artifact.path.stem in PLAIN:
                (folder / artifact.path).write_text(artifact.text, encoding="utf-8")
        (folder / name / "Main.java").write_text(MAIN % name, encoding="utf-8")
        cases.append(
            f'case "{name}": System.out.println({name}.Main.truth(parts[1], parts[2])); break;'
        )
    (folder / "r0_agent/Stamps.java").write_text(STAMPS, encoding="utf-8")
    (folder / "All.java").write_text(ALL % "\n".join(cases), encoding="utf-8")
    files = [str(file.relative_to(folder)) for file in folder.rglob("*.java")]
    command = [installed("javac"), "--release", "11", "-Xlint:all", "-Werror", "-d", "out", *files]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    return folder / "out"


def asked(classes: Path, lines: list[str]) -> list[str]:
    done = subprocess.run(
        [installed("java"), "-cp", str(classes), "All"],
        input="\n".join(lines),
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.splitlines()


def base64(data: bytes) -> str:
    from base64 import b64encode

    return b64encode(data).decode()


WORD = {True: "true", False: "false", None: "null"}


@needs("javac", "java")
@pytest.mark.slow
def test_percepts_are_those_of_the_perception_in_python(classes: Path) -> None:
    choose = random.Random(41)
    lines, wanted, told = [], [], []
    for _ in range(2000 if FULL else 100):
        for i in range(len(EXPRESSIONS)):
            message = next(messages(choose))
            lines.append(f"r{i}_agent cbor {base64(as_cbor(message))}")
            wanted.append(WORD[expected(i, message)])
            told.append(f"{EXPRESSIONS[i][1]} {message}")
    answers = asked(classes, lines)
    wrong = [each for each in zip(told, wanted, answers, strict=True) if each[1] != each[2]]
    assert not wrong, (len(wrong), wrong[:3])
    assert {"true", "false", "null"} == {*wanted}


@needs("javac", "java")
@pytest.mark.slow
def test_in_json_a_number_that_is_not_finite_is_unknown(classes: Path) -> None:
    """Rosbridge writes null for all of them."""
    choose = random.Random(7)
    lines, wanted = [], []
    for message in (next(messages(choose)) for _ in range(200)):
        for x in (0.04, nan, inf, -inf, 9.0):
            lines.append(f"r0_agent json {base64(as_json({**message, 'x': x}).encode())}")
            wanted.append("null" if x != x or x in (inf, -inf) else WORD[x < 5])
    assert asked(classes, lines) == wanted


@needs("javac", "java")
@pytest.mark.slow
def test_bytes_that_are_no_message_are_malformed_and_nothing_else(classes: Path) -> None:
    choose = random.Random(3)
    good = as_cbor(next(messages(choose)))
    lines = []
    for _ in range(20_000 if FULL else 2_000):
        bad = bytearray(good[: choose.randint(0, len(good))])
        for _ in range(choose.randint(0, 3)):
            if bad:
                bad[choose.randrange(len(bad))] = choose.randrange(256)
        lines.append(f"r6_agent {choose.choice(('cbor', 'json'))} {base64(bytes(bad)) or 'AA=='}")
    deep = base64(b"\x81" * 100_000), base64(b"[" * 100_000), base64(b"\x9b" + b"\xff" * 8)
    lines += [f"r6_agent cbor {deep[0]}", f"r6_agent json {deep[1]}", f"r6_agent cbor {deep[2]}"]
    for answer in asked(classes, lines):
        assert answer in ("true", "false", "null") or answer.startswith("malformed "), answer


T, F, N = "true", "false", "null"
AHEAD = 5_000_000
"""Milliseconds by which the sender's clock is ahead."""


@needs("javac", "java")
@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "events", "truths"),
    [
        ("real", ["1000 1000 4", "1299", "1301"], [T, T, N]),  # `max_age` is 300 ms
        ("real", [f"{AHEAD} 10 4", f"{AHEAD + 100} 110 9", "411"], [T, F, N]),
        ("real", ["1000 1050 4", "1100 1450 9", "1200 1250 4"], [T, F, T]),
        ("real", ["1000 1050 4", "1100 1500 9"], [T, N]),  # it waited for 400 ms
        ("real", ["1000 1050 4", "1200 1250 9", "1100 1260 4"], [T, F, F]),  # overtaken
        ("real", ["9000 1000 4", "6000 1100 9", "6100 1200 4"], [T, F, T]),  # set back by 3 s
        (
            "real",  # set back by half a second: ten messages count as overtaken
            ["9000 1000 4", *(f"{8600 + k} {1100 + 100 * k} 4" for k in range(12))],
            [T, T, T, T, *[N] * 7, T, T],
        ),
        ("simulated", ["1000 1000 4", "1100 1450 9", "1200 1450 4"], [T, N, T]),
        ("simulated", ["5000 1000 4", "5100 5200 9"], [T, F]),  # the clock was late
    ],
)
def test_a_message_is_as_old_as_its_stamp(
    classes: Path, kind: str, events: list[str], truths: list[str]
) -> None:
    done = subprocess.run(
        [installed("java"), "-cp", str(classes), "r0_agent.Stamps", kind, *events],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == truths

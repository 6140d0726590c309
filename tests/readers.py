"""Every reader of files, each with a sound file and the command that reads it; and mutations.

A mutation keeps most of the structure: parts of a text are dropped, doubled, moved, nested or made
extreme; in binary files lengths and numbers are.
"""

from __future__ import annotations

import io
import random
import re
import struct
import sys
import time
import zipfile
from collections.abc import Mapping
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path

from mcap.records import Channel, Schema

from fretc import cli
from tests import keys
from tests.fretc.logs.broken import log_of, raw
from tests.fretc.logs.logs import S, number, write
from tests.fretc.logs.storage.test_bags import bag, db3, ros1, ros2

FRET = """+++
id = "R1"
title = "Stops"
parents = ["HAZ-1"]
verify = ["audit"]
params = { p = "1 m" }
+++
whenever p the sw shall within 200 milliseconds satisfy q
"""
AGENT_FRET = "whenever p sw shall eventually satisfy q\n"
BINDINGS = """[clock]
time = "log_time"
tick = "100 ms"

[signal.x]
path = "/x.data"
unit = "m"
max_age = "150 ms"
valid = "0 m <= x and x <= 50 m"

[proposition.p]
expr = "x < 1 m"

[proposition.q]
expr = "x < 2 m or (x < 3 m) for 1 s"
text = "near"

[interceptor]
stop = "/stop"
command = "/cmd_vel"
output = "/cmd_vel_filtered"
scan = "/scan"
period = "50 ms"
hold = "200 ms"
stop_timeout = "500 ms"
scan_timeout = "500 ms"
"""
HAZARDS = '[HAZ-1]\ntitle = "It collides"\ntext = "Badly."\nseverity = "minor"\nsource = "us"\n'
WAIVERS = """[R1]
verdict = "no data"
reason = "the lidar is being replaced"
by = "A. Meier"
role = "safety engineer"
granted = "2026-11-01"
expires = "2026-12-31"
"""
SCENARIO = (Path(__file__).parents[1] / "simulation/scenarios/nominal.toml").read_text("utf-8")
EXPORT = """{"requirements": [{"reqid": "R1", "project": "P", "fulltext": "the sw shall satisfy p",
 "semantics": {"ft": "F p"}}], "variables": [{"project": "P", "variable_name": "p",
 "dataType": "boolean", "idType": "Output"}]}"""
TABLE = "id,text,project\nR1,the sw shall satisfy p,P\nR2,free words,P\n"
NEEDS = """{"current_version": "1", "versions": {"1": {"needs": {"HAZ-1": {"id": "HAZ-1",
 "title": "t", "content": "c"}}}}}"""
STRICTDOC = """{"DOCUMENTS": [{"TITLE": "d", "NODES": [{"UID": "HAZ-1", "TITLE": "t",
 "STATEMENT": "s", "NODES": []}]}]}"""
DOORSTOP = "HAZ-1:\n  active: true\n  header: h\n  level: 1.0\n  text: t\n  links: &a []\n  x: *a\n"
REQIF = (Path(__file__).parent / "data/parents.reqif").read_text("utf-8")
AJPF = """{"schema": "fretc-ajpf-result-1", "requirement": "R1", "weakened": null, "agent": null,
 "mcapl": {"commit": null}, "java": "17", "files": {"a.psl": "00"}, "checks": [{"role": "property",
 "key": "R1", "jpf": "a.jpf", "property": "[] (B(sw,p))", "expected": "HOLDS", "told": "HOLDS",
 "why": "", "seconds": 1.5, "states": {"new": 3}, "log": "logs/a.jpf.txt", "log_sha256": "00",
 "trace": null}]}"""
GWENDOLEN = """GWENDOLEN

:name: sw

:Initial Beliefs:

:Initial Goals:

:Plans:

+p : {~B q} <- +q, stop(1, 2);
"""
PSL = "# comment\nR1: [] (~(B(sw,p)) || (<> (B(sw,q))))\n"
METADATA = """rosbag2_bagfile_information:
  version: 5
  relative_file_paths: [run.db3]
  message_count: 12
  starting_time: {nanoseconds_since_epoch: 1000}
  duration: {nanoseconds: 5}
  compression_mode: ""
"""
ROS = "std_msgs/Header header\nfloat64 data\nuint8[4] a\nstring[] s\n"
HEADER = f"{'=' * 80}\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
IDL = """module a { module msg { @verbatim (language="comment", text="x")
struct B { double data; /* c */ sequence<uint8, 4> s; double v[3]; }; }; };"""
JSON_SCHEMA = '{"type": "object", "properties": {"data": {"type": "number"}}}'


@dataclass(frozen=True)
class Reader:
    """One kind of file, and what reads it."""

    file: str
    sound: bytes
    args: tuple[str, ...]
    beside: Mapping[str, str | bytes]
    binary: bool = False


def _log(encoding: str, defined: str, name: str, text: str | bytes, payload: bytes) -> bytes:
    data = text if isinstance(text, bytes) else text.encode()
    channel = Channel(1, "/x", encoding, {}, 1)
    sent = (raw(time * S, payload) for time in (1, 2, 3))
    return log_of(Schema(1, data, defined, name), channel, *sent)


def _protobuf() -> bytes:
    from google.protobuf import descriptor_pb2

    files = descriptor_pb2.FileDescriptorSet()
    file = files.file.add(name="a.proto", package="a", syntax="proto3")
    message = file.message_type.add(name="B")
    message.field.add(name="data", number=1, type=1, label=1)
    message.field.add(name="below", number=2, type=11, label=3, type_name=".a.B")
    return bytes(files.SerializeToString())


def _zipped(text: str) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("a.reqif", text)
    return packed.getvalue()


def readers(folder: Path) -> dict[str, Reader]:
    """All of them; files that fretc itself writes are made in the folder."""
    project: dict[str, str | bytes] = {
        "requirements/r.fret": FRET,
        "requirements/bindings.toml": BINDINGS,
        "requirements/hazards.toml": HAZARDS,
    }
    put(folder, project)
    sent = [number(0.5 + i / 8, 1000 * S + i * 100_000_000) for i in range(12)]
    write(folder / "log.mcap", sent)
    signed = ("--reviewer", "a", "--role", "b", "--comment", "c", "--accept-violations")
    key = keys.written(str(folder / "key"))
    for args in (
        ("audit", "log.mcap"),
        ("sign", "build/evidence.json", "--key", "key"),
        ("lock", *signed),
        ("requirements", "--emit", "monitor"),
        ("requirements", "--emit", "interceptor"),
        ("verify", "--layer", "monitor", "requirements/r.fret"),
    ):
        status, text, _ = command(folder, *args)
        assert status in (0, 1, 3), text
    log = (folder / "log.mcap").read_bytes()
    own = {**project, "log.mcap": log}
    evidence = (folder / "build/evidence.json").read_bytes()
    kept = {**own, "build/evidence.json": evidence}
    report = ("report", "--json", "-")
    found: dict[str, Reader] = {}

    def add(
        name: str,
        file: str,
        sound: str | bytes,
        args: tuple[str, ...],
        beside: Mapping[str, str | bytes] = own,
        *,
        binary: bool = False,
    ) -> None:
        data = sound if isinstance(sound, bytes) else sound.encode()
        found[name] = Reader(file, data, args, beside, binary)

    check = ("requirements",)
    add("requirements", "requirements/r.fret", FRET, check)
    add("bindings", "requirements/bindings.toml", BINDINGS, check)
    add("hazards", "requirements/hazards.toml", HAZARDS, ("check",))
    add("waivers", "requirements/waivers.toml", WAIVERS, report, kept)
    add("lock", "requirements/fretc.lock", made_in(folder, "requirements/fretc.lock"), report, kept)
    above = {**own, "a.json": NEEDS}
    add("settings", "pyproject.toml", '[tool.fretc]\nparents = ["a.json"]\n', ("check",), above)
    accept = '[accept]\nF315 = { "/x" = "slow by design" }\n'
    add("fretc.toml", "requirements/fretc.toml", accept, ("check",))
    add(
        "scenario",
        "s.toml",
        SCENARIO,
        ("simulate", "s.toml", "--duration", "0.01", "-o", "s.mcap"),
    )
    add("FRET's JSON", "e.json", EXPORT, ("import", "e.json", "-o", "-"))
    add("FRET's CSV", "e.csv", TABLE, ("import", "e.csv", "-o", "-", "--id-column", "id"))
    for kind, file, text in (
        ("needs.json", "p.json", NEEDS),
        ("StrictDoc", "p.json", STRICTDOC),
        ("Doorstop", "p.yml", DOORSTOP),
        ("ReqIF", "p.reqif", REQIF),
    ):
        named = {**own, "pyproject.toml": f'[tool.fretc]\nparents = ["{file}"]\n'}
        add(kind, file, text, ("check",), named)
    packed = {**own, "pyproject.toml": '[tool.fretc]\nparents = ["p.reqifz"]\n'}
    add("reqifz", "p.reqifz", _zipped(REQIF), ("check",), packed, binary=True)
    add("evidence", "build/evidence.json", evidence, report)
    verified = made_in(folder, "build/verification.json")
    add("signers", "requirements/allowed_signers", keys.line("a", key), report, kept)
    whose = {**kept, "requirements/allowed_signers": keys.line("a", key)}
    envelopes = made_in(folder, "build/evidence.json.intoto.jsonl")
    add("signatures", "build/evidence.json.intoto.jsonl", envelopes, report, whose)
    again = ("sign", "build/evidence.json", "--key", "key")
    add("private key", "key", Path(key).read_bytes(), again, kept)
    add("verification", "build/verification.json", verified, report, kept)
    concluded = ("verify", "--layer", "ajpf", "--ajpf", "result.json", "requirements/r.fret")
    add("AJPF's result", "result.json", AJPF, concluded)
    agents: dict[str, str | bytes] = {"agent.fret": AGENT_FRET, "a.gwen": GWENDOLEN, "a.psl": PSL}
    texts = ("--agent", "a.gwen", "--properties", "a.psl")
    agent = ("verify", "--layer", "agent", "agent.fret", *texts)
    add("psl", "a.psl", PSL, agent, agents)
    add("Gwendolen", "a.gwen", GWENDOLEN, agent, agents)
    monitor = next((folder / "build").glob("*_monitor.py")).read_bytes()
    verify = ("verify", "--limit", "1", "requirements/r.fret")
    add("monitor", "m.py", monitor, (*verify, "--layer", "monitor", "--file", "m.py"))
    info = ("info", "l.mcap")
    double = struct.pack("<d", 0.5)
    guard = next((folder / "build").glob("*interceptor*.py")).read_bytes()
    layer = ("--layer", "interceptor", "--interceptor", "i.py")
    add("interceptor", "i.py", guard, (*verify, *layer))
    add("MCAP", "l.mcap", log, info, {}, binary=True)
    add("MCAP, audited", "log.mcap", log, ("audit", "log.mcap", "--jobs", "1"), binary=True)
    cdr = b"\0\1\0\0"
    add("MCAP, watched", "log.mcap", log, ("watch", "log.mcap"), binary=True)
    add("ros1", "l.mcap", _log("ros1", "ros1msg", "a/B", ROS + HEADER, bytes(40)), info, {})
    ros2_text = ROS + HEADER.replace("time stamp", "int32 stamp")
    add(
        "ros2msg", "l.mcap", _log("cdr", "ros2msg", "a/msg/B", ros2_text, cdr + bytes(40)), info, {}
    )
    add("idl", "l.mcap", _log("cdr", "ros2idl", "a/msg/B", IDL, cdr + double * 6), info, {})
    messages = _log("json", "jsonschema", "x", JSON_SCHEMA, b'{"data": 1}')
    add("JSON", "l.mcap", messages, info, {})
    messages = _log("protobuf", "protobuf", "a.B", _protobuf(), b"\t" + double)
    add("Protobuf", "l.mcap", messages, info, {}, binary=True)
    one = bag(folder / "one.bag", ros1()).read_bytes()
    add("bag", "l.bag", one, ("info", "l.bag"), {}, binary=True)
    two = db3(folder / "two", ros2()).read_bytes()
    add("db3", "l.db3", two, ("info", "l.db3"), {}, binary=True)
    add("metadata.yaml", "run/metadata.yaml", METADATA, ("info", "run"),
        {"run/run.db3": two})  # fmt: skip
    return found


def made_in(folder: Path, name: str) -> bytes:
    return (folder / name).read_bytes()


def put(folder: Path, files: Mapping[str, str | bytes]) -> None:
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        data = content if isinstance(content, bytes) else content.encode()
        (folder / name).write_bytes(data)


def command(folder: Path, *args: str) -> tuple[int, str, float]:
    """Status, text and CPU seconds of one command in a folder, in this process."""
    out, before = io.TextIOWrapper(io.BytesIO(), "utf-8"), sys.argv
    start = time.process_time()
    sys.argv = ["fretc", *args]
    status: object = 0
    try:
        with chdir(folder), redirect_stdout(out), redirect_stderr(out):
            cli.main()
    except SystemExit as exit_:
        status = exit_.code or 0
    finally:
        sys.argv = before
    out.flush()
    text = out.buffer.getvalue().decode(errors="replace")
    return int(str(status)), text, time.process_time() - start


# Mutations

_EXTREME = (b"0", b"-1", b"1e999999999", b"99999999999999999999", b"9" * 5000, b"nan", b"\xff", b"",
            b"[" * 3000, b"{", b"true", b'""', b"&a", b"*a", b"2026-99-99", b"\0")  # fmt: skip
_TOKEN = re.compile(rb"[A-Za-z_]+|[0-9.]+|\s+|.", re.DOTALL)


def mutated(reader: Reader, chance: random.Random) -> bytes:
    """A sound file, changed in a few places."""
    if reader.binary or chance.random() < 0.1:
        return _bytes(reader.sound, chance)
    tokens = _TOKEN.findall(reader.sound)
    for _ in range(chance.randint(1, 3)):
        at = chance.randrange(len(tokens) + 1)
        end = min(len(tokens), at + chance.choice((1, 1, 2, 5, 20)))
        part = tokens[at:end]
        match chance.randrange(6):
            case 0:
                tokens[at:end] = []
            case 1:
                tokens[at:end] = part * chance.choice((2, 3, 200))
            case 2:
                tokens[at:end] = [chance.choice(_EXTREME)]
            case 3:
                tokens[at:end] = [chance.choice(tokens)] if tokens else []
            case 4:
                other = chance.randrange(len(tokens) + 1)
                tokens[other:other] = part
            case _:
                tokens.insert(at, chance.choice(_EXTREME))
    return b"".join(tokens)[:100_000]


def _bytes(sound: bytes, chance: random.Random) -> bytes:
    data = bytearray(sound)
    for _ in range(chance.randint(1, 4)):
        at = chance.randrange(len(data))
        match chance.randrange(5):
            case 0:
                data[at] = chance.randrange(256)
            case 1:
                size = chance.choice((1, 2, 4, 8))
                value = chance.choice((0, 1, 2**31, 2**63, 2**64 - 1, 10**9))
                data[at : at + size] = (value % 256**size).to_bytes(size, "little")
            case 2:
                del data[at : at + chance.choice((1, 8, 100))]
            case 3:
                data[at:at] = data[at : at + chance.choice((1, 8, 500))]
            case _:
                del data[max(1, at) :]
    return bytes(data)


def fuzzed(name: str, reader: Reader, folder: Path, count: int, seed: int) -> float:
    """Feed it so many mutations; the seconds of the slowest.

    Raises:
        AssertionError: a traceback, F999, or more than five seconds; the file stays in the folder.
    """
    chance, slowest = random.Random(f"{name} {seed}"), 0.0
    put(folder, reader.beside)
    for i in range(count):
        data = mutated(reader, chance)
        put(folder, {reader.file: data})
        status, text, seconds = command(folder, *reader.args)
        slowest = max(slowest, seconds)
        kept = f"{name}, seed {seed}, number {i}: {folder / reader.file}\n{text[:2000]}"
        assert status in (0, 1, 2, 3), kept
        assert "F999" not in text, kept
        assert "Traceback" not in text, kept
        assert seconds < 5, kept
    return slowest

"""Every command line of `fretc` that one option makes, as click declares it.

A new command or option is among them at once; it fails a test until `VALUES` says what it takes.
"""

from collections.abc import Iterator, Mapping, Sequence

import click

from fretc.cli import cli
from fretc.terminal.group import DEFAULT

VALUES: Mapping[str, Sequence[str]] = {
    # what a project has
    "files": ("requirements",),
    "requirements": ("requirements",),
    "bindings": ("requirements/bindings.toml",),
    "hazards": ("requirements/hazards.toml",),
    "folder": ("requirements",),
    "pack": ("nav2",),
    "text": ("{component} must stop",),
    "choose": ("1",),
    "id_": ("R9",),
    "what": ("{id}", "requirements/", "F306"),
    "ids": ("{id}",),
    "show": ("{id}",),
    "only": ("{id}",),
    "component": ("{component}",),
    # logs
    "paths": ("l.mcap",),
    "words": ("l.mcap",),
    "logs": ("l.mcap",),
    "log": ("l.mcap",),
    "source": ("l.mcap",),
    "places_named": (".",),
    "labels": ("version=1",),
    "since": ("7d",),
    "sample": ("1",),
    "seed": ("1",),
    "log_time": ("60s",),
    "whole_time": ("60s",),
    "engine": ("local",),
    "confidence": ("0.9",),
    "query": ("select count(*) from results",),
    # what other commands have made
    "evidence": ("build/evidence.json",),
    "verification": ("build/verification.json",),
    "analysis": ("build/analysis.json",),
    "tests": ("build/tests/suite.json",),
    "saved": ("build/tests/suite.json",),
    "baseline": ("requirements/fretc.lock",),
    "waivers": ("requirements/waivers.toml",),
    "signers": ("requirements/allowed_signers",),
    "ajpf": ("result.json",),
    "monitor_file": ("build/{stem}_monitor.py",),
    "interceptor": ("build/interceptor.py",),
    "agent": ("a.gwen",),
    "properties": ("a.psl",),
    "percepts": ("p",),
    "manifest": ("logs.sha256",),
    "report": ("build/report.html",),
    "file": ("build/evidence.json",),
    "key": ("key",),
    "signed_by": ("key.pub",),
    # outputs
    "output": ("-", "out/file"),
    "emit_to": ("-",),
    "annotations": ("notes",),
    "parquet": ("t.parquet",),
    "picture": ("p.svg",),
    "path": ("out/fretc.lock",),
    "record": ("recorded.mcap",),
    "traces": ("counterexamples",),
    "html": ("-",),
    "command": ("cat",),
    # numbers and words
    "seconds": ("1",),
    "limit": ("1",),
    "runs": ("1",),
    "jobs": ("1",),
    "line_time": ("1",),
    "reviewer": ("A. Meier",),
    "role": ("safety engineer",),
    "comment": ("looked at",),
    "day": ("2026-11-20",),
    "id_column": ("id",),
    "text_column": ("text",),
    "project_column": ("project",),
    "by": ("version",),
    "level": ("0.05",),
    "reports": ("../{name}/report.html",),
    "duration": ("1",),
    "shell": ("bash",),
    "scenarios": ("nominal",),
}
"""What is given for each parameter, by its name; `OWN` has what a command means by it."""
OWN: Mapping[tuple[str, str], Sequence[str]] = {
    ("test", "against"): ("cat",),
    ("play", "against"): ("requirements",),
    ("mutate", "paths"): ("l.mcap",),
    ("init", "folder"): ("new",),
    ("import", "file"): ("export.json",),
    ("sign", "files"): ("build/evidence.json",),
    ("trends", "evidence"): ("build/evidence.json",),
    ("watch", "evidence"): ("watched.json",),
    ("analyze", "output"): ("-",),
    ("audit", "output"): ("-", "store"),
    ("report", "output"): ("-",),
}
CHEAP: Mapping[str, Sequence[str]] = {
    "jobs": ("--jobs", "1"),
    "seconds": ("--time", "1"),
    "limit": ("--limit", "1"),
}
"""Given wherever a command has the parameter: no test waits for a proof."""
ELSEWHERE = {
    ("watch", "publish"): "opens a server, or needs a robot",
    ("report", "opens"): "starts a browser",
    ("check", "watch"): "waits for changes",
    ("watch", "follow"): "waits for what is still to come",
    ("simulate", ""): "simulates a mission of its own, and reads no project",
    ("completion", ""): "prints a script for a shell",
    ("lsp", ""): "answers an editor at standard input",
}
"""What has tests of its own alone, and why."""
WITH: Mapping[tuple[str, str], Sequence[str]] = {
    ("bind", "source"): (),
    ("watch", "evidence"): ("--record", "again.mcap"),
    ("verify", "agent"): ("--properties", "a.psl"),
    ("verify", "properties"): ("--agent", "a.gwen"),
    ("compile", "one_file"): ("--emit", "monitor"),
    ("compile", "weaken"): ("--emit", "ajpf"),
    ("test", "languages"): ("--emit", "pytest"),
}
"""What an option needs beside it."""


def _values(command: str, parameter: click.Parameter) -> Sequence[str]:
    assert parameter.name is not None
    own = OWN.get((command, parameter.name))
    if own is not None:
        return own
    if isinstance(parameter.type, click.Choice):
        return [str(each) for each in parameter.type.choices]
    if parameter.name in VALUES:
        return VALUES[parameter.name]
    if command == "report":  # each form has an option of its name
        return (f"out/report.{parameter.name}",)
    raise AssertionError(f"VALUES has nothing for `{parameter.name}` of `fretc {command}`")


def _base(command: str, made: click.Command, without: str = "") -> list[str]:
    """The least that the command takes, but for one parameter."""
    line = [command] if command != DEFAULT else []
    for parameter in made.params:
        if parameter.name == without:
            continue
        if isinstance(parameter, click.Option) and parameter.required:
            line += [parameter.opts[-1], _values(command, parameter)[0]]
        elif isinstance(parameter, click.Argument) and (parameter.required or command == "bind"):
            line.append(_values(command, parameter)[0])
    for name, given in CHEAP.items():
        if name != without and any(parameter.name == name for parameter in made.params):
            line += given
    return line


def command_lines() -> tuple[tuple[str, ...], ...]:
    """Each command by itself, and with each value of each of its parameters; each line once."""
    return tuple(dict.fromkeys(_lines()))


def _lines() -> Iterator[tuple[str, ...]]:
    for command in cli.commands:
        made = cli.commands[command]
        if (command, "") in ELSEWHERE:
            continue
        if command != "bind":  # it wants one of two options
            yield tuple(_base(command, made))
        for parameter in made.params:
            assert parameter.name is not None
            if (command, parameter.name) not in ELSEWHERE:
                yield from _with(command, made, parameter)


def _with(
    command: str, made: click.Command, parameter: click.Parameter
) -> Iterator[tuple[str, ...]]:
    assert parameter.name is not None
    more = WITH.get((command, parameter.name), ())
    if isinstance(parameter, click.Argument):
        for value in _values(command, parameter):
            base = _base(command, made, parameter.name)
            yield (*base[:1], value, *base[1:]) if base else (value,)
        return
    assert isinstance(parameter, click.Option)
    base = _base(command, made, parameter.name)
    if command == "bind" and parameter.name == "source":
        base = ["bind"]
    elif command == "bind" and parameter.name != "check":
        base.append("--check")
    if parameter.is_flag:
        yield (*base, *more, parameter.opts[-1])
        return
    for value in _values(command, parameter):
        yield (*base, *more, parameter.opts[-1], value)

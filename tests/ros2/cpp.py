"""Messages of ROS 2 as structs of C++, for the node in C++ beside `tests/ros2/rclcpp/fake.hpp`."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from tests.programs import installed
from tests.ros2.messages import STORE

_BASES = {"float32": "float", "float64": "double", "string": "std::string", "byte": "uint8_t"}
_BASE, _NAME, _ARRAY = 1, 2, 3


def write_headers(
    folder: Path, types: list[str], fields: dict[str, str], snake: Callable[[str], str]
) -> None:
    """The headers that the node includes, with structs of our own; each includes `fake.hpp`.

    Args:
        folder: where they go.
        types: of messages, `std_msgs/Bool`.
        fields: of a type that the node hears, what fills a message `m` from the stream `text`; of
            one that it publishes, what a line says of a message `m`.
        snake: `LaserScan` → `laser_scan`.
    """
    known: dict[str, str] = {}
    for name in types:
        _define(full_name(name), known)
    standard = ("array", "cstdint", "memory", "sstream", "string", "vector")
    heads = "".join(f"#include <{each}>\n" for each in standard)
    _write(folder, heads + "".join(known.values()), fields)
    for header in _headers(types, snake):
        path = folder / header
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text('#include "fake.hpp"\n')


def write_real_headers(
    folder: Path,
    types: list[str],
    fields: dict[str, str],
    snake: Callable[[str], str],
    include: Path,
) -> list[str]:
    """The same with the messages of an installed ROS 2; the options by which they are included.

    Args:
        folder, types, fields, snake: as for `write_headers`.
        include: the folder of the headers that rosidl has generated.
    """
    heads = "".join(f"#include <{each}>\n" for each in _headers(types, snake))
    _write(folder, f"#include <sstream>\n{heads}", fields)
    return [option for each in sorted(include.iterdir()) for option in ("-isystem", str(each))]


def _headers(types: list[str], snake: Callable[[str], str]) -> list[str]:
    return [f"{name.split('/')[0]}/msg/{snake(name.split('/')[1])}.hpp" for name in types]


def _write(folder: Path, messages: str, fields: dict[str, str]) -> None:
    """`messages.hpp`, and the headers of rclcpp."""
    tells = "".join(
        f"inline std::string tell(const {_cpp(name)} & m) {{{body}}}\n"
        if "return" in body
        else f"template<> inline {_cpp(name)} made<{_cpp(name)}>(std::istream & text) "
        f"{{{_cpp(name)} m; {body} return m;}}\n"
        for name, body in fields.items()
    )
    names = "".join(
        f'inline std::string type_name(const {_cpp(name)} *) {{return "{full_name(name)}";}}\n'
        for name, body in fields.items()
        if "return" not in body
    )
    template = "template<class Message> Message made(std::istream & text);\n"
    (folder / "messages.hpp").write_text(f"#pragma once\n{messages}{template}{tells}{names}")
    headers = "rclcpp/rclcpp", *(f"rclcpp_lifecycle/lifecycle_{x}" for x in ("node", "publisher"))
    for name in headers:
        path = folder / f"{name}.hpp"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text('#include "fake.hpp"\n')


def built(
    folder: Path, source: Path, main: Path, in_c: Sequence[str], in_cpp: Sequence[str]
) -> Path:
    """A program in C++ with the monitors in C of an emitted package.

    Args:
        folder: for what is compiled.
        source: the folder `src` of the package.
        main: the text in C++.
        in_c: options for the monitors.
        in_cpp: options for the text.
    """
    objects = []
    for name in ("monitors", "monitors_signals"):
        objects.append(str(folder / f"{name}.o"))
        command = [installed("gcc"), "-std=c99", *in_c, "-c", f"{source / name}.c"]
        subprocess.run([*command, "-o", objects[-1]], check=True)
    command = [installed("g++"), "-std=c++17", *in_cpp, str(main), *objects]
    subprocess.run([*command, "-o", str(folder / main.stem)], check=True)
    return folder / main.stem


def full_name(name: str) -> str:
    """`sensor_msgs/LaserScan` → `sensor_msgs/msg/LaserScan`."""
    return name.replace("/", "/msg/")


def _cpp(name: str) -> str:
    package, _, short = name.partition("/")
    return f"{package}::msg::{short.removeprefix('msg/')}"


def _define(name: str, known: dict[str, str]) -> None:
    """The struct, after those of its parts."""
    if name in known:
        return
    members = "".join(
        f"  {_type(kind, known)} {field}{{}};\n" for field, kind in STORE.fielddefs[name][1]
    )
    package, _, short = name.partition("/msg/")
    pointer = f"  using ConstSharedPtr = std::shared_ptr<const {short}>;\n"
    known[name] = f"namespace {package}::msg {{ struct {short} {{\n{pointer}{members}}}; }}\n"


def _type(described: Any, known: dict[str, str]) -> str:
    kind, inner = int(described[0]), described[1]
    if kind == _NAME:
        _define(inner, known)
        return str(inner).replace("/", "::")
    if kind == _BASE:
        base = inner[0]
        return _BASES.get(base, base if base == "bool" else f"{base}_t")
    element = _type(inner[0], known)
    return f"std::array<{element}, {inner[1]}>" if kind == _ARRAY else f"std::vector<{element}>"

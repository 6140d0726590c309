"""Emitted JavaScript, run by Node: Node reads modules and words, and tells each outcome."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any

from tests.programs import installed, needs

needs_node = needs("node")
Row = Sequence[Any] | Mapping[str, Any]
_READ = """
import { readFileSync } from "node:fs";
const { paths, words, by } = JSON.parse(readFileSync(0, "utf8"));
const given = (value) => {
  if (Array.isArray(value)) return value.map(given);
  if (value === null || typeof value !== "object") return value;
  if ("float" in value) return Number(value.float);
  if ("single" in value) return { float32: Number(value.single) };
  if ("whole" in value) return BigInt(value.whole);
  return Object.fromEntries(Object.entries(value).map(([name, part]) => [name, given(part)]));
};
const modules = await Promise.all(paths.map((path) => import(path)));
const told = words.map(([place, rows]) => {
  const state = modules[place].init();
  return given(rows).map((row) => modules[place][by](state, row));
});
process.stdout.write(JSON.stringify(told));
"""
"""A float that JSON does not hold comes as text, and so do the other kinds of numbers."""


def outcomes(
    folder: Path, texts: Sequence[str], words: Sequence[tuple[int, Sequence[Row]]], by: str = "step"
) -> list[list[list[dict[str, Any]]]]:
    """Of each word, the outcomes of each requirement at each tick.

    Args:
        folder: for the modules.
        texts: of modules.
        words: the place of a module, and the values of each tick.
        by: `step` takes values of variables, `judge` truths of propositions.
    """
    paths = []
    for place, text in enumerate(texts):
        path = folder / f"m{place}.mjs"
        path.write_text(text, encoding="utf-8")
        paths.append(path.as_uri())
    told: list[list[list[dict[str, Any]]]] = json.loads(
        run(_READ, json.dumps({"paths": paths, "words": words, "by": by}))
    )
    return told


def run(script: str, text: str = "") -> str:
    """What a module prints that gets the text."""
    with NamedTemporaryFile("w", suffix=".mjs", encoding="utf-8") as file:
        file.write(script)
        file.flush()
        command = [installed("node"), file.name]
        done = subprocess.run(
            command, input=text, capture_output=True, text=True, timeout=120, check=False
        )
    assert done.returncode == 0, done.stderr
    return done.stdout

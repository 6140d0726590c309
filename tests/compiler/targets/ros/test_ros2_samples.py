"""The node in C++ reads of each kind of field what the node in Python reads."""

from __future__ import annotations

import json
import math
import subprocess
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.c_monitors import CHECKED_IN_CPP
from tests.effort import examples
from tests.ros2.cpp import built as compiled
from tests.ros2.emitted import write
from tests.ros2.world import World

SCAN = """
path = "/m.ranges[:]"
type = "a_msgs/M"
valid = "least <= x and x <= most"
"""
BINDINGS = f"""
[clock]
tick = "10 ms"
[signal.low]{SCAN}
reduce = "min"
invalid = {{ nan = "drop", "+inf" = "far", "-inf" = "near", other = "drop", empty = "unknown" }}
[signal.high]{SCAN}
reduce = "max"
invalid = {{ nan = "unknown", "+inf" = "drop", "-inf" = "drop", other = "far" }}
[signal.third]
path = "/m.ranges[2]"
type = "a_msgs/M"
[signal.flags]
path = "/m.flags[:]"
type = "a_msgs/M"
reduce = "max"
[signal.count]
path = "/m.count"
type = "a_msgs/M"
[signal.mode]
path = "/m.mode"
type = "a_msgs/M"
values = ["idle", "moving"]
[signal.level]
path = "/m.level"
type = "a_msgs/M"
values = {{ ok = 0, warn = 7 }}
[signal.gap]{SCAN}
reduce = "outline"
footprint = [[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]]
sensor = [0.1, 0.0, 0.5]
unit = "cm"
invalid = {{ nan = "drop", "+inf" = "far", "-inf" = "near", other = "drop", empty = "unknown" }}
[proposition.p]
expr = "low < 1 and high > 1 and third < 1 and flags > 0 and count > 3 and gap < 5 cm"
[proposition.q]
expr = "mode = moving or level = warn"
"""
DRIVER = """
#include <cstdio>
#include <iostream>
#include "setting.hpp"

struct M {
  std::vector<float> ranges; std::vector<bool> flags;
  int64_t count; std::string mode; uint8_t level;
  float least, most, angle_min, angle_increment;
};

int main()
{
  M m;
  std::string text;
  std::size_t ranges, flags;
  int level;
  std::cin >> ranges;
  for (; ranges > 0; ranges--) { std::cin >> text; m.ranges.push_back(std::stof(text)); }
  std::cin >> flags;
  for (; flags > 0; flags--) { std::cin >> text; m.flags.push_back(text == "1"); }
  std::cin >> m.count >> level >> m.least >> m.most >> m.angle_min >> m.angle_increment;
  m.level = static_cast<uint8_t>(level);
  std::getline(std::cin, m.mode);
  std::getline(std::cin, m.mode);
  for (const fretc_number & n : fretc::read_0(m)) {
    std::printf("%d %.17g %llu\\n", n.kind, n.value, static_cast<unsigned long long>(n.magnitude));
  }
}
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Any]:
    """The driver, and what the package in Python reads by."""
    folder = tmp_path_factory.mktemp("samples")
    (folder / "R1.fret").write_text("whenever p the r shall immediately satisfy q")
    (folder / "bindings.toml").write_text(BINDINGS)
    source = write(folder, folder / "package", "ros2-cpp-package") / "src"
    live = World().process().load(write(folder, folder / "package"), "perception")
    (folder / "driver.cpp").write_text(DRIVER)
    in_cpp = ["-Wall", "-Wextra", "-Werror", *CHECKED_IN_CPP, f"-I{source}"]
    return compiled(folder, source, folder / "driver.cpp", CHECKED_IN_CPP, in_cpp), live


ranges = st.sampled_from([0.0, 0.25, 0.5, 1.0, 3.0, 50.0, math.inf, -math.inf, math.nan])


@pytest.mark.slow
@examples(12)
@given(
    st.lists(ranges, max_size=5),
    st.lists(st.booleans(), max_size=3),
    st.sampled_from([0, 1, -(2**53) - 1, 2**62 + 1]),
    st.sampled_from(["idle", "moving", "mov", ""]),
    st.sampled_from([0, 7, 8]),
    st.sampled_from([0.25, 0.5]),
)
def test_a_sample_is_that_of_python(
    built: tuple[Path, Any],
    ranges: list[float],
    flags: list[bool],
    count: int,
    mode: str,
    level: int,
    least: float,
) -> None:
    driver, live = built
    beside = {"least": least, "most": 10.0, "angle_min": 0.5, "angle_increment": 0.25}
    message = SimpleNamespace(
        ranges=ranges, flags=flags, count=count, mode=mode, level=level, **beside
    )
    words = [len(ranges), *ranges, len(flags), *map(int, flags), count, level, *beside.values()]
    text = f"{' '.join(map(str, words))}\n{mode}\n"
    ran = subprocess.run([driver], input=text, capture_output=True, text=True, check=True)
    found = [line.split() for line in ran.stdout.splitlines()]
    assert len(found) == len(live.SETTING.policies)
    singles = {"low", "high", "third"}
    for policy, (kind, value, magnitude) in zip(live.SETTING.policies, found, strict=True):
        expected = live.sample(policy, message, policy.name in singles)
        known = kind != "0" and not math.isnan(float(value))
        if expected is None or not known:
            assert (expected is None) is (not known), json.dumps([policy.name, kind, value])
            continue
        assert float(value) == pytest.approx(
            float(expected), abs=1e-9 if policy.name == "gap" else 0
        )
        if isinstance(expected, int):
            assert int(magnitude) == abs(expected)
        is_single = type(expected).__name__ == "Single"
        assert (kind == "1") is is_single

import subprocess
import sys
from importlib.machinery import ModuleSpec

import pytest

import simulation


def test_nothing_is_missing_where_these_tests_run() -> None:
    assert simulation.missing() == ()


def test_what_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def find(name: str) -> ModuleSpec | None:
        return None if name == "rosbags" else ModuleSpec(name, None)

    monkeypatch.setattr(simulation, "find_spec", find)
    assert simulation.missing() == ("rosbags",)


def test_importing_the_package_and_asking_what_is_missing_loads_nothing_heavy() -> None:
    code = (
        "import sys, simulation; simulation.missing(); "
        "print(sorted({'mujoco', 'rosbags', 'numpy', 'mcap'} & set(sys.modules)))"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "[]"

import subprocess
import sys

import pytest

from compiler.emit import TARGETS


@pytest.mark.parametrize("name", TARGETS)
def test_a_target_has_the_name_by_which_it_is_asked_for(name: str) -> None:
    assert TARGETS[name].name == name


def test_the_names_are_there_before_any_target_is() -> None:
    code = (
        "import sys; from compiler.emit import TARGETS; assert 'ltl' in TARGETS and [*TARGETS]; "
        "assert not [name for name in sys.modules if name.startswith('compiler.targets')]"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_name_that_is_none_is_a_missing_key() -> None:
    assert "no such target" not in TARGETS
    assert TARGETS.get("no such target") is None

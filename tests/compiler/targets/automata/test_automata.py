"""The targets about automata as their users meet them."""

from pathlib import Path

from tests.command import Fretc, write

TWO = """+++
id = "A"
+++
whenever p the sw shall within 3 ticks satisfy q
+++
id = "B-1"
+++
in m mode the sw shall eventually satisfy q
"""


def test_each_requirement_has_a_file_of_each_kind(fretc: Fretc) -> None:
    run = fretc(
        write("r.fret", TWO), "--emit", "hoa", "--emit", "dot", "--emit", "smv", "-o", "out"
    )
    assert run.status == 0
    assert sorted(path.name for path in Path("out").iterdir()) == [
        *("a.dot", "a.hoa", "a.smv", "b-1.dot", "b-1.hoa", "b-1.smv")
    ]


def test_where_one_kind_is_refused_the_others_are_written(fretc: Fretc) -> None:
    run = fretc(write("r.fret", TWO), "--emit", "hoa", "--emit", "prism", "-o", "out")
    assert run.status == 2
    assert (
        "F601 PRISM cannot express a requirement without a probability, such as that of A"
        in run.err
    )
    assert (
        "F601 PRISM cannot express a requirement without a probability, such as that of B-1"
        in run.err
    )
    assert sorted(path.name for path in Path("out").iterdir()) == ["a.hoa", "b-1.hoa"]


def test_a_probability_goes_to_prism_only(fretc: Fretc) -> None:
    path = write(
        "p.fret", "whenever p the sw shall with probability >= 0.9 within 2 ticks satisfy q"
    )
    assert fretc(path, "--emit", "prism", "-o", "out").status == 0
    assert sorted(path.name for path in Path("out").iterdir()) == ["p.prism", "p.props"]
    for kind in ("hoa", "dot", "smv"):
        assert fretc(path, "--emit", kind, "-o", "other").status == 2
    assert not Path("other").exists()

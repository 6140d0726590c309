"""White space means the same everywhere in a sentence: any of it may stand where other stands."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretish.diagnostics.source import Source
from fretish.documents import requirements
from fretish.parser import parse
from fretish.syntax import Sentence
from fretish.units import NAMES

SPACES = st.text(" \t\r\n\f\v\u00a0", min_size=1, max_size=3) | st.just("\r\n")
UNITS = st.sampled_from([*(name for name in NAMES if name != "1"), "m/s", "deg/s", "m/s^2", "km/h"])
NUMBERS = st.sampled_from(["0", "30", "0.5", "3.0", "2e3", "1.5e-3"])
MEASURED = st.builds("{} {} {} {}".format, st.sampled_from(["x", '"a b"']),
                     st.sampled_from(["<", ">=", "!=", "= 3 * y +"]), NUMBERS, UNITS)  # fmt: skip
ATOMS = MEASURED | st.sampled_from(["p", "x > 3", "f( x , 1 )", "persisted( 2 , p )", "mode"])
EXPRESSIONS = st.recursive(
    ATOMS,
    lambda each: st.builds(
        "( {} {} {} )".format, each, st.sampled_from(["&", "|", "->", "xor"]), each
    ),
    max_leaves=4,
)
SCOPES = ("", "in m mode , ", "except while m , ", "only before x <= 5 cm , ")
CONDITIONS = ("", "whenever {0} ", "upon {0} is FALSE , ", "when {0} and if p ")
TIMINGS = (
    "", "always ", "within 3 seconds ", "for 10 ticks ", "until {0} ", "at the next timepoint ",
    "with probability >= 0.5 always ",
)  # fmt: skip
SENTENCES = st.builds(
    lambda scope, condition, timing, expression, end: (
        f"{scope}{condition}the sw shall {timing}satisfy {{0}}{end}".format(expression)
    ),
    st.sampled_from(SCOPES),
    st.sampled_from(CONDITIONS),
    st.sampled_from(TIMINGS),
    EXPRESSIONS,
    st.sampled_from(["", " ."]),
)


def tree(text: str) -> Sentence:
    ((only,), diagnostics) = requirements(Source("r.fret", text))
    assert not diagnostics
    found = parse(only.wording)
    assert isinstance(found, Sentence), found
    return found


@pytest.mark.slow
@given(SENTENCES, st.data())
def test_any_white_space_stands_for_any_other(text: str, data: st.DataObject) -> None:
    parts = re.split(r'("[^"]*")', text)  # a name in quotes stays as it is
    spaced = "".join(
        part if i % 2 else re.sub(" ", lambda _: data.draw(SPACES), part)
        for i, part in enumerate(parts)
    )
    around = data.draw(SPACES), data.draw(SPACES)
    assert tree(f"{around[0]}{spaced}{around[1]}") == tree(text)

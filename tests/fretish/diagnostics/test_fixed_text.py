"""A fixed text, and what each of its places was before."""

from hypothesis import given
from hypothesis import strategies as st

from fretish.diagnostics.diagnostic import suggestion
from fretish.diagnostics.fixes import Fix, FixedText, apply_fixes
from fretish.diagnostics.source import Source, Span

SOURCE = Source("r.fret", "0123456789abcdefghij")


@st.composite
def fixed(draw: st.DrawFn) -> FixedText:
    cuts = sorted(draw(st.lists(st.integers(3, 18), max_size=8, unique=True)))
    texts = draw(st.lists(st.text("XYZ", max_size=4), min_size=8, max_size=8))
    pairs = zip(cuts[::2], cuts[1::2], texts, strict=False)
    fixes = [Fix(Span(SOURCE, start, end), text) for start, end, text in pairs]
    found = FixedText(SOURCE.span(2, 20))
    for fix in reversed(fixes):
        found = found.with_fix(fix)
    return found


@given(fixed())
def test_what_no_fix_touches_is_where_it_was(text: FixedText) -> None:
    read = text.span
    assert read.text == apply_fixes(text.original, text.fixes)
    for at, character in enumerate(read.text):
        place = text.place(read.part(at, at + 1))
        if character in "XYZ":
            assert any((m.span.start, m.span.end) == (place.start, place.end) for m in text.fixes)
        else:
            assert place.text == character


@given(fixed(), st.data())
def test_a_place_lies_within_the_original(text: FixedText, data: st.DataObject) -> None:
    read = text.span
    start = data.draw(st.integers(0, read.end))
    place = text.place(read.part(start, data.draw(st.integers(start, read.end))))
    assert 2 <= place.start <= place.end <= 20
    assert place.source is SOURCE


def test_a_fix_in_words() -> None:
    span = SOURCE.span(0, 3)
    assert Fix(span, "a", is_safe=True).help == "write `a`"
    assert Fix(span, "a").help == "did you mean `a`?"
    assert Fix(span, "", is_safe=True).help == "remove `012`"
    assert Fix(span, "").help == "should `012` be removed?"
    assert Fix(span, "a").change == "replaced `012` by `a`"
    assert Fix(span, "").change == "removed `012`"
    assert Fix(span.part(0, 0), "a ").change == "inserted `a`"


@given(st.integers(0, 10**6), st.integers(0, 10**6))
def test_a_suggestion_never_changes_a_number(stated: int, known: int) -> None:
    for shape in ("(battery < {})", "HAZ-{}", "speed{}"):
        near = suggestion(shape.format(stated), [shape.format(known)])
        assert near is None or stated == known


def test_a_suggestion_never_changes_an_operator() -> None:
    assert suggestion("(battery < 20)", ["(battery > 20)", "(battery <= 20)"]) is None
    assert suggestion("(batery < 20)", ["(battery > 20)", "(battery < 20)"]) == "(battery < 20)"

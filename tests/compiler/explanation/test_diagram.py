"""The picture of a sentence against the meaning written down directly, for all templates."""

from collections.abc import Iterator
from dataclasses import asdict
from itertools import pairwise, product
from xml.etree import ElementTree

import pytest

from compiler.explanation.diagram import Diagram, LaneInterval, LaneKind, diagram, words
from compiler.explanation.drawing import drawing, shortened, slots, svg, text
from compiler.explanation.windows import ObligationWindow
from compiler.files.templating import render
from fretish.clock import Clock
from tests import meaning
from tests.monitoring import requirement
from tests.strategies import Template, few_templates, templates

SVG = "{http://www.w3.org/2000/svg}"


def mattering(drawn: Template, picture: Diagram, window: ObligationWindow) -> set[int]:
    """The ticks at which the response can make the difference, where this trigger is alone.

    By brute force: over all responses of the trace, before and after flipping one tick.
    """
    trace, ticks = picture.trace, picture.ticks
    p = [t == window.trigger for t in range(ticks)]

    def judged(bits: int) -> bool:
        q = [bool(bits >> t & 1) for t in range(ticks)]
        return meaning.satisfied(
            drawn.scope, drawn.condition, drawn.timing, drawn.n, trace.m, p, q, trace.s
        )

    verdicts = [judged(bits) for bits in range(1 << ticks)]
    return {
        t
        for t in range(ticks)
        if any(told is not verdicts[bits ^ 1 << t] for bits, told in enumerate(verdicts))
    }


def drawn_for(picture: Diagram, window: ObligationWindow) -> set[int]:
    """The ticks of the lanes that say what this trigger asks for."""
    several = len(picture.windows) > 1
    return {
        t
        for lane in picture.lanes
        if lane.kind is LaneKind.NEED and lane.trigger == (window.trigger if several else None)
        for stretch in lane.stretches
        for t in range(stretch.first, stretch.last + 1)
    }


@pytest.mark.slow
@pytest.mark.parametrize("condition", meaning.CONDITIONS)
@pytest.mark.parametrize("scope", ["null", "in", "after", "before", "onlyAfter"])
def test_the_windows_are_the_ticks_at_which_the_response_matters(
    scope: str, condition: str
) -> None:
    for drawn in few_templates((0, 1)):
        if (drawn.scope, drawn.condition) != (scope, condition):
            continue
        picture = diagram(requirement(drawn.sentence))
        if condition == "null":
            expected = mattering(drawn, picture, picture.windows[0])
            everywhere = set().union(*(drawn_for(picture, w) for w in picture.windows))
            assert everywhere == expected, drawn
            continue
        for window in picture.windows:
            assert drawn_for(picture, window) == mattering(drawn, picture, window), drawn


@pytest.mark.slow
def test_the_triggers_and_the_scope_are_those_of_the_definition() -> None:
    for drawn in templates((2,)):
        picture = diagram(requirement(drawn.sentence))
        lanes = {lane.kind: lane for lane in picture.lanes}
        intervals = list(meaning.intervals(drawn.scope, picture.trace.m))
        scope = [(each.first, each.last) for each in lanes[LaneKind.SCOPE].stretches]
        assert scope == intervals
        expected = [
            t
            for pair in intervals
            for t in meaning.triggers(drawn.condition, picture.trace.p, *pair)
        ]
        assert [each.first for each in lanes[LaneKind.TRIGGER].stretches] == expected


def pictures(counts: tuple[int, ...]) -> Iterator[tuple[Template, Diagram]]:
    for drawn in templates(counts):
        yield drawn, diagram(requirement(drawn.sentence))


@pytest.mark.slow
def test_every_template_has_a_picture_that_is_xml_and_fits() -> None:
    for _, picture in pictures((2,)):
        root = ElementTree.fromstring(svg(picture))
        assert root.get("role") == "img"
        ids = {element.get("id") for element in root.iter()}
        assert set((root.get("aria-labelledby") or "").split()) <= ids
        width, height = (float(root.get(side) or 0) for side in ("width", "height"))
        for bar in root.iter(f"{SVG}rect"):
            x, y = float(bar.get("x", 0)), float(bar.get("y", 0))
            assert 0 <= x <= x + float(bar.get("width") or 0) <= width
            assert 0 <= y <= y + float(bar.get("height") or 0) <= height


def test_templates_that_share_a_picture_mean_the_same() -> None:
    seen: dict[str, set[tuple[str, str, str]]] = {}
    for drawn, picture in pictures((2,)):
        key = (drawn.scope, drawn.condition, drawn.timing.replace("null", "eventually"))
        seen.setdefault(words(picture), set()).add(key)
    assert len(seen) == 258
    for keys in seen.values():
        if len(keys) > 1:
            ((first, condition, timing), (other, same, dual)) = sorted(keys)
            assert (first, other, condition) == ("notin", "onlyIn", same)
            assert {timing, dual} == {"never", "eventually"}


@pytest.mark.slow
@pytest.mark.parametrize("n", [0, 1, 7, 100, 10_000])
def test_any_bound_gives_a_picture_of_few_columns(n: int) -> None:
    for scope, timing in product(("", "in m mode"), ("within", "for", "after")):
        sentence = f"{scope} whenever p sw shall {timing} {n} ticks satisfy q"
        picture = diagram(requirement(sentence, clock=Clock(10**8)))
        columns = slots(picture)
        assert len(columns) <= 24
        assert [slot.first for slot in columns[1:]] == [slot.last + 1 for slot in columns[:-1]]
        assert (columns[0].first, columns[-1].last) == (0, picture.ticks - 1)
        laid = drawing(picture)
        places = sorted((x - 3.5 * len(label), x + 3.5 * len(label)) for x, label in laid.labels)
        assert all(left[1] <= right[0] for left, right in pairwise(places))
        assert max(map(len, text(picture).splitlines())) <= 160


def test_a_picture_in_characters() -> None:
    sentence = "in m mode, when near robot shall within 200 milliseconds satisfy stopped"
    picture = diagram(requirement(sentence, clock=Clock(100_000_000)))
    assert text(picture) == (
        "tick                                 0 1 2 3 4 5 6 7 8 9 …\n"
        "m: true                              · · ─────────── · ·\n"
        "enforced                             · · ━━━━━━━━━━━ · ·\n"
        "near: true                           · · · ─── · · · · ·\n"
        "triggers                             · · · ▲ · · · · · ·\n"
        "2 ticks (200 ms) from tick 3         · · · ├╌╌╌┤ · · · ·\n"
        "stopped: must be true at least once  · · · ▒▒▒▒▒ · · · ·"
    )
    assert words(picture) == (
        "A run of ticks 0 to 9. `m` is true at ticks 2 to 7. The sentence is enforced at ticks 2 "
        "to 7. `near` is true at ticks 3 to 4. It is triggered at tick 3. `stopped` must be true "
        "at least once, at ticks 3 to 5. The run goes on."
    )


def test_the_end_of_a_run_is_drawn_where_it_counts() -> None:
    picture = diagram(requirement("the sw shall finally satisfy q"))
    assert picture.ends
    assert picture.lanes[-1].stretches == (LaneInterval(4, 4),)
    assert "the run ends" in svg(picture)
    assert not diagram(requirement("in m mode, the sw shall finally satisfy q")).ends


def test_names_are_escaped_and_long_ones_shortened_with_the_whole_in_a_title() -> None:
    name = "a<b&'" + "very_long_" * 8 + "end"
    picture = diagram(requirement(f'whenever p sw shall immediately satisfy "{name}"'))
    root = ElementTree.fromstring(svg(picture))
    texts = [element.text or "" for element in root.iter(f"{SVG}text")]
    assert any(told.endswith('_end"') and "…" in told and len(told) <= 34 for told in texts)
    assert f'"{name}"' in [element.text for element in root.iter(f"{SVG}title")]


def test_two_pictures_in_a_page_share_no_name() -> None:
    picture = diagram(requirement("the sw shall eventually satisfy q"))
    first, second = (asdict(drawing(picture, id)) for id in ("one", "two"))
    assert (first["id"], second["id"]) == ("one", "two")
    assert first["rows"] == second["rows"]


def test_a_text_is_shortened_in_its_middle() -> None:
    assert shortened("abcdefgh", 8) == "abcdefgh"
    assert shortened("abcdefghi", 8) == "abc…fghi"


def test_a_page_can_hold_the_drawing_and_escapes_a_name_once() -> None:
    picture = diagram(requirement("whenever a & b sw shall immediately satisfy x < 3"))
    told = render("diagram/diagram.svg.j2", drawing=asdict(drawing(picture, "in-report")))
    assert told.count("a &amp; b") >= 1
    assert "amp;amp" not in told
    assert 'id="in-report-title"' in told

from fretc.report.page.tree import MOST, grouped, pieces, placements, shortened
from fretc.report.sections.argument import Element, ElementKind


def goal(id: str, *below: str, open_: bool = False) -> Element:
    return Element(id, ElementKind.GOAL, f"text of {id}", below, (), open_)


def many(count: int, open_: int) -> list[Element]:
    """A hazard for each ten requirements; the first `open_` requirements are not shown."""
    names = [f"G{n}" for n in range(count)]
    hazards = [goal(f"H{n}", *names[n : n + 10]) for n in range(0, count, 10)]
    leaves = []
    for n, name in enumerate(names):
        is_developed = n >= open_
        leaves.append(goal(name, *([f"Sn{n}"] if is_developed else []), open_=not is_developed))
        if is_developed:
            leaves.append(Element(f"Sn{n}", ElementKind.SOLUTION, "held"))
    return [goal("top", *(each.id for each in hazards)), *hazards, *leaves]


def test_elements_stand_below_what_they_support_contexts_first() -> None:
    top = Element("G", ElementKind.GOAL, "top", ("S",), ("C",))
    elements = [
        top,
        Element("S", ElementKind.STRATEGY, "over", ("H",)),
        Element("C", ElementKind.CONTEXT, "c"),
    ]
    tree = placements([*elements, goal("H")])
    assert [(each.element.id, each.depth, each.relation) for each in tree] == [
        ("G", 0, "support"),
        ("C", 1, "context"),
        ("S", 1, "support"),
        ("H", 2, "support"),
    ]


def test_an_element_under_two_goals_is_drawn_once_and_referred_to_below_the_other() -> None:
    named = Element("X", ElementKind.GOAL, "X holds: p", ("Y",), name="X holds")
    elements = [goal("G", "A", "B"), goal("A", "X"), goal("B", "X"), named, goal("Y")]
    tree = placements(elements)
    assert [(each.element.id, each.depth) for each in tree] == [
        ("G", 0), ("A", 1), ("X", 2), ("Y", 3), ("B", 1), ("X", 2),
    ]  # fmt: skip
    assert [each.is_reference for each in tree] == [False] * 5 + [True]
    assert (tree[2].text, tree[5].text) == ("X holds: p", "X holds: see above")


def test_what_is_against_a_goal_hangs_on_it_and_all_that_rests_on_the_goal_is_in_doubt() -> None:
    elements = [
        goal("G", "A", "B"),
        goal("A", "X", "Z"),
        goal("B", "X"),
        Element("X", ElementKind.GOAL, "x", ("Sn",), ("C",), defeated=True),
        Element("C", ElementKind.CONTEXT, "c"),
        Element("CSn", ElementKind.COUNTER_SOLUTION, "against", challenges="X"),
        Element("Sn", ElementKind.SOLUTION, "sn"),
        goal("Z"),
        Element("CSn2", ElementKind.COUNTER_SOLUTION, "old", challenges="Z"),
    ]
    tree = placements(elements)
    assert [(each.element.id, each.relation, each.state) for each in tree] == [
        ("G", "support", "in doubt"),
        ("A", "support", "in doubt"),
        ("X", "support", "defeated"),
        ("C", "context", ""),
        ("CSn", "challenge", ""),
        ("Sn", "support", ""),
        ("Z", "support", "challenged"),
        ("CSn2", "challenge", ""),
        ("B", "support", "in doubt"),
        ("X", "support", "defeated"),
    ]
    (piece,) = pieces(elements)
    assert [shape["name"] for shape in piece["shapes"] if shape["cross"]] == ["Goal", "Goal"]
    assert [shape["state"][2] for shape in piece["shapes"] if shape["state"]] == [
        each.state for each in tree if each.state
    ]


def test_what_is_against_a_goal_stands_on_its_page() -> None:
    names = [f"G{n}" for n in range(80)]
    against = [
        Element(f"CSn{n}", ElementKind.COUNTER_SOLUTION, "broken " * 20, challenges=f"G{n}")
        for n in range(80)
    ]
    drawing = pieces([goal("top", *names), *(goal(name) for name in names), *against])
    assert len(drawing) > 2
    for piece in drawing[1:]:
        assert [shape["relation"] for shape in piece["shapes"][:2]] == ["support", "challenge"]


def test_each_kind_has_its_shape_and_an_open_goal_its_diamond() -> None:
    elements = [
        Element("G", ElementKind.GOAL, "g", ("S", "Sn"), ("C", "A", "J"), undeveloped=True),
        Element("CSn", ElementKind.COUNTER_SOLUTION, "csn", challenges="G"),
        Element("S", ElementKind.STRATEGY, "s"),
        Element("Sn", ElementKind.SOLUTION, "sn"),
        Element("C", ElementKind.CONTEXT, "c"),
        Element("A", ElementKind.ASSUMPTION, "a"),
        Element("J", ElementKind.JUSTIFICATION, "j"),
    ]
    (piece,) = pieces(elements)
    shapes = {shape["kind"]: shape for shape in piece["shapes"]}
    assert set(shapes) == {kind.name.lower() for kind in ElementKind}
    assert len({shape["path"] for shape in piece["shapes"]}) == 7
    letters = {kind: shape["letter"][2] for kind, shape in shapes.items() if shape["letter"]}
    assert letters == {"assumption": "A", "justification": "J"}
    assert [kind for kind, shape in shapes.items() if shape["diamond"]] == ["goal"]
    assert {kind for kind, shape in shapes.items() if shape["relation"] == "context"} == {
        "context",
        "assumption",
        "justification",
    }


def test_a_small_argument_is_drawn_as_it_is() -> None:
    elements = many(10, 5)
    assert shortened(elements) == tuple(elements)


def test_of_a_large_argument_only_what_is_not_shown_is_drawn() -> None:
    kept = shortened(many(200, 15))
    assert [each.id for each in kept] == ["top", "H0", "H10", *(f"G{n}" for n in range(15))]
    assert kept[2].supported_by == tuple(f"G{n}" for n in range(10, 15))


def test_of_a_large_argument_what_is_challenged_comes_before_what_is_open() -> None:
    last = Element("CSn", ElementKind.COUNTER_SOLUTION, "against", challenges="G999")
    kept = shortened([*many(1000, 1000), last])
    assert {"top", "H990", "G999", "CSn"} <= {each.id for each in kept}
    assert len(kept) == MOST
    ids = [each.element.id for each in placements(kept)]
    assert {"G999", "CSn"} <= set(ids)


def test_of_a_large_argument_what_is_challenged_is_drawn_though_it_is_developed() -> None:
    last = Element("CSn", ElementKind.COUNTER_SOLUTION, "against", challenges="G150")
    kept = shortened([*many(200, 0), last])
    assert [each.id for each in kept] == ["top", "H150", "G150", "CSn"]


def test_never_more_elements_are_drawn_than_stated() -> None:
    assert len(shortened(many(1000, 1000))) == MOST


def test_a_long_argument_is_drawn_in_pieces_of_a_page() -> None:
    drawing = pieces(many(40, 0))
    assert len(drawing) > 1
    assert all(piece["height"] <= 900 for piece in drawing)
    assert sum(len(piece["shapes"]) for piece in drawing) == len(many(40, 0))


def test_many_assumptions_are_drawn_as_one() -> None:
    assumed = [Element(f"A_{n}", ElementKind.ASSUMPTION, "a") for n in range(9)]
    around = ("C", *(each.id for each in assumed))
    top = Element("G", ElementKind.GOAL, "top", (), around)
    elements = grouped([top, Element("C", ElementKind.CONTEXT, "c"), *assumed])
    assert [each.text for each in elements] == ["top", "9 assumptions, listed below", "c"]
    assert len(elements[0].in_context_of) == 2


def test_a_long_text_ends_with_an_ellipsis_and_never_leaves_its_shape() -> None:
    (piece,) = pieces([Element("G", ElementKind.GOAL, "word " * 500 + "x" * 400)])
    lines = [line for _, _, line in piece["shapes"][0]["lines"]]
    assert len(lines) == 3
    assert lines[2].endswith("…")
    assert max(map(len, lines)) < 90

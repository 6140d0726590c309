import base64
import hashlib
import json
import re
from collections import Counter
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path

import pytest

from compiler.files.templating import template_root
from fretc.report.front import front
from fretc.report.model.front import Figure, FigureLine
from tests.effort import FULL
from tests.fretc.report.cases import (
    BINDINGS,
    HAZARDS,
    ODOM,
    R1,
    as_html,
    moment,
    project,
    report_of,
    requirement,
    result,
    violation,
)

VOID = {"meta", "line", "rect", "br"}


class Page(HTMLParser):
    """What a page is made of; it fails where an element is closed in the wrong order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] not in ("style", "script"):
            self.words.append(data)

    def of(self, *tags: str) -> list[dict[str, str | None]]:
        return [attributes for tag, attributes in self.elements if tag in tags]

    @property
    def text(self) -> str:
        return "".join(self.words)


def drawings(parsed: Page) -> list[dict[str, str | None]]:
    """All but the one that only holds a pattern."""
    return [a for a in parsed.of("svg") if a.get("aria-hidden") != "true"]


@pytest.fixture(scope="module")
def html(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Satisfied, violated, suspect, not formalized, and not audited."""
    folder = tmp_path_factory.mktemp("page")
    known = project(
        folder,
        R1,
        requirement("R2", "when near the robot shall within 3 ticks satisfy stopped"),
        requirement("R3", "the robot shall alwys satisfy stopped", parents=["HAZ-9"]),
        requirement("R4", "the robot shall always satisfy other", parents=[], verify=["ajpf"]),
    )
    report = report_of(
        known,
        folder,
        result(known, "satisfied", unknown=[[3, 4]]),
        result(known, "violated", "R2", violations=[violation(14, 20, 11)], open=[moment(90)]),
        result(known, "satisfied", "R2", run="b.mcap", hashes={"bindings": "0" * 64}),
    )
    return as_html(report)


def test_the_page_needs_nothing_but_itself(html: str) -> None:
    html = html.replace('xmlns="http://www.w3.org/2000/svg"', "")
    for word in ("http://", "https://", "src=", "<link", "<img", "@import"):
        assert word not in html
    assert set(re.findall(r"url\((.)", html)) == {"#"}


def test_only_the_script_and_the_style_of_the_page_may_run(html: str) -> None:
    (policy,) = re.findall(r'Content-Security-Policy" content="(.*?)"', html)
    allowed = dict(part.split("-src ") for part in policy.split("; ") if "-src " in part)
    for tag, count in (("script", 1), ("style", 2)):  # the second style is that of the sheets
        texts = re.findall(f"<{tag}>(.*?)</{tag}>", html, re.DOTALL)
        digests = [base64.b64encode(hashlib.sha256(text.encode()).digest()) for text in texts]
        assert allowed[tag] == " ".join(f"'sha256-{digest.decode()}'" for digest in digests)
        assert len(texts) == count
    assert allowed["default"] == "'none'"
    assert not re.search(r"<[^>]* (style|on\w+)=", html)


def test_the_page_is_well_formed_and_its_links_lead_somewhere(html: str) -> None:
    parsed = Page(html)
    ids = Counter(a["id"] for _, a in parsed.elements if "id" in a)
    assert max(ids.values()) == 1
    targets = {str(a["href"]) for a in parsed.of("a")}
    assert "#req-R2" in targets
    assert "#result-R2.2" in targets
    assert {target.removeprefix("#") for target in targets} <= set(ids)
    names = ("aria-labelledby", "aria-describedby")
    labels = [str(a[name]).split() for a in drawings(parsed) for name in names if name in a]
    assert labels
    assert {id for pair in labels for id in pair} <= set(ids)


def test_the_page_can_be_read_by_machine_and_ear(html: str) -> None:
    parsed = Page(html)
    assert parsed.of("html") == [{"lang": "en"}]
    levels = [int(level) for level in re.findall(r"<h([1-6])", html)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after <= before + 1 for before, after in pairwise(levels))
    assert len(parsed.of("caption")) == len(parsed.of("table"))
    assert {a.get("scope") for a in parsed.of("th")} == {"row", "col", "rowgroup", "colgroup"}
    assert {a.get("role") for a in drawings(parsed)} == {"img", "group"}  # of links
    assert all("aria-describedby" in a or "aria-labelledby" in a for a in drawings(parsed))


def test_a_verdict_is_a_word_and_a_sign_not_only_a_colour(html: str) -> None:
    for glyph, word in (
        ("✔", "satisfied"),
        ("✘", "violated"),
        ("⚠", "suspect"),
        ("!", "unformalized"),
    ):
        assert f'<span class="glyph" aria-hidden="true">{glyph}</span>{word}</span>' in html


def test_the_parts_stand_in_their_order(html: str) -> None:
    assert re.findall(r"<h2>(.*?)</h2>", html) == [
        "The matrix",
        "Violated requirements",
        "Requirements that are not shown, and why",
        "What changed since the review",
        "Across runs",
        "The requirements",
        "Can the runs be trusted?",
        "The assurance argument",
        "Assumptions, reviews, reproduction, hashes",
    ]


def test_what_the_bindings_declare_of_unknown_values_is_called_no_default(tmp_path: Path) -> None:
    declared = BINDINGS.replace('agg = "any"', 'agg = "any"\non_unknown = false')
    known = project(tmp_path, bindings=declared)
    text = Page(report_of(known, tmp_path, result(known, "satisfied")).html or "").text
    assert "What the verdicts assume: defaults, and values that the bindings declare." in text
    assert (
        "proposition near: where its signals are unknown it counts as false, as the bindings "
        "declare"
    ) in text


def test_a_requirement_that_no_run_can_violate_says_so_beside_its_verdict(tmp_path: Path) -> None:
    known = project(tmp_path)
    text = Page(report_of(known, tmp_path, result(known, "satisfied")).html or "").text
    places = ("headline", "reservations", "section", "argument")
    assert text.count("No run can violate R1: it sets no bound") == len(places)
    assert "no run can violate it" in text


def test_a_violation_has_its_picture_and_its_values(html: str) -> None:
    text = Page(html).text
    late = "stopped was false from 1.1 s to 2.1 s, but had to be true by 1.4 s"
    cause = f"{late}; at 1.4 s clearance was unknown"
    old = "0.0318 m is 400 ms old, and valid for 300 ms"
    assert f"Violation 1. {cause}: {old} and vx was unknown." in text
    assert "From 0 s to 2 s: 2 ticks with a trigger (1 s to 1.2 s)" in text
    assert (
        "clearance is 0.0318 m, threshold < 0.05 m, unknown for 1.4 s, infinite for 300 ms." in text
    )
    assert f"clearance = unknown: {old}" in text
    assert "vx = unknown" in text


def test_a_violation_leads_to_its_log_where_a_viewer_is_configured(tmp_path: Path) -> None:
    address = "https://logs.example.org/?log={log}&t={seconds}"
    (tmp_path / "fretc.toml").write_text(f'viewer = "{address}"\n', encoding="utf-8")
    known = project(tmp_path, R1)
    events = [violation(14, 20, 11), violation(24, 30, 21)]
    runs = [result(known, "violated", run='runs/a&"<b>.mcap', violations=events)]
    links = [a for a in Page(as_html(report_of(known, tmp_path, *runs))).of("a") if "rel" in a]
    start = "https://logs.example.org/?log=runs/a%26%22%3Cb%3E.mcap&t="
    assert [(a["rel"], a["href"]) for a in links] == [
        ("noreferrer", f"{start}2.400000000"),
        ("noreferrer", f"{start}3.400000000"),
    ]


def test_colours_can_be_read_on_their_paper() -> None:
    css = (template_root() / "report" / "style.css.j2").read_text(encoding="utf-8")
    light, dark = re.findall(r"color-scheme: (?:light dark|dark)\W(.*?)\}", css, re.DOTALL)[:2]
    for scheme in (light, dark):
        colours = dict(re.findall(r"--(\w+): (#[0-9a-f]{6})", scheme))
        for name in ("ink", "soft", "link", "good", "bad", "open", "violet"):
            for paper in ("paper", "faint"):
                assert _contrast(colours[name], colours[paper]) >= 4.5, (name, paper)
        assert _contrast(colours["wait"], colours["paper"]) >= 3


def _contrast(one: str, other: str) -> float:
    """Source: Web Content Accessibility Guidelines 2.2, contrast ratio."""
    light, dark = sorted((_luminance(one), _luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def _luminance(colour: str) -> float:
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


# Hostile texts ---------------------------------------------------------------------------------

HOSTILE = [
    "<script>alert(1)</script>",
    "</style></title><svg onload=x>",
    "\"' onmouseover='x' &amp; {{ 7*7 }} {% raw %}",
    "\u202egnp.exe\u202c \u2066\u200f",
    "שלום עולם",
    "x" * 10_000,
]


@pytest.mark.slow
def test_no_text_leaves_its_place(tmp_path: Path) -> None:
    """Wherever a text comes in, the page has the same elements as with a harmless one."""
    harmless = shape(_everywhere(tmp_path / "harmless", "harmless"))
    for place, text in enumerate(HOSTILE):
        hostile = _everywhere(tmp_path / str(place), text)
        assert shape(hostile) == harmless, text
        assert not re.search("[\u202a-\u202e\u2066-\u2069\u200e\u200f\x00-\x08]", hostile)
        text_of_page = Page(hostile).text
        assert text_of_page.count(text if text.isprintable() else "gnp.exe") >= 10


def shape(html: str) -> list[tuple[str, list[str]]]:
    """All elements in their order; a long text of a drawing may have more lines.

    Text with other letters than ASCII is isolated, by an element of its own.
    """
    elements = [(tag, sorted(a)) for tag, a in Page(html).elements]
    return [each for each in elements if each not in (("text", ["x", "y"]), ("bdi", []))]


def _everywhere(folder: Path, text: str) -> str:
    """A report with the text in every place that takes any text."""
    quoted = json.dumps(text)
    known = project(
        folder,
        requirement(
            "R1",
            "whenever near the robot shall eventually satisfy stopped",
            title=text,
            text=text,
            rationale=text,
            parents=["HAZ-1", text],
            verify=["audit", text],
        ),
        bindings=BINDINGS.replace('"an obstacle is near"', quoted),
        hazards=HAZARDS.replace('"The robot hits something"', quoted).replace(
            '"A drum can break."', quoted
        ),
    )
    finding = {"code": "F404", "severity": "note", "message": text, "help": text}
    place = {"file": text, "line": None, "column": None}
    report = report_of(
        known,
        folder,
        result(
            known,
            "violated",
            run=text,
            reason=text,
            clock=text,
            assumptions=[text],
            violations=[{**violation(1, 2), "values": {text: 1.0}}],
            units={text: text},
            health={"findings": [{**finding, **place}], "topics": {text: {**ODOM, "type": text}}},
        ),
        result(known, "satisfied", id="R0" if text == "harmless" else text),
    )
    return as_html(report)


def test_backticks_set_code_where_they_come_in_pairs(tmp_path: Path) -> None:
    known = project(tmp_path, R1.replace("near", "near`"))
    report = report_of(known, tmp_path)
    assert "<code>eventually</code>" in _everywhere(tmp_path, "any")
    assert "near`" in Page(as_html(report)).text


def test_a_command_in_a_figure_of_the_first_screen_is_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = (FigureLine("only need `fretc analyze`", (), 0),)
    figure = Figure("changed", 1, "changed", "", "changes", lines)
    monkeypatch.setattr(front, "_changed", lambda *_: figure)
    page = as_html(report_of(project(tmp_path), tmp_path))
    assert "<p>only need <code>fretc analyze</code></p>" in page


def test_right_to_left_text_is_isolated(tmp_path: Path) -> None:
    assert "<bdi>שלום עולם</bdi>" in _everywhere(tmp_path, "שלום עולם")


def test_direction_marks_are_shown_as_escapes(tmp_path: Path) -> None:
    page = _everywhere(tmp_path, "a\u202eb")
    assert "a\\u202eb" in page
    assert "a\u202eb" not in page


@pytest.mark.slow
def test_a_hundred_thousand_triggers_fit_into_a_small_page(tmp_path: Path) -> None:
    """By default a tenth of them."""
    known = project(tmp_path)
    ticks = 200_000 if FULL else 20_000
    triggers = [moment(tick) for tick in range(0, ticks, 2)]
    report = report_of(
        known, tmp_path, result(known, "satisfied", ticks=ticks, triggers=triggers, latencies_s=[])
    )
    assert len(as_html(report)) < 85_000

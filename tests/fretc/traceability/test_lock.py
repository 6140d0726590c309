import pytest

from fretc.traceability.chain import ChainItem
from fretc.traceability.lock import Lock, Review, read, text
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.command import write

SHA = "ab" * 32
REVIEW = Review(
    "R-1.a",
    'A. "Quoted" Meier',
    "safety engineer",
    "2026-11-22",
    "näher\nals 5 cm",
    {ChainItem("sentence", "R-1.a"): SHA, ChainItem("verdict", "R-1.a runs/a b.mcap"): SHA},
    {"runs/a b.mcap": "violated"},
)


@pytest.fixture(autouse=True)
def _here(tmp_path: object, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(str(tmp_path))


def test_a_lock_that_is_written_is_read_as_it_was() -> None:
    lock = Lock({"R-1.a": REVIEW})
    assert read(write("fretc.lock", text(lock))) == lock


def test_a_lock_is_sorted_whatever_the_order_of_its_reviews() -> None:
    other = Review("A", "r", "s", "2026-01-02", "c", {}, {})
    one, two = Lock({"R-1.a": REVIEW, "A": other}), Lock({"A": other, "R-1.a": REVIEW})
    assert text(one) == text(two)
    assert text(one).index("[review.A]") < text(one).index("R-1.a")


def test_no_lock_is_a_note() -> None:
    diagnostic = read("fretc.lock")
    assert isinstance(diagnostic, Diagnostic)
    assert (diagnostic.code, diagnostic.is_error) == (Code.NO_SUCH_FILE, False)


GOOD = text(
    Lock({"R1": Review("R1", "r", "s", "2026-01-02", "c", {ChainItem("text", "R1"): SHA}, {})})
)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"fretc-lock-3"', '"fretc-lock-9"', "the lock does not have the schema `fretc-lock-3`"),
        ('reviewer = "r"', "", "the review of R1 has no `reviewer`"),
        ('reviewer = "r"', "reviewer = 1", "the review of R1 has no `reviewer`"),
        ('"2026-01-02"', '"2026-13-02"', "`2026-13-02` is not a date"),
        (SHA, "xy", "`text:R1` of R1 is not a fingerprint"),
        ('"text:R1"', '"text"', "`text` of R1 is not a fingerprint"),
        (
            "[review.R1.verdicts]",
            "[review.R1.verdicts]\na = 1",
            "`verdicts` of R1 must be a table of texts",
        ),
        ("schema", "R2 = 1\nschema", "`R2` is not a field of the lock"),
        ("[review.R1]", "[review]\nR2 = 1\n[review.R1]", "`R2` is not a review"),
        (
            "[review.R1]",
            "[review.R1",
            "the lock is not TOML: expected ']' at the end of a table declaration",
        ),
    ],
)
def test_a_lock_that_was_changed_by_hand_is_reported(old: str, new: str, message: str) -> None:
    assert old in GOOD
    diagnostic = read(write("fretc.lock", GOOD.replace(old, new, 1)))
    assert isinstance(diagnostic, Diagnostic)
    assert diagnostic.code is Code.BAD_LOCK
    assert diagnostic.message == message
    assert diagnostic.span is not None


EDITS = [
    ('reviewer = "r"', 'reviewer = "somebody else"'),
    ('role = "s"', 'role = "t"'),
    ('date = "2026-01-02"', 'date = "2026-01-03"'),
    ('comment = "c"', 'comment = "d"'),
    ('"a.mcap" = "violated"', '"a.mcap" = "satisfied"'),
    ('"a.mcap" = "violated"', '"b.mcap" = "violated"'),
    ('"a.mcap" = "violated"', ""),
    (SHA, SHA[::-1]),
    ("text:R1", "text:R2"),
    ("[review.R1]", "[review.R2]"),
]


@pytest.mark.parametrize(("old", "new"), EDITS)
def test_a_review_that_was_edited_by_hand_does_not_count(old: str, new: str) -> None:
    prints = {ChainItem("text", "R1"): SHA}
    known = text(
        Lock({"R1": Review("R1", "r", "s", "2026-01-02", "c", prints, {"a.mcap": "violated"})})
    )
    assert old in known
    changed = known.replace(old, new)
    changed = changed.replace("[review.R1.", "[review.R2.") if "R2]" in new else changed
    diagnostic = read(write("fretc.lock", changed))
    assert isinstance(diagnostic, Diagnostic)
    assert diagnostic.code is Code.BAD_LOCK
    assert diagnostic.message.endswith("was edited after `fretc lock` wrote it")


@pytest.mark.parametrize(
    ("day", "counts"),
    [("2023-11-14", True), ("2023-11-15", True), ("2023-11-16", False), ("2123-01-01", False)],
)
def test_a_review_of_a_day_to_come_does_not_count(
    monkeypatch: pytest.MonkeyPatch, day: str, counts: bool
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")  # 2023-11-14, 22:13: the 15th in the east
    lock = read(write("fretc.lock", text(Lock({"R1": Review("R1", "r", "s", day, "c", {}, {})}))))
    if counts:
        assert isinstance(lock, Lock)
    else:
        assert isinstance(lock, Diagnostic)
        assert lock.message == f"the review of R1 is of {day}, a date in the future"


@pytest.mark.parametrize("id", ["schema", "review", "fingerprints", "verdicts", "seal", "date"])
def test_a_requirement_may_have_any_id(id: str) -> None:
    review = Review(id, "r", "s", "2026-01-02", "c", {ChainItem("text", id): SHA}, {})
    lock = Lock({id: review, "R1": Review("R1", "r", "s", "2026-01-02", "c", {}, {})})
    assert read(write("fretc.lock", text(lock))) == lock


@pytest.mark.parametrize("first", ['schema = "fretc-lock-2"', "[schema]"])
def test_a_lock_of_an_earlier_version_is_refused(first: str) -> None:
    diagnostic = read(write("fretc.lock", f'{first}\n\n[R1]\nreviewer = "r"\n'))
    assert isinstance(diagnostic, Diagnostic)
    assert (diagnostic.code, diagnostic.message) == (
        Code.BAD_LOCK,
        "the lock does not have the schema `fretc-lock-3`",
    )

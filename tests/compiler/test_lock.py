import pytest

from compiler.links import Node
from compiler.lock import Lock, Review, read, text
from fretish.diagnostic import Code, Diagnostic
from tests.command import write

SHA = "ab" * 32
REVIEW = Review(
    "R-1.a",
    'A. "Quoted" Meier',
    "safety engineer",
    "2026-11-22",
    "näher\nals 5 cm",
    {Node("sentence", "R-1.a"): SHA, Node("verdict", "R-1.a runs/a b.mcap"): SHA},
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
    assert text(one).index("[A]") < text(one).index("R-1.a")


def test_no_lock_is_a_note() -> None:
    found = read("fretc.lock")
    assert isinstance(found, Diagnostic)
    assert (found.code, found.is_error) == (Code.NO_SUCH_FILE, False)


GOOD = text(Lock({"R1": Review("R1", "r", "s", "2026-01-02", "c", {Node("text", "R1"): SHA}, {})}))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"fretc-lock-1"', '"fretc-lock-9"', "the lock is not of the form `fretc-lock-1`"),
        ('reviewer = "r"', "", "the review of R1 has no `reviewer`"),
        ('reviewer = "r"', "reviewer = 1", "the review of R1 has no `reviewer`"),
        ('"2026-01-02"', '"2026-13-02"', "`2026-13-02` is no date"),
        (SHA, "xy", "`text:R1` of R1 is no fingerprint"),
        ('"text:R1"', '"text"', "`text` of R1 is no fingerprint"),
        ("[R1.verdicts]", "[R1.verdicts]\na = 1", "`verdicts` of R1 must be a table of texts"),
        ("schema", "R2 = 1\nschema", "`R2` is no review"),
        ("[R1]", "[R1", "the lock is not TOML: expected ']' at the end of a table declaration"),
    ],
)
def test_a_lock_that_was_changed_by_hand_is_told(old: str, new: str, message: str) -> None:
    assert old in GOOD
    found = read(write("fretc.lock", GOOD.replace(old, new, 1)))
    assert isinstance(found, Diagnostic)
    assert found.code is Code.BAD_LOCK
    assert found.message == message
    assert found.span is not None

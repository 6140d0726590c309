import pytest

from fretc.report.model import phrases


@pytest.mark.parametrize(
    ("count", "text"), [(0, "0 runs"), (1, "1 run"), (2, "2 runs"), (12345, "12\u202f345 runs")]
)
def test_a_count_has_its_noun(count: int, text: str) -> None:
    assert phrases.times(count, "run") == text


@pytest.mark.parametrize(
    ("words", "text"),
    [([], ""), (["a"], "a"), (["a", "b"], "a and b"), (["a", "b", "c"], "a, b and c")],
)
def test_words_are_joined_as_in_a_sentence(words: list[str], text: str) -> None:
    assert phrases.joined(words) == text


def test_many_words_are_counted() -> None:
    assert phrases.some(list("abcdefghij"), most=2) == "a, b and 8 more"
    assert phrases.some(list("abc"), most=2) == "a, b and c"


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (0.0, "0"),
        (-0.0001, "0"),
        (39.8, "39.8"),
        (0.0014, "0.001"),
        (100.0, "100"),
        (12345.5, "12\u202f345.5"),
        (1e18, "1e+18"),
    ],
)
def test_a_decimal_says_no_more_than_it_must(number: float, text: str) -> None:
    assert phrases.decimal(number) == text


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("traces/a.mcap", "traces/a.mcap"),
        ("../a.mcap", "../a.mcap"),
        ("/data/somebody/a.mcap", "a.mcap"),
        ("C:\\data\\a.mcap", "a.mcap"),
        ("\\\\host\\share\\a.mcap", "a.mcap"),
    ],
)
def test_of_an_absolute_path_only_the_name_is_shown(path: str, text: str) -> None:
    assert phrases.place(path) == text


@pytest.mark.parametrize(
    ("count", "text"),
    [
        (None, "not known"),
        (1, "1 byte"),
        (1_852_914, "1.85 MB (1\u202f852\u202f914 bytes)"),
        (2_000, "2 kB (2\u202f000 bytes)"),
    ],
)
def test_a_size_is_given_round_and_exact(count: int | None, text: str) -> None:
    assert phrases.size(count) == text


def test_counts_of_none_one_and_two_have_their_own_words() -> None:
    counts = [phrases.times(count, "run") for count in (0, 1, 2)]
    assert counts == ["0 runs", "1 run", "2 runs"]
    counts = [phrases.times(count, "latency", "latencies") for count in (0, 1, 2)]
    assert counts == ["0 latencies", "1 latency", "2 latencies"]
    whole = [phrases.every(count, "run") for count in (0, 1, 2)]
    assert whole == ["no run", "the only run", "all 2 runs"]


def test_an_instant_is_universal_time() -> None:
    assert phrases.instant(1_700_000_000_041_200_000) == "2023-11-14 22:13:20.041 UTC"
    assert phrases.instant(None) == "not known"
    assert phrases.instant(2**63 - 1) == "2262-04-11 23:47:16.854 UTC"


@pytest.mark.parametrize(
    ("text", "visible"),
    [
        ("plain – text ✔ שלום", "plain – text ✔ שלום"),  # noqa: RUF001
        ("a\u202eb", "a\\u202eb"),
        ("a\x00b\x1b", "a\\x00b\\x1b"),
        ("line\nline\tend", "line\nline end"),
        ("\ud800", "\\ud800"),
        ("zero\u200bwidth", "zero\\u200bwidth"),
    ],
)
def test_no_character_hides(text: str, visible: str) -> None:
    assert phrases.visible(text) == visible

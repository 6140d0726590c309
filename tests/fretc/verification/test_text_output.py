"""What `fretc verify` prints of proofs: nothing that is open or wrong is left out."""

from hypothesis import given
from hypothesis import strategies as st

from compiler.logic.claims import ClaimOutcome, ClaimResult, Layer, Proof, proof
from fretc.commands.verify import _status
from fretc.verification.text_output import SIGNS, lines

ORDER = (
    ClaimResult.COUNTEREXAMPLE,
    ClaimResult.NOT_CHECKED,
    ClaimResult.VACUOUS,
    ClaimResult.PROVED,
    ClaimResult.NOT_APPLICABLE,
)


@st.composite
def proofs(draw: st.DrawFn) -> list[Proof]:
    """Each with a claim of its own."""
    drawn = draw(
        st.lists(
            st.tuples(st.sampled_from(("A", "B1", "CCC")), st.sampled_from(Layer), results),
            min_size=1,
            max_size=12,
        )
    )
    return [
        proof(id, layer, f"claim {number}.", ClaimOutcome(result, f"reason {number}"), "fretc")
        for number, (id, layer, result) in enumerate(drawn)
    ]


results = st.sampled_from(ClaimResult)


@given(proofs())
def test_the_table_has_the_worst_result_of_each_cell(drawn: list[Proof]) -> None:
    cells = {(each.requirement, each.layer) for each in drawn}
    text = [line for line, _ in lines(drawn)]
    if len(cells) == 1:
        assert len(text) == len(drawn)
        return
    head = text[0]
    rows = {line.split()[0]: line for line in text[1 : 1 + len({id for id, _ in cells})]}
    for id, layer in cells:
        own = [one.result for one in drawn if (one.requirement, one.layer) == (id, layer)]
        place = head.index(str(layer))
        worst = min(own, key=ORDER.index)
        assert rows[id][place] == SIGNS[worst].glyph


@given(proofs(), st.booleans())
def test_each_claim_that_is_not_proved_is_listed_worst_first(
    drawn: list[Proof], every_claim: bool
) -> None:
    text = "\n".join(line for line, _ in lines(drawn, every_claim=every_claim))
    cells = {(each.requirement, each.layer) for each in drawn}
    closed = (ClaimResult.PROVED, ClaimResult.NOT_APPLICABLE)
    for one in drawn:
        expected = every_claim or len(cells) == 1 or one.result not in closed
        assert text.count(one.claim) == expected, one
    listed = sorted((one for one in drawn if one.claim in text), key=lambda o: text.index(o.claim))
    ranks = [ORDER.index(one.result) for one in listed]
    assert ranks == sorted(ranks)


@given(proofs())
def test_where_nothing_is_open_a_requirement_is_a_line(drawn: list[Proof]) -> None:
    fine = [one for one in drawn if one.result in (ClaimResult.PROVED, ClaimResult.NOT_APPLICABLE)]
    rows = {one.requirement for one in fine}
    cells = {(one.requirement, one.layer) for one in fine}
    if len(cells) > 1:
        assert len([*lines(fine)]) <= 1 + len(rows) + 2


@given(proofs())
def test_the_status_is_that_of_the_worst_claim_that_applies(drawn: list[Proof]) -> None:
    worst = min((one.result for one in drawn), key=ORDER.index)
    expected = {ClaimResult.COUNTEREXAMPLE: 1, ClaimResult.NOT_CHECKED: 3, ClaimResult.VACUOUS: 3}
    assert _status(drawn) == expected.get(worst, 0)

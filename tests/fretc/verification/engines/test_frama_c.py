# ruff: noqa: E501
"""Frama-C: what is believed of its output; what it says of each template, and of planted faults."""

import os
import re
from dataclasses import replace
from pathlib import Path

import pytest

from compiler.files.build_id import __version__
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import (
    SCHEMA,
    ClaimOutcome,
    ClaimResult,
    Layer,
    Proof,
    VerificationDocument,
    proof,
    proved,
)
from compiler.project.folder import load
from fretc.reproduction.outcome import ItemOutcome
from fretc.reproduction.proofs import prove_again
from fretc.verification.c.analysis import analysed, prepared
from fretc.verification.c.language import checked
from fretc.verification.engines.frama_c import EvaInput, answer
from fretc.verification.engines.sandbox import CallLimits
from fretc.verification.layers.frama_c import CLAIM
from fretc.verification.reader import Proofs, read
from tests import meaning
from tests.command import Fretc, write
from tests.compiled_monitors import given_c as given
from tests.each import each
from tests.effort import full_only, some
from tests.monitoring import requirement
from tests.programs import installed, needs
from tests.strategies import templates

LIMITS = CallLimits(seconds=60)
needs_frama_c = needs("frama-c")

WITHIN = "in m mode whenever p the sw shall within 3 ticks satisfy q"
RING = "only in m upon c the sw shall after 40 ticks satisfy z"


def asked(*requirements: FormalizedRequirement) -> EvaInput:
    own = given(*requirements)
    return prepared(own, checked(own, requirements))


def check(run: EvaInput) -> ClaimOutcome:
    return answer(installed("frama-c"), run, LIMITS)[0]


# What is right --------------------------------------------------------------------------------


@needs_frama_c
def test_requirements_in_one_text_are_proved() -> None:
    sentences = (WITHIN, RING, "the sw shall always satisfy p", "the sw shall eventually satisfy p")
    outcome = check(
        asked(*(requirement(sentence, f"R{i}") for i, sentence in enumerate(sentences)))
    )
    assert outcome.result is ClaimResult.PROVED, outcome.detail


@needs_frama_c
@full_only("minutes")
@each("scope", meaning.SCOPES)
def test_every_template_is_proved(scope: str) -> None:
    sentences = [each.sentence for each in templates() if each.scope == scope]
    outcome = check(
        asked(*(requirement(sentence, f"R{i}") for i, sentence in enumerate(sentences)))
    )
    assert outcome.result is ClaimResult.PROVED, outcome.detail


@needs_frama_c
@each(
    "sentences",
    [
        ("the sw shall immediately satisfy true",),
        (
            "the sw shall within 2000000000 ticks satisfy p",
            "only in m upon c the sw shall after 2000 ticks satisfy z",
        ),
    ],
)
def test_no_input_and_long_bounds_are_proved(sentences: tuple[str, ...]) -> None:
    """A ring of 2 000 ticks has 63 words, set by a loop."""
    outcome = check(
        asked(*(requirement(sentence, f"R{i}") for i, sentence in enumerate(sentences)))
    )
    assert outcome.result is ClaimResult.PROVED, outcome.detail


# What is wrong --------------------------------------------------------------------------------

BEGIN = "    fretc_reading *reading;\n"
FAULTS = (
    (WITHIN, r"\(approximation->oldest_1 < 4\) \? (\(approximation->oldest_1 \+ 1\)) : 4;", r"\1;", "oldest_1 ≤ 4` after a tick"),
    (WITHIN, r"(approximation->oldest_1 \+ 1\)) : 4;", r"\1 : 5;", "user assertion"),
    (WITHIN, r"approximation->oldest_1 = 0;", "approximation->oldest_1 = -2;", "user assertion"),
    (WITHIN, r"\(3 - approximation->oldest_1\)", "(4 - approximation->oldest_1)", "user assertion"),
    (WITHIN, r"    approximation->oldest_1 = -1;\n    approximation->r1_broken", "    approximation->r1_broken", "initialization"),
    (WITHIN, r"    approximation->r1_broken = false;\n", "", "initialization"),
    (WITHIN, r"    reading->open = .*;\n", "", "initialization"),
    (WITHIN, r"    reading->left = .*;\n", "", "user assertion"),
    (WITHIN, r"(reading->open = )", r"\1 3 / approximation->oldest_1 > 0 ||", "division_by_zero"),
    (WITHIN, r"(reading->open = )", r"\1 (1 << (approximation->oldest_1 + 1 + 29)) > 0 ||", "shift"),
    (WITHIN, r"\Z", "\nvoid r1_more(void);\nvoid r1_more(void)\n{\n    int x[2];\n    x[2] = 0;\n}\n", None),
    (WITHIN, re.escape(BEGIN), f"{BEGIN}    int x[2]; x[approximation->oldest_1] = 0;\n", "index_bound"),
    (WITHIN, re.escape(BEGIN), f"{BEGIN}    approximation = approximation + 1;\n", "mem_access"),
    (WITHIN, re.escape(BEGIN), f"{BEGIN}    for (;;) {{ }}\n", "dead"),
    (WITHIN, re.escape(BEGIN), f"{BEGIN}    extern void more(void); more();\n", "assigns clause"),
    (WITHIN, re.escape(BEGIN), f"{BEGIN}    /*@ admit \\\\false; */\n", "considered valid"),
    (WITHIN, re.escape(BEGIN), f"{BEGIN}    int x = ;\n", "exit status 1"),
    (RING, r"/ 32u\]", "/ 16u]", "ring_since_1_at ≤ 39`"),
    (RING, r"% 32u\)", "% 64u)", "shift"),
    (RING, r"== 39u\)", "== 79u)", "ring_since_1_at ≤ 39`"),
    (RING, r"word < 2u", "word < 3u", "index_bound"),
    (RING, r"word < 2u", "word < 1u", "initialization"),
)  # fmt: skip


@needs_frama_c
@each("fault", some(FAULTS, 7))
def test_a_fault_is_not_proved(fault: tuple[str, str, str, str | None]) -> None:
    """Here the text may have any form; one that is never reached does no harm."""
    sentence, old, new, kind = fault
    run = asked(requirement(sentence))
    assert re.search(old, run.text), old
    outcome = check(replace(run, text=re.sub(old, new, run.text, count=1)))
    if kind is None:
        assert outcome.result is ClaimResult.PROVED
    else:
        assert outcome.result is ClaimResult.NOT_CHECKED
        assert kind in outcome.detail


def test_what_stands_in_comments_is_no_annotation() -> None:
    """`admit` is believed."""
    one = requirement(WITHIN)
    own = given(one)
    for text, header in (
        (own.text.replace(BEGIN, f"{BEGIN}/*@ admit\n \\false; */"), own.header),
        (own.text, own.header.replace("int32_t left;", "/*@ x */ int32_t left;")),
    ):
        monitor = replace(own, text=text, header=header)
        run = prepared(monitor, checked(monitor, [one]))
        assert "@" not in run.text + run.header[1]
        assert run.text.count("\n") == text.count("\n")


def test_a_text_of_another_form_is_refused() -> None:
    one = requirement(WITHIN)
    own = given(one)
    strange = own.text.replace(BEGIN, f"{BEGIN}#ifdef __FRAMAC__\n#endif\n")
    (examined,) = analysed([one], replace(own, text=strange), "", LIMITS)
    assert examined.outcome.result is ClaimResult.NOT_CHECKED
    assert "is not laid out as fretc writes it" in examined.outcome.detail
    assert examined.artefacts.keys() == {own.name, own.header_name}


# A Frama-C that is not one --------------------------------------------------------------------

HEAD = "directory\tfile\tline\tfunction\tproperty kind\tstatus\tproperty\n"
RUN = EvaInput("", ("r.h", ""), "", "entry", (3, 5), 1)
SUMMARY = "No errors or warnings raised during the analysis.\n0 alarms generated by the analysis.\n"


def row(line: int, status: str = "Valid", file: str = "fretc_driver.c") -> str:
    return f".\t{file}\t{line}\tentry\tuser assertion\t{status}\tp\n"


class Fake:
    """A script that writes a report and some output."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def says(self, report: str, output: str = SUMMARY, more: str = "") -> ClaimOutcome:
        (self.folder / "report").write_text(report)
        (self.folder / "output").write_text(output)
        path = self.folder / "frama-c"
        path.write_text(
            '#!/bin/sh\nif [ "$1" = -version ]; then echo "25.0 (Manganese)"; exit 0; fi\n'
            f'cp "{self.folder}/report" properties.csv; cat "{self.folder}/output"\n{more}\n'
        )
        path.chmod(0o755)
        return answer(str(path), RUN, CallLimits(seconds=2))[0]


@pytest.fixture
def fake(tmp_path: Path) -> Fake:
    return Fake(tmp_path)


def test_all_valid_without_alarms_is_proved(fake: Fake) -> None:
    outcome = fake.says(HEAD + row(3) + row(5))
    assert outcome.result is ClaimResult.PROVED
    assert "all 2 assertions" in outcome.detail


WHOLE = HEAD + row(3) + row(5)


@pytest.mark.slow
@each(
    "case",
    [
        (HEAD + row(3), SUMMARY, "", "gives no result for 1 assertions"),
        (HEAD, SUMMARY, "", "gives no result for 2 assertions"),
        ("", SUMMARY, "", "unknown layout"),
        (WHOLE + "x\n", SUMMARY, "", "unknown layout"),
        (HEAD.replace("status", "state") + row(3) + row(5), SUMMARY, "", "unknown layout"),
        (WHOLE.replace("\t5\t", "\tx\t"), SUMMARY, "", "unknown layout"),
        (HEAD + row(3) + row(3), SUMMARY, "", "gives no result for 1 assertions, and 1 more"),
        (HEAD + row(3) + row(5, "Unknown"), SUMMARY, "", "user assertion: unknown"),
        (HEAD + row(3) + row(5, "Dead"), SUMMARY, "", "user assertion: dead"),
        (HEAD + row(3) + row(5, "Considered valid"), SUMMARY, "", "considered valid"),
        (WHOLE + row(9), SUMMARY, "", "no proof of `p`"),
        (WHOLE + row(9, file="fretc_text.c"), SUMMARY, "", "at line 9"),
        (WHOLE, "", "", "gives no reason"),
        (WHOLE, SUMMARY * 2, "", "gives no reason"),
        (WHOLE, SUMMARY.replace("0 alarms", "10 alarms"), "", "gives no reason"),
        (WHOLE, f"[kernel] Warning: no code for f\n{SUMMARY}", "", "Warning: no code for f"),
        (WHOLE, SUMMARY, "exit 1", "exit status 1"),
        (WHOLE, SUMMARY, "kill -SEGV $$", "exit status -11"),
        (WHOLE, "[kernel] User Error: bad\n", "rm properties.csv", "User Error: bad"),
        (WHOLE, SUMMARY, "exec sleep 60", "did not finish within 2 s"),
    ],
)
def test_anything_else_is_not_checked(fake: Fake, case: tuple[str, str, str, str]) -> None:
    report, output, more, reason = case
    outcome = fake.says(report, output, more)
    assert outcome.result is ClaimResult.NOT_CHECKED
    assert reason in outcome.detail


# The command ----------------------------------------------------------------------------------


def test_without_frama_c_the_command_says_how_to_get_it(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    write("r1.fret", "the sw shall always satisfy p")
    result = fretc("verify", "r1.fret", "--monitor", "--with", "frama-c")
    assert result.status == 2
    assert "F908" in result.err
    assert "apt install frama-c-base" in result.err


def test_a_proof_that_cannot_be_made_again_is_not_checked(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Neither standing nor different, where Frama-C is not installed."""
    project = load([write("r1.fret", "the sw shall always satisfy p")])
    (requirement,) = project.formalized
    claim = proof(requirement.id, Layer.MONITOR, CLAIM, proved("as it is"), "Frama-C 25.0, -eva")
    monkeypatch.setenv("PATH", str(tmp_path))
    document = VerificationDocument(SCHEMA, __version__, (claim,))
    found = prove_again(project, Proofs("v.json", "", document), LIMITS, ["r1"], print)
    assert isinstance(found, tuple)
    (again,) = found
    assert again.finding is ItemOutcome.UNKNOWN
    assert "no `frama-c` on the PATH" in again.reasons[0]


def test_a_monitor_in_python_is_none_in_c(
    fretc: Fretc, fake: Fake, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake.says(WHOLE)
    monkeypatch.setenv("PATH", f"{fake.folder}:{os.environ['PATH']}")
    write("r1.fret", "the sw shall always satisfy p")
    fretc("r1.fret", "--emit", "monitor")
    result = fretc("verify", "r1.fret", "--file", "build/r1_monitor.py", "--with", "frama-c")
    assert result.status == 2
    assert "F907" in result.err
    assert "needs a monitor in C" in result.err


@needs_frama_c
def test_the_evidence_names_program_options_and_texts(fretc: Fretc) -> None:
    """Of the text that fretc writes, where no file is named; and of a file of two requirements."""
    sentences = (WITHIN, "the sw shall always satisfy p")
    names = [write(f"r{i}.fret", sentence) for i, sentence in enumerate(sentences)]
    fretc(*names, "--emit", "c", "--one-file")
    for file, own in ((["--file", "build/monitors.c"], "monitors"), ([], "r0_monitor")):
        result = fretc("verify", *names, "--layer", "monitor", "--with", "frama-c", *file)
        assert result.status == 0, result.err
        first, *_ = proofs(Path("build/verification.json"))
        assert first.engine.startswith("Frama-C ")
        assert "-eva-precision=0" in first.engine
        assert first.artefacts.keys() == {f"{own}.c", f"{own}.h", f"{own}_driver.c"}


def proofs(path: Path) -> list[Proof]:
    """Those of Frama-C."""
    found = read(str(path))
    assert isinstance(found, Proofs)
    return [one for one in found.proofs if one.engine.startswith("Frama-C")]

"""Provers: what is believed of what they say; and what the real ones say of what is emitted."""

import os
import re
from collections.abc import Callable, Iterable
from importlib.metadata import PackageNotFoundError
from itertools import cycle
from pathlib import Path

import pytest

from compiler.logic.claims import ClaimOutcome, ClaimResult, Layer, not_checked, proved
from compiler.targets.dafny import text
from fretc.verification.engines import crosshair
from fretc.verification.engines.crosshair import with_crosshair
from fretc.verification.engines.dafny import answer as dafny_answer
from fretc.verification.engines.dafny import with_dafny
from fretish.diagnostics.extras import install_help
from tests.compiler.targets.test_dafny import (
    BINDINGS,
    CONDITIONS,
    TIMINGS,
    bound,
    emitted,
    requirement,
)
from tests.each import each
from tests.effort import FULL, full_only
from tests.loops import edited as replaced
from tests.programs import needs, needs_package
from tests.proofs import outcome

needs_dafny = needs("dafny")
needs_crosshair = needs_package("crosshair")

# A Dafny that is not one ----------------------------------------------------------------------

LEMMAS = "lemma A()\n{\n}\n\nlemma B(x: int)\n  ensures x > 0\n{\n}\n"
FINISHED = "Dafny program verifier finished with"


@pytest.fixture
def dafny(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> "Fake":
    return Fake(tmp_path, monkeypatch)


class Fake:
    """A script of that name on the PATH."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.folder = folder
        monkeypatch.setenv("PATH", f"{folder}:{os.environ['PATH']}")

    def says(
        self, body: str, version: str = "Dafny 2.3.0.10506", text: str = LEMMAS
    ) -> ClaimOutcome:
        old = version.startswith("Dafny")
        newer = "Dafny: Error: unknown switch: --version" if old else version
        script = (
            "#!/bin/sh\n"
            f'if [ "$1" = --version ]; then echo "{newer}"; exit 1; fi\n'
            f'if [ "$1" = /version ]; then echo "{version}"; exit 1; fi\n{body}\n'
        )
        path = self.folder / "dafny"
        path.write_text(script)
        path.chmod(0o755)
        return dafny_answer(text, seconds=2)[0]


def test_all_verified_is_proved(dafny: Fake) -> None:
    assert dafny.says(f'echo "{FINISHED} 2 verified, 0 errors"') == proved(
        "2 parts verified, among them all 2 lemmas and methods"
    )


def test_lines_that_debians_z3_adds_do_not_matter(dafny: Fake) -> None:
    noise = "Prover error: line 18 column 28: unknown parameter 'model_compress'"
    answer = dafny.says(f'echo "{noise}"; echo; echo "{FINISHED} 2 verified, 0 errors"')
    assert answer.result is ClaimResult.PROVED


@pytest.mark.slow
@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("kill -SEGV $$", "Dafny ended with exit status -11 and no verdict"),
        ("echo nonsense", "Dafny ended with exit status 0 and no verdict"),
        ("sleep 60", "Dafny did not finish within 2 s"),
        (
            f'echo "{FINISHED} 1 verified, 0 errors"',
            "Dafny verified 1 parts, but the file has at least 2",
        ),
        (
            f'echo "{FINISHED} 2 verified, 0 errors"; exit 4',
            "Dafny reports 0 errors, and its exit status is 4",
        ),
        (
            f'echo "{FINISHED} 1 verified, 1 error"',
            "Dafny reports 1 errors, and its exit status is 0",
        ),
        (
            f'echo "{FINISHED} 2 verified, 0 errors, 1 time out"',
            "Dafny ended with exit status 0 and no verdict",
        ),
        (
            f'echo "{FINISHED} 2 verified, 0 errors"; echo "{FINISHED} 2 verified, 0 errors"',
            "Dafny ended with exit status 0 and no verdict",
        ),
        (
            'echo "text.dfy(6,10): Error BP5003: A postcondition might not hold."; '
            f'echo "{FINISHED} 2 verified, 0 errors"',
            "Dafny finds no proof of `B` (line 6): A postcondition might not hold",
        ),
        (
            'echo "text.dfy(5,3): Error: closeparen expected"; exit 2',
            "Dafny finds no proof of `B` (line 5): closeparen expected",
        ),
    ],
)
def test_anything_else_is_not_checked(dafny: Fake, body: str, reason: str) -> None:
    assert dafny.says(body) == not_checked(reason)


def test_dafny_4_is_asked_in_its_own_way(dafny: Fake) -> None:
    body = (
        'if [ "$2" = --help ]; then echo "  --allow-warnings  Allow them"; exit 0; fi\n'
        f'[ "$*" = "verify --verification-time-limit=1 --allow-warnings text.dfy" ] || exit 9\n'
        f'echo; echo "{FINISHED} 5 verified, 0 errors"'
    )
    answer = dafny.says(body, version="4.9.1+abc")
    assert answer == proved("5 parts verified, among them all 2 lemmas and methods")


def test_dafny_2_is_asked_in_its_own_way(dafny: Fake) -> None:
    body = (
        '[ "$*" = "/compile:0 /timeLimit:1 text.dfy" ] || exit 9\n'
        f'grep -q "lemma B" text.dfy && echo "{FINISHED} 2 verified, 0 errors"'
    )
    assert dafny.says(body).result is ClaimResult.PROVED


def test_a_program_without_a_version_is_not_dafny(dafny: Fake) -> None:
    answer = dafny.says(f'echo "{FINISHED} 2 verified, 0 errors"', version="Dafny")
    assert answer == not_checked("`dafny` prints no version: it is not Dafny")


def test_without_dafny_nothing_is_known_and_what_to_do_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    result, engine = dafny_answer(LEMMAS)
    assert engine == "Dafny"
    assert result.result is ClaimResult.NOT_CHECKED
    assert result.detail.startswith("Dafny is not installed: put `dafny` on the PATH")


def test_nothing_is_claimed_of_another_text(dafny: Fake) -> None:
    dafny.says(f'echo "{FINISHED} 99 verified, 0 errors"')
    formalized = requirement("whenever p robot shall within 5 ticks satisfy q")
    good = text(formalized, None)
    for other in (good.replace("==>", "==> true ||"), good + "\n"):
        proofs = with_dafny(formalized, other, None)
        assert {one.result for one in proofs} == {ClaimResult.NOT_CHECKED}
    assert {one.result for one in with_dafny(formalized, good, None)} == {ClaimResult.PROVED}


def test_each_part_of_the_file_has_a_line_of_its_own(dafny: Fake) -> None:
    dafny.says(f'echo "{FINISHED} 99 verified, 0 errors"')
    declarations = bound()
    formalized = requirement("whenever p robot shall within 3 ticks satisfy q", declarations)
    proofs = with_dafny(formalized, text(formalized, declarations), declarations)
    assert [(one.layer, one.claim) for one in proofs] == [
        (
            Layer.MONITOR,
            "the counter of `within 3 ticks` is violated exactly where the definition is, "
            "on every sequence of ticks, for every bound",
        ),
        (
            Layer.INTERCEPTOR,
            "a model of the interceptor publishes only zero while it is halted, and else "
            "commands; a request gives 4 ticks of zero; 24 ticks without a stop halt; "
            "10 ticks without a scan halt",
        ),
        (
            Layer.BOUNDS,
            "never violated, for every bound n and every delay reach + braking of at most n",
        ),
        (Layer.BOUNDS, "never violated at the bound of 3 ticks and the declared delay of 4"),
    ]
    assert [one.result for one in proofs] == [*["proved"] * 3, "not checked"]
    assert outcome(proofs[3]) == not_checked(
        "the declared delay of 4 ticks is more than the bound of 3"
    )
    assert proofs[0].engine == "Dafny 2.3.0.10506"
    assert list(proofs[0].artefacts) == ["r1.dfy"]
    assert proofs[3].assumptions[-2:] == (
        "reach = 1 ticks ([assume] latency and lost)",
        "braking = 3 ticks ([assume] braking)",
    )


# Dafny ----------------------------------------------------------------------------------------


def say(text: str) -> ClaimOutcome:
    return dafny_answer(text, seconds=120)[0]


def monitors() -> list[str]:
    """The monitor of each timing; conditions and bounds take turns."""
    timings = ("within {n} ticks", *TIMINGS[-5:], "eventually")
    turns = zip(timings, cycle(CONDITIONS), cycle((0, 1, 20, 10000)), strict=False)
    sentences = [f"{c}robot shall {timing.format(n=n)} satisfy q" for timing, c, n in turns]
    texts = [emitted(one, None).partition("// Interceptor -")[0] for one in sentences]
    assert len(set(texts)) == 7
    return texts


def latching() -> str:
    """A file with the interceptor and the loop."""
    bindings = BINDINGS.replace("[assume]", "latching = true\n\n[assume]")
    file = emitted("when p robot shall within 20 ticks satisfy q", bindings)
    assert "NeverViolatedAsDeclared" in file
    return file


def modules(texts: Iterable[str]) -> str:
    """All in one text, each in a module of its own: one run is faster than several."""
    return "\n".join(f"module M{i} {{\n{one}}}\n" for i, one in enumerate(texts))


@full_only("the lemmas that say most are verified with the mutants")
@needs_dafny
def test_dafny_verifies_monitors_at_any_bound() -> None:
    assert say(modules(monitors())).result is ClaimResult.PROVED


@full_only("the lemmas that say most are verified with the mutants")
@needs_dafny
def test_dafny_verifies_the_interceptor_and_the_loop() -> None:
    assert say(latching()).result is ClaimResult.PROVED


@pytest.mark.slow
@needs_dafny
def test_dafny_verifies_what_holds() -> None:
    lemmas = LEMMAS.replace("A()", "A(x: nat)\n  ensures x + 1 > 0").replace(
        "(x: int)", "(x: nat)\n  requires x != 0"
    )
    assert say(lemmas) == proved("2 parts verified, among them all 2 lemmas and methods")


def only(text: str, *names: str) -> str:
    """Nothing but these is verified; the rest is taken for granted."""

    def marked(found: re.Match[str]) -> str:
        kind, name = found.groups()
        return found[0] if name in names else found[0].replace(kind, f"{kind} {{:verify false}}", 1)

    kinds = r"^ *(lemma|method|function|predicate|constructor)(?: \{:[^}]*\})* (\w+)"
    return re.sub(kinds, marked, text, flags=re.MULTILINE)


SENTENCE = "whenever p robot shall within 20 ticks satisfy q"


def released_at_once_and_late() -> str:
    """An interceptor that holds nothing, and a loop with a delay that is a tick too long."""
    good = emitted(SENTENCE)
    released = replaced(good, "held := if requested then HOLD else s.held,", "held := 0,")
    return replaced(
        released,
        "requires 1 <= braking && reach + braking <= n\n  requires 0",
        "requires 1 <= braking && reach + braking <= n + 1\n  requires 0",
    )


def late_and_forwarding() -> str:
    """A monitor whose deadline is a tick too late, and an interceptor that never stops."""
    late = replaced(emitted(SENTENCE, None), "d.count == n)", "d.count == n + 1)")
    return replaced(late, "      out := ZERO;", "      out := command;")


@pytest.mark.slow
@needs_dafny
def test_dafny_rejects_mutants_and_nothing_else() -> None:
    """Of the monitor, the plain interceptor, the hold and the loop."""
    counted, stopped = monitors()[3:5] if FULL else ("", "")
    outputs = ("CommandCallback", "SpeaksAtEveryTick") if FULL else ()
    answer = say(
        modules(
            (
                only(late_and_forwarding(), "InvariantHolds", "CommandCallback"),
                only(released_at_once_and_late(), "HoldIsPending", "NeverViolated", *outputs),
                only(counted, "InvariantHolds"),
                only(stopped, "InvariantHolds"),
            )
        )
    )
    assert answer.result is ClaimResult.NOT_CHECKED
    assert re.findall(r"`(\w+)` \(line", answer.detail) == [
        *("CommandCallback", "InvariantHolds", "HoldIsPending", "NeverViolated")
    ]


@full_only("the same mutants are rejected")
@needs_dafny
@each(
    "case",
    [
        (late_and_forwarding, {"InvariantHolds", "CommandCallback"}),
        (released_at_once_and_late, {"HoldLasts", "StopCallback", "NeverViolated"}),
    ],
)
def test_dafny_rejects_mutants_by_each_lemma_and_method_that_depends_on_them(
    case: tuple[Callable[[], str], set[str]],
) -> None:
    text, names = case
    answer = say(text())
    assert answer.result is ClaimResult.NOT_CHECKED
    assert names <= {*re.findall(r"`(\w+)` \(line", answer.detail)}


# CrossHair ------------------------------------------------------------------------------------

CORE = '''\
"""A core."""


def bounded(x: int) -> int:
    """Keep to the range.

    post: 0 <= __return__
    post: __return__ <= 10
    """
    return max(x, 0)


def divided(x: int) -> float:
    """Fail at 7.

    post: True
    """
    return 1 / (x - 7)
'''


@pytest.mark.slow
@needs_crosshair
def test_crosshair_confirms_and_refutes_contract_by_contract() -> None:
    functions: list[str] = []
    proofs = with_crosshair(CORE, "R1", seconds=10, progress=functions.append)
    assert functions == ["bounded", "divided"]
    kept, broken = proofs[:2]
    assert (kept.requirement, kept.layer) == ("R1", Layer.INTERCEPTOR)
    assert (kept.claim, outcome(kept)) == (
        "`bounded` keeps `0 <= __return__`",
        proved("confirmed over all paths"),
    )
    assert kept.engine.startswith("CrossHair 0.0.")
    assert broken.claim == "`bounded` keeps `__return__ <= 10`"
    assert broken.result is ClaimResult.COUNTEREXAMPLE
    assert "when calling bounded(" in broken.detail
    raised = [one for one in proofs[2:] if one.result is ClaimResult.COUNTEREXAMPLE]
    assert raised
    assert not any(one.result is ClaimResult.PROVED for one in proofs[2:])


@pytest.mark.slow
@needs_crosshair
def test_what_crosshair_does_not_confirm_is_not_checked() -> None:
    hard = (
        'def f(x: int, y: int, z: int) -> bool:\n    """Fermat.\n\n'
        "    pre: x > 2 and y > 2 and z > 2\n    post: __return__\n"
        '    """\n    return x**3 + y**3 != z**3\n'
    )
    (proof,) = with_crosshair(hard, seconds=1 if FULL else 0.3)
    assert proof.result is ClaimResult.NOT_CHECKED


@pytest.mark.slow
def test_a_core_that_is_no_module_is_not_checked() -> None:
    failing = CORE.partition("def divided")[0].replace("def", "raise ImportError\n\n\ndef")
    proofs = with_crosshair(failing, seconds=1)
    assert len(proofs) == 2
    assert not any(one.result is ClaimResult.PROVED for one in proofs)


def test_without_crosshair_each_contract_is_not_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    def absent(name: str) -> str:
        raise PackageNotFoundError(name)

    monkeypatch.setattr(crosshair, "version", absent)
    proofs = with_crosshair(CORE)
    assert [one.claim for one in proofs] == [
        "`bounded` keeps `0 <= __return__`",
        "`bounded` keeps `__return__ <= 10`",
        "`divided` keeps `True`",
    ]
    reason = f"CrossHair is not installed: {install_help('crosshair')}"
    assert {outcome(one) for one in proofs} == {not_checked(reason)}


KEEPING = '''\
from typing import NamedTuple


class Velocity(NamedTuple):
    vx: float = 0.0
    vy: float = 0.0
    vz: float = 0.0
    wx: float = 0.0
    wy: float = 0.0
    wz: float = 0.0


def kept(command: Velocity) -> Velocity:
    """Hand it on.

    post: __return__ is command
    """
    return command
'''


@pytest.mark.slow
@needs_crosshair
def test_velocities_that_nobody_looks_into_are_whole_numbers_for_crosshair() -> None:
    (proof,) = with_crosshair(KEEPING, seconds=10)
    assert outcome(proof) == proved("confirmed over all paths")
    assert proof.assumptions == (
        "the fields of a velocity are integers; no function reads one of them",
    )


@pytest.mark.parametrize(
    "body",
    [
        "return command if command.vx < 1 else Velocity()",
        "return Velocity(command[0])",
        "vx, *rest = command\n    return Velocity(vx)",
        "return Velocity(*command)",
        "match command:\n        case Velocity(vx):\n            return Velocity(vx)",
    ],
)
def test_velocities_that_somebody_looks_into_stay_floats(body: str) -> None:
    looking = KEEPING.replace("return command", body)
    compile(looking, "core.py", "exec")
    assert crosshair._with_whole_velocities(looking) is None
    assert crosshair._with_whole_velocities(KEEPING) == KEEPING.replace("float = 0.0", "int = 0")


@pytest.mark.slow
@needs_crosshair
def test_crosshair_confirms_a_step_of_the_interceptor() -> None:
    """The others take their time; all of them are looked at by the command."""
    core = (Path(crosshair.__file__).parents[3] / "monitors/interceptor.py").read_text()
    alone = core.replace("    post:", "    told:").replace(
        "told: __return__ == (0", "post: __return__ == (0"
    )
    (proof,) = with_crosshair(alone, seconds=20)
    assert outcome(proof) == proved("confirmed over all paths")
    assert proof.claim == "`expired` keeps `__return__ == (0 < timeout <= age)`"

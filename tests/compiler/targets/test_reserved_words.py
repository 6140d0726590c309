"""Names that a target's language reserves, and names that its texts use: the user may have them.

Each text is read by the target's own tool, and says of them what the sentence says.
"""

import builtins
import keyword
import re
import string
import subprocess
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.agents import psl
from compiler.emit import TARGETS, renamed_propositions
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import formula as f
from compiler.logic import printing
from compiler.logic.spelling.reserved_words import LUSTRE, SMV, TABLES, C
from compiler.project.lustre import lustre
from compiler.targets.fret import quoted
from compiler.targets.ltl import text as ltl
from compiler.targets.target import TargetOptions
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.expressions import Name
from fretish.keywords import RESERVED
from tests import c_monitors, java_monitors, node, rust_monitors
from tests.command import Fretc, write
from tests.each import each
from tests.effort import FULL, full_only, some
from tests.emitting import emitted, requirement
from tests.monitoring import monitor
from tests.programs import installed, needs, package

LIKE = """
    double float clock next init self count toint READ WRITE SPEC COMPWFF next_ init_2 init_3 T T_
    T_2 t v_T is_T not_T not_not_T eq is not _ __proto__ constructor toString hasOwnProperty valueOf
    printf malloc abort exit memcpy strlen main errno NULL EOF ESTOP print len object type None Some
    Ok Err Vec drop panic Option Result Box u8 usize console document window Object Array Math JSON
    require module exports process p_p draw_p p_T s_T n_T f_T h_T x field tick ticks state now
    approximation inputs outcomes outcome word certain possible CELLS LITERALS PROPOSITIONS Window
    previous Tick Demand m Monitor Run w k c monitor_r1 the_monitor_r1 violated unmet failed held
    phase enforced inside LAST FTP TRUE True FALSE xor int8_t UINT32_C fretc_truth FRETC_TRUE
    R1_MONITOR_H r1_init _earlier_1
""".split()
"""Near the reserved words; of libraries, preludes and globals; and of the texts themselves."""


@cache
def taken() -> tuple[str, ...]:
    """All reserved words of all languages, and all words of our own texts."""
    reserved = {word for table in TABLES.values() for word in table.words}
    own = emitted("monitor", _SAMPLE) | emitted("c", _SAMPLE) | emitted("rust", _SAMPLE)
    own |= emitted("js", _SAMPLE) | emitted("smv", _SAMPLE) | emitted("dafny", _SAMPLE)
    own |= emitted("java", _SAMPLE)
    words = {word for text in own.values() for word in re.findall(r"[A-Za-z_]\w*", _code(text))}
    some_more = {*LIKE, *keyword.kwlist, *keyword.softkwlist, *dir(builtins), *string.ascii_letters}
    return tuple(sorted({*reserved, *words, *some_more} - {"FTP", "X!", "ask"}))


_SAMPLE = "whenever p & x > 3 the sw shall within 3 ticks satisfy q"


def _code(text: str) -> str:
    """Without comments, of any language."""
    return re.sub(r"//.*|#[^!\[].*|--.*|/\*.*?\*/", "", text)


def about(names: Sequence[str], id: str = "R1") -> FormalizedRequirement:
    """A requirement that is broken where none of the names is true."""
    return requirement(f"the sw shall always satisfy {disjunction(names)}", id)


def disjunction(names: Sequence[str]) -> str:
    return " | ".join(f'"{name}"' for name in names)


def parts(names: Sequence[str], size: int) -> list[tuple[str, ...]]:
    return [tuple(names[i : i + size]) for i in range(0, len(names), size)]


def one_by_one(count: int) -> list[list[bool]]:
    """At each tick one is true; at the last none."""
    return [[place == tick for place in range(count)] for tick in range(count + 1)]


def words() -> list[tuple[int, list[list[bool]]]]:
    """For the monitor of each chunk."""
    return [(place, one_by_one(len(names))) for place, names in enumerate(chunks())]


@cache
def chunks() -> list[tuple[str, ...]]:
    """Parts that a name and what it could become fall into together."""
    return parts(sorted(taken(), key=lambda name: name.lower().strip("_")), 200)


every_name = each("chunk", chunks())


def breaks(told: Sequence[Sequence[c_monitors.Outcome]]) -> list[int]:
    """The ticks of breaches, for certain or maybe."""
    return [i for i, (one,) in enumerate(told) if one.certain.violation or one.possible.violation]


# Each language's own tool ---------------------------------------------------------------------


@pytest.mark.slow
@every_name
def test_python_runs_it(chunk: tuple[str, ...]) -> None:
    machine = monitor(" ".join(about(chunk).entry.wording.text.split()))
    rows = one_by_one(len(chunk))
    assert [*machine.PROPOSITIONS] == [*chunk]
    assert breaks([*c_monitors.of_python(machine, rows)]) == [len(chunk)]
    for i in range(len(chunk) + 1):  # one of them by its name alone
        machine.reset()
        machine.advance([{name: place == i for place, name in enumerate(chunk)}])
        assert str(machine.verdicts()[0]) == ("violated" if i == len(chunk) else "pending")


@pytest.mark.slow
def test_gcc_compiles_it_after_all_headers(tmp_path: Path) -> None:
    """A monitor for each chunk: all in one program, and all after the headers at once."""
    ids = ["R1" if "R1_MONITOR_H" in names else f"M{i}" for i, names in enumerate(chunks())]
    sources = [c_monitors.Source.of(about(*each)) for each in zip(chunks(), ids, strict=True)]
    program = c_monitors.compiled(tmp_path, "gcc", *sources, flags=c_monitors.STRICT)
    _, told = program.run(*words())
    assert [*map(breaks, told)] == [[len(names)] for names in chunks()]
    headers = "".join(f"#include <{name}.h>\n" for name in HEADERS)
    ours = [name for source in sources for name in source.texts if name.endswith(".h")]
    includes = "".join(f'#include "{name}"\n' for name in ours)
    for compiler, ending, flags in (("gcc", "c", "-std=gnu11"), ("g++", "cpp", "-std=c++17")):
        own = headers if ending == "c" else headers.replace("#include <stdnoreturn.h>\n", "")
        (tmp_path / f"after.{ending}").write_text(f"{own}{includes}")
        command = [installed(compiler), flags, "-fsyntax-only", f"after.{ending}"]
        subprocess.run(command, cwd=tmp_path, check=True)


HEADERS = (
    "assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal "
    "stdalign stdarg stdbool stddef stdint stdio stdlib stdnoreturn string time wchar wctype"
).split()


def test_the_macros_of_c_s_headers_are_in_the_table(tmp_path: Path) -> None:
    """Those that are no functions: a member of that name would be another text."""
    text = "".join(f"#include <{name}.h>\n" for name in HEADERS)
    command = [installed("gcc"), "-std=c11", "-dM", "-E", "-"]
    run = subprocess.run(command, input=text, capture_output=True, text=True, check=True)
    macros = re.findall(r"^#define ([A-Za-z]\w*)(?= |$)", run.stdout, re.MULTILINE)
    assert len(macros) > 300
    assert [name for name in macros if name not in C] == []


@pytest.mark.slow
def test_rustc_compiles_it(tmp_path: Path) -> None:
    crates = [rust_monitors.crate(about(names)) for names in chunks()]
    told = rust_monitors.outcomes(tmp_path, [*map(rust_monitors.library, crates)], words())
    assert [*map(breaks, told)] == [[len(names)] for names in chunks()]


@full_only("javac; test_java_monitor.py has some of the names")
def test_javac_compiles_it(tmp_path: Path) -> None:
    texts = [java_monitors.monitor(about(names)) for names in chunks()]
    told = java_monitors.outcomes(tmp_path, texts, words())
    assert [*map(breaks, told)] == [[len(names)] for names in chunks()]


@node.needs_node
@pytest.mark.slow
def test_node_runs_it(tmp_path: Path) -> None:
    texts = [TARGETS["js"].emit([about(names)])[0].text for names in chunks()]
    for rows in node.outcomes(tmp_path, texts, words()):
        assert [row[0]["certain"]["violation"] for row in rows] == [False] * (len(rows) - 1) + [
            True
        ]


@every_name
def test_storm_reads_it(chunk: tuple[str, ...], tmp_path: Path) -> None:
    stormpy = package("stormpy")
    for names in parts(chunk, 40):
        satisfied = f"eventually satisfy {disjunction(names)}"
        sentence = f"the sw shall with probability >= 0.5 {satisfied}"
        files = emitted("prism", sentence)
        path = tmp_path / "model.prism"
        path.write_text(files["r1.prism"])
        program = stormpy.parse_prism_program(str(path))
        (asked,) = stormpy.parse_properties(files["r1.props"], program)
        for name, new in TARGETS["prism"].names(requirement(sentence)).items():
            assert program.has_label(new), name
            assert f'"{new}"' in str(asked), name


@pytest.mark.slow
def test_dafny_reads_it(tmp_path: Path) -> None:
    """All names in one run, a module for each chunk; by default its own, and some of all others."""
    names = {*some(taken(), 8), *TABLES["Dafny"].words.intersection(taken())}
    with (tmp_path / "all.dfy").open("w") as file:
        for place, chunk in enumerate(parts(sorted(names), 200)):
            (text,) = emitted("dafny", about(chunk).entry.wording.text).values()
            file.write(f"module Chunk{place} {{\n{text}\n}}\n")
    command = [installed("dafny"), "/noVerify", "/compile:0", "all.dfy"]
    subprocess.run(command, cwd=tmp_path, check=True)


def test_spot_reads_each_as_one_proposition() -> None:
    import spot

    for name in taken():
        atom = spot.formula(printing.text(f.Atom(name), printing.SPOT))
        assert atom.kindstr() == "ap", name
        text = printing.text(f.globally(f.or_(f.Atom(name), f.not_(f.LAST))), printing.SPOT)
        last = spot.formula.Not(spot.formula.ap("LAST"))
        assert spot.formula(text) == spot.formula.G(spot.formula.Or([atom, last])), name


# By the grammars of manuals -------------------------------------------------------------------


def identifiers(kind: str, names: Sequence[str]) -> Mapping[str, str]:
    """What they are called; no two of them are called the same."""
    subject = about(names)
    every = TARGETS[kind].names(subject)
    found = {name: every[name] for name in names}
    assert len({*found.values()}) == len(names)
    return found


NUSMV = re.compile(r"(?!__)[A-Za-z_][A-Za-z0-9_$#\\-]*")
"""NuSMV 2.6 User Manual, 2.1."""


def test_nusmv_s_grammar_has_each_as_an_identifier() -> None:
    for names in chunks():
        for name, new in identifiers("smv", names).items():
            assert NUSMV.fullmatch(new), name
            assert new not in SMV, name
    text = ltl(about(["G", "T", "LAST"]), TargetOptions("nusmv"))
    assert "G(G_2 | T_2 | LAST_2)" in text
    assert re.search(r"^ *LAST_2 +the proposition `LAST`$", text, re.MULTILINE), text


@pytest.mark.slow
def test_ajpf_s_grammar_has_each_as_a_functor() -> None:
    for names in parts(taken(), 60):
        (text,) = emitted("ajpf", about(names).entry.wording.text).values()
        assert not isinstance(psl.read(Source("r1.psl", text)), Diagnostic)
        for name, new in identifiers("ajpf", names).items():
            assert re.fullmatch(r"[a-z][A-Za-z0-9_]*", new), name
            assert new == name or f"# {new}: the proposition `{name}`" in text


def test_lustre_has_no_assignment_with_its_own_words() -> None:
    assert [name for name in LUSTRE.words if lustre(Name(name)) is not None] == []


@pytest.mark.parametrize("kind", ["c", "rust", "java", "monitor", "smv", "prism", "dafny", "ajpf"])
@settings(max_examples=200 if FULL else 6)
@given(
    st.lists(
        st.sampled_from([f"{word}{end}" for word in ("int", "T", "x", "class") for end in
                         ("", "_", "__", "_2", "_3", "_2_2")] + ["not_x", "not_not_x", "not_T"]),
        min_size=1, max_size=8, unique=True,
    )
)  # fmt: skip
def test_what_is_not_reserved_keeps_its_name(kind: str, names: list[str]) -> None:
    """And no two names become one, whatever the user calls the others."""
    sentence = f"the sw shall with probability >= 0.5 always satisfy {' | '.join(names)}"
    subject = requirement(sentence) if kind == "prism" else about(names)
    found = TARGETS[kind].names(subject)
    assert len({found[name] for name in names}) == len(names)
    tables = {"c": "C", "rust": "Rust", "java": "Java", "smv": "SMV", "prism": "PRISM"}
    if kind in tables:
        table = TABLES[tables[kind]]
        assert all(found[name] == name for name in names if name not in table)


# FRET -----------------------------------------------------------------------------------------

_FRET = re.compile(r'"[^"]*"|[A-Za-z][\w.%]*')


def test_fret_reads_what_is_exported() -> None:
    """What its editor refuses is in quotes, where its lexer takes any text for a name."""
    for names in parts(
        [n for n in taken() if re.fullmatch(r"[A-Za-z]\w*", n) and n.lower() not in RESERVED], 30
    ):
        text = quoted(" | ".join(names))
        outside = {word for word in _FRET.findall(text) if not word.startswith('"')}
        assert not outside & TABLES["FRET"].words
        assert [word.strip('"') for word in _FRET.findall(text)] == [*names]


# Ids of requirements ---------------------------------------------------------------------------

IDS = "class int CON sem mtx T fretc Variable monitor_r1 pthread_mutex 1 self main std p".split()
_ABOUT_P = "whenever p the sw shall within 3 ticks satisfy q"


@pytest.mark.slow
def test_an_id_is_no_name_of_the_run_time_in_python() -> None:
    for id in IDS:
        (text,) = emitted("monitor", _ABOUT_P, id).values()
        space: dict[str, Any] = {"__name__": "made"}
        exec(compile(text, id, "exec"), space)
        machine = space["MONITOR"]()
        assert str(machine.run([[True, False]] * 9)) == "violated", id


@pytest.mark.slow
def test_an_id_is_no_name_of_a_library_in_c(tmp_path: Path) -> None:
    """Linked with what these libraries have, and compiled after their headers."""
    headers = "pthread.h semaphore.h threads.h stdatomic.h spawn.h aio.h regex.h".split()
    files = {name: text for id in IDS for name, text in emitted("c", _ABOUT_P, id).items()}
    assert len(files) == 2 * len(IDS)
    ours = "".join(f'#include "{name}"\n' for name in files if name.endswith(".h"))
    library = "".join(f"#include <{name}>\n" for name in headers)
    rust_monitors.write(tmp_path, {**files, "after.c": f"{library}{ours}"})
    sources = [name for name in files if name.endswith(".c")]
    command = [installed("gcc"), "-std=gnu11", "-fsyntax-only", *sources, "after.c"]
    subprocess.run(command, cwd=tmp_path, check=True)


def test_an_id_is_no_label_in_prism() -> None:
    files = emitted("prism", "the sw shall with probability >= 0.5 always satisfy p & q", "p")
    assert '\n"p_2": P>=1' in files["p.props"]


# Proofs, and the map back ---------------------------------------------------------------------


@needs("gcc", "node", "rustc")
@pytest.mark.slow
@pytest.mark.parametrize("names", some(parts(taken(), 3), 1000, 400))
def test_a_monitor_with_such_names_is_proved(fretc: Fretc, names: tuple[str, ...]) -> None:
    first, second, third = (f'"{name}"' for name in (*names, *"xyz")[:3])
    write("a.fret", f"when {first} the sw shall until {second} satisfy {third}\n")
    files = ("a_monitor.py", "a_monitor.c", "a_monitor/src/lib.rs", "a_monitor.mjs")
    kinds = (word for kind in ("monitor", "c", "rust", "js") for word in ("--emit", kind))
    assert fretc("a.fret", *kinds).status == 0
    for file in files:
        run = fretc("verify", "a.fret", "--monitor", "--file", f"build/{file}")
        assert (run.status, "proved" in run.out) == (0, True), (file, run)


def test_comments_and_json_give_the_map_back() -> None:
    sentence = "whenever T & class & int the sw shall eventually satisfy init"
    assert renamed_propositions(requirement(sentence)) == {
        "monitor": {"class": "class_"},
        "c": {"class": "class_2", "int": "int_2"},
        "java": {"class": "class_2", "int": "int_2"},
        "ajpf": {"T": "v_T"},
        "ajpf-bundle": {"T": "v_T"},
        "agent-runtime": {"T": "v_T"},
        "dafny": {"class": "class_", "int": "int_"},
        "smv": {"T": "T_2", "init": "init_2"},
        "prism": {"T": "T_2", "int": "int_2", "init": "init_2"},
        "fret-json": {name: f'"{name}"' for name in ("T", "int", "init")},
    }
    for kind, line in {
        "c": "    fretc_truth class_2; /* class */",
        "ajpf": "# v_T: the proposition `T`; an adapter has to derive it for the agent",
        "dafny": "// class_ is class",
        "smv": "    init_2 : boolean;  -- init",
        "monitor": '        "class": "class_",',
    }.items():
        assert line in "\n".join(emitted(kind, sentence).values()).splitlines(), kind

"""`fretc write`: from a requirement in plain English to FRETish, by the user's own choice."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

import click

from fretc.terminal.options import (
    bindings_option,
    format_option,
    is_given,
    output_option,
    requirements_option,
)
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_OK,
    EXIT_USAGE,
    fail,
    fail_at_end,
    or_fail,
    print_diagnostics,
    print_status,
    write_outputs,
)
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import visible

if TYPE_CHECKING:
    from fretc.writing.answers import Answer
    from fretc.writing.choices import Choice
    from fretish.bindings.declarations import Declarations
    from fretish.english.vocabulary import Vocabulary


@click.command()
@click.argument("text", nargs=-1, metavar="[TEXT]")
@click.option(
    "--choose",
    type=click.IntRange(min=1),
    metavar="N",
    help="Choose the reading with this number, and ask nothing.",
)
@click.option("--id", "id_", metavar="ID", help="Id of the requirement in the file.")
@requirements_option
@bindings_option
@format_option()
@output_option(help="`.fret` file to which the chosen sentence is appended.")
def write(
    text: tuple[str, ...],
    choose: int | None,
    id_: str | None,
    requirements: str,
    bindings: str | None,
    output_format: str,
    output: str | None,
) -> None:
    """Write FRETish from a requirement in plain English.

    TEXT is one sentence, or several; without it, standard input is read. The command prints all
    plausible readings with their meanings, and names the words that no reading contains. On a
    terminal it then shows short runs and asks of each whether it may happen, until one reading
    is left. Names of the project are recognized in their words.

    With `--output` the sentence is appended to a .fret file, and the answers are kept beside it
    as tests: `fretc test --suite`.

    Exit status: 0 one reading is left; 2 bad usage, or a text without a reading; 3 several
    readings are left.

    Example: fretc write "if the battery is low, the drone must return within 5 seconds"
    """
    from fretish.english.readings import demands

    english = " ".join(text) if text else _input()
    parts = demands(english)
    if not parts:
        fail(diagnostic("no_text_to_write"))
    if (id_ is not None or choose is not None) and len(parts) > 1:
        fail(diagnostic("one_id_for_several_texts", count=len(parts)))
    folder = str(Path(output).parent) if output and not is_given("requirements") else requirements
    declarations, names = _project(folder, bindings)
    choices = [_choice(part, names, declarations) for part in parts]
    if output_format == "json":
        _print_json(choices)
    asks = output_format == "text" and choose is None and _is_terminal()
    status = EXIT_OK
    for choice in choices:
        status = max(status, _write(choice, choose, id_, output, asks, output_format), key=_WORSE)
    raise SystemExit(status)


_WORSE = (EXIT_OK, EXIT_INCONCLUSIVE, EXIT_USAGE).index
"""The rank of an exit status: bad input wins."""


def _input() -> str:
    from compiler.files.text_files import read

    return or_fail(read("-")).text


def _is_terminal() -> bool:
    return sys.stdin.isatty() and sys.stdout.isatty()


def _project(folder: str, bindings: str | None) -> tuple[Declarations | None, Vocabulary]:
    """The bindings, and the names of the project; a folder that is missing has none."""
    from compiler.project.folder import load
    from compiler.project.paths import BINDINGS, requirement_files, sibling_path
    from fretish.english.vocabulary import vocabulary

    exists = os.path.exists(folder)
    files = requirement_files(folder) if exists or is_given("requirements") else []
    if isinstance(files, Diagnostic) and not exists:
        fail(files)
    paths = [] if isinstance(files, Diagnostic) else files
    path = bindings or (sibling_path(folder, BINDINGS) if exists else None)
    project = load(paths, path, reads=())
    wrong = [each for each in project.diagnostics if each.is_error and _is_in(each, path)]
    print_diagnostics(wrong)
    if wrong:
        fail_at_end()
    components = [each.sentence.component for each in project.formalized]
    return project.declarations, vocabulary(project.declarations, components)


def _is_in(error: Diagnostic, path: str | None) -> bool:
    return error.span is not None and error.span.source.name == path


def _choice(english: str, names: Vocabulary, declarations: Declarations | None) -> Choice:
    """The readings of one sentence, compared; exits if there is none."""
    from fretc.writing.choices import choice

    return or_fail(choice(english, names, declarations))


def _print_json(choices: Sequence[Choice]) -> None:
    from compiler.files.templating import to_json
    from fretc.writing.text_output import SCHEMA

    click.echo(to_json({"schema": SCHEMA, "texts": [choice.record for choice in choices]}))


def _write(
    choice: Choice,
    choose: int | None,
    id_: str | None,
    output: str | None,
    asks: bool,
    output_format: str,
) -> int:
    """Print a text's readings, ask, and write the chosen one; returns the exit status."""
    if output_format == "text":
        click.echo("\n".join(visible(line) for line in choice.lines))
    if choice.warning is not None:
        print_diagnostics([choice.warning])
    if choice.left_out:
        print_diagnostics([diagnostic("words_left_out", words="`, `".join(choice.left_out))])
    if choose is not None and choose > len(choice.readings):
        fail(diagnostic("no_such_reading", number=choose, count=len(choice.readings)))
    answers: list[Answer] = []
    remaining = (choose - 1,) if choose is not None else tuple(range(len(choice.readings)))
    if asks:
        remaining = _ask(choice, remaining, answers)
    if len(remaining) > 1:
        if output is not None:
            print_diagnostics([diagnostic("several_readings", count=len(remaining))])
            return EXIT_USAGE
        return EXIT_INCONCLUSIVE
    (number,) = remaining
    if asks and len(choice.readings) > 1:
        click.echo(f"\n{visible(choice.readings[number].text)}")
    if output is not None:
        _append(choice, number, id_, output, answers)
    return EXIT_OK


def _ask(choice: Choice, remaining: tuple[int, ...], answers: list[Answer]) -> tuple[int, ...]:
    """Ask until one reading is left, or no run distinguishes those that are."""
    from fretc.writing.answers import Answer
    from fretc.writing.questions import answered, next_question

    questions = list(choice.questions)
    while (question := next_question(remaining, questions)) is not None:
        click.echo("\nMay this run happen, and end so?")
        for line in choice.table(question):
            click.echo(visible(f"  {line}"))
        reply = click.prompt("y yes, n no, s skip", type=click.Choice(("y", "n", "s")))
        questions.remove(question)
        if reply == "s":
            continue
        may_happen = reply == "y"
        answers.append(Answer(question.run, may_happen))
        remaining = answered(remaining, question, may_happen=may_happen)
        if len(remaining) > 1:
            click.echo(f"{len(remaining)} readings are left")
    for number in remaining if len(remaining) > 1 else ():
        click.echo(visible(f"left: {choice.readings[number].text}"))
    return remaining


def _append(
    choice: Choice, number: int, id_: str | None, output: str, answers: Sequence[Answer]
) -> None:
    """Append the sentence to the file, and its answers to the suite beside it."""
    from compiler.files.records import plain
    from compiler.files.templating import to_json
    from compiler.files.text_files import read
    from compiler.formalization.formalize import formalize
    from fretc.testing.reader import read as read_suite
    from fretc.writing.answers import answers_file, suite_with
    from fretc.writing.requirement_text import appended, free_id
    from fretish.diagnostics.source import Source

    present = or_fail(read(output)) if os.path.lexists(output) else None
    id = id_ or free_id(output, present)
    sentence = choice.readings[number].text
    text, entry = or_fail(appended(present or Source(output, ""), id, choice.english, sentence))
    files: dict[Path, str] = {Path(output): text}
    if answers:
        requirement, _ = formalize(entry, choice.declarations)
        assert requirement is not None, "it was formalized as a reading"
        path = answers_file(output)
        earlier = or_fail(read_suite(path)) if os.path.lexists(path) else None
        suite = suite_with(earlier, requirement, answers)
        files[Path(path)] = f"{to_json(plain(suite))}\n"
    write_outputs(files)
    if answers:
        print_status(f"next: `fretc test {quote(output)} --suite {quote(path)}` runs the answers")

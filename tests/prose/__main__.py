"""`python -m tests.prose`: private words, and how hard each page and each help is to read.

A page's ease is Flesch's (206.8 - 1.015 words a sentence - 84.6 syllables a word; 60 to 70 is plain
English), by textstat, which `pip install 'fretc[prose]'` adds.
"""

from __future__ import annotations

import inspect
import sys
import warnings
from collections.abc import Iterator

import click

from fretc.cli import cli
from tests.prose.passages import pages, passages, without_code
from tests.prose.words import private_words, words


def texts() -> Iterator[tuple[str, str]]:
    """Each page and each help: its name and its sentences."""
    for page in pages():
        yield page.name, without_code(page.read_text(encoding="utf-8"))
    for name, command in sorted(cli.commands.items()):
        options = [o.help or "" for o in command.params if isinstance(o, click.Option)]
        yield (
            f"fretc {name} --help",
            without_code("\n\n".join([inspect.cleandoc(command.help or ""), *options])),
        )


def main() -> int:
    """Print the table; exit with 1 where a text has a private word."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from textstat import textstat
    print("  words  words a sentence   ease")
    for name, text in texts():
        count, length = textstat.lexicon_count(text), textstat.avg_sentence_length(text)
        print(f"{count:7,} {length:17.1f} {textstat.flesch_reading_ease(text):6.0f}  {name}")
    uses = [*private_words(passages(), words())]
    print(*uses, sep="\n")
    return 1 if uses else 0


if __name__ == "__main__":
    sys.exit(main())

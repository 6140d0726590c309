"""A log read for its signals, against the official decoders and against its bytes alone.

    python -m benchmarks.reading [LOG] [--requirements FOLDER]

CPU time, medians of five after one run to warm up; no test asserts it.
"""

from __future__ import annotations

import argparse
import hashlib
from pathlib import Path

from mcap.reader import make_reader
from mcap_ros1.decoder import DecoderFactory as Ros1
from mcap_ros2.decoder import DecoderFactory as Ros2

from benchmarks.timing import seconds
from compiler.project import beside, load, requirement_files
from fretish.declarations import Declarations
from fretish.diagnostic import Diagnostic
from monitors.recordings import read


def ours(path: str, declarations: Declarations) -> object:
    """All that an audit reads: bytes hashed, CRCs and index checked, samples of all signals."""
    found = read(path, declarations, tuple(declarations.signals))
    assert not isinstance(found, Diagnostic), found.message
    return found


def official(path: str, topics: set[str]) -> int:
    """The messages of the same topics, decoded; nothing is made of them."""
    with Path(path).open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[Ros2(), Ros1()])
        return sum(1 for _ in reader.iter_decoded_messages(topics=sorted(topics)))


def hashed(path: str) -> str:
    """The floor of an audit: each byte is looked at once."""
    with Path(path).open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("log", nargs="?", default="traces/mission-seed15.mcap")
    parser.add_argument("--requirements", default="requirements")
    options = parser.parse_args()
    files = requirement_files(options.requirements)
    assert not isinstance(files, Diagnostic), files.message
    declarations = load(files, beside(options.requirements, "bindings.toml")).declarations
    assert declarations is not None
    topics = {signal.path.topic for signal in declarations.signals.values()}
    mine = seconds(lambda: ours(options.log, declarations))
    theirs = seconds(lambda: official(options.log, topics), 3)
    floor = seconds(lambda: hashed(options.log))
    size = Path(options.log).stat().st_size / 1e6
    print(f"{options.log}: {size:.1f} MB, topics {', '.join(sorted(topics))}")
    print(f"  samples of all signals  {mine:.3f} s")
    print(f"  official decoders       {theirs:.3f} s, {theirs / mine:.1f} times that")
    print(f"  SHA-256 of the file     {floor:.3f} s")


if __name__ == "__main__":
    main()

from collections import Counter
from itertools import pairwise
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

TRACES = Path(__file__).parents[2] / "traces"


@pytest.mark.slow
def test_the_readme_of_the_traces_says_what_is_in_the_log() -> None:
    (path,) = TRACES.glob("*.mcap")
    text = (TRACES / "README.md").read_text(encoding="utf-8")
    counts, control, times = Counter[str](), [(0, False)], []
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        (options,) = [entry.metadata for entry in reader.iter_metadata()]
        for _, channel, message, decoded in reader.iter_decoded_messages():
            counts[channel.topic] += 1
            times.append(message.log_time)
            if channel.topic == "/gwendolen_control":
                control.append((message.log_time, decoded.data))
    changes = [(time, stop) for (_, was), (time, stop) in pairwise(control) if was != stop]
    stops = [(start, end) for (start, stop), (end, _) in pairwise(changes) if stop]
    assert f"`{path.name}`" in text
    assert f"with seed {options['seed']} by" in text
    assert f"| Duration | {(times[-1] - times[0]) / 1e9:.2f} s |" in text
    assert f"| Stops | {len(stops)} |" in text
    for start, end in stops:
        assert f"| {(start - times[0]) / 1e9:.4f} s |" in text
        assert f"| {(end - times[0]) / 1e9:.2f} s |" in text
    for topic, count in counts.items():
        (row,) = [line for line in text.splitlines() if line.startswith(f"| `{topic}` |")]
        assert f"| {count} |" in row

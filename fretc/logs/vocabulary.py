"""The texts in the fields of a log: candidates for enumeration values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.messages.decoding import Decode, decoder, leaves
from fretc.logs.messages.leaves import FieldKind
from fretc.logs.signals.signals import FieldError, UnstatedError, field_of
from fretish.bindings.declarations import Path

_MOST = 20
"""The most different texts of a field; a field with more is free text."""
_LONGEST = 40
_MOST_MESSAGES, _MOST_BYTES = 20_000, 2**16
"""The most messages of a topic that are decoded, and the most bytes of one."""
_NAMES = ("frame_id", "child_frame_id", "encoding", "distortion_model")
"""Names of fields that never change while a robot runs."""

Words = Mapping[str, tuple[str, ...] | None]
"""For each text field of a topic, by its path, its texts in the order of the log; None: free
text."""


class MessageTexts:
    """A collector of the texts of messages, as long as there are few different ones."""

    def __init__(self) -> None:
        self._words: dict[str, dict[str, dict[str, None] | None]] = {}
        self._decoders: dict[int, Decode | None] = {}
        self._counts: Counter[str] = Counter()

    def of(self, topic: str) -> Words:
        """The texts of a topic."""
        texts = self._words.get(topic, {})
        return {path: None if words is None else tuple(words) for path, words in texts.items()}

    def take(self, stream: ChannelDefinition, payload: memoryview) -> None:
        """One message."""
        topic = stream.channel.topic
        if self._counts[topic] >= _MOST_MESSAGES or len(payload) > _MOST_BYTES:
            return
        decode = self._decoder(stream)
        if decode is None:
            return
        self._counts[topic] += 1
        data = bytes(payload)
        try:
            message = decode(data)
        except Exception:  # the decoder trusts each byte, and each may be wrong
            return
        if stream.channel.message_encoding == "json":
            self._find(stream, (data,))
        for path, words in self._words[topic].items():
            if words is not None and not _add(words, path, message):
                self._words[topic][path] = None

    def _decoder(self, stream: ChannelDefinition) -> Decode | None:
        """The decoder of a stream; None: it has no field with few different texts."""
        id, topic = stream.channel.id, stream.channel.topic
        if id not in self._decoders:
            decode = decoder(stream)
            self._decoders[id] = None if isinstance(decode, str) else decode
            self._find(stream, ())
        texts = self._words[topic]
        is_open = stream.channel.message_encoding == "json" or any(
            words is not None for words in texts.values()
        )
        return self._decoders[id] if is_open else None

    def _find(self, stream: ChannelDefinition, payloads: tuple[bytes, ...]) -> None:
        """Find the text fields of a stream."""
        texts = self._words.setdefault(stream.channel.topic, {})
        for path, leaf in (leaves(stream, payloads) or {}).items():
            *above, last = path.split(".")
            if leaf.kind is FieldKind.TEXT and last not in _NAMES and above[:1] != ["header"]:
                texts.setdefault(path, {})


def _add(words: dict[str, None], path: str, message: object) -> bool:
    """Add the text of a message; False: the field becomes free text."""
    try:
        text = field_of(Path("", tuple(path.split("."))), message)
    except (FieldError, UnstatedError):
        return True
    if not isinstance(text, str) or not text:
        return True
    words[text] = None
    return len(words) <= _MOST and len(text) <= _LONGEST and text.isprintable() and '"' not in text

"""Decode messages of transforms, for recordings and for watches."""

from __future__ import annotations

from collections.abc import Iterable

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.messages.decoding import Decode, decoder
from fretc.logs.signals.signals import Sparse
from fretish.bindings.declarations import Signal
from monitors.transforms import FrameQuery, FrameSignals, FrameTransform, transforms_of


def frame_signals(signals: Iterable[Signal]) -> FrameSignals:
    """The samples of those of the signals that are numbers of poses."""
    return FrameSignals(
        [
            FrameQuery(
                signal.name,
                signal.path.topic,
                signal.pose.frame,
                signal.pose.reference,
                str(signal.pose.number),
            )
            for signal in signals
            if signal.pose is not None
        ]
    )


def transforms(decode: Decode | None, payload: bytes) -> tuple[FrameTransform, ...] | None:
    """The transforms in one message; None if it cannot be read."""
    if decode is None:
        return None
    try:
        return tuple(transforms_of(decode(payload), _field))
    except Exception:  # the decoder trusts each byte, and each may be wrong
        return None


def decoder_of(stream: ChannelDefinition) -> Decode | None:
    """The decoder of a stream; None if its messages cannot be read."""
    decode = decoder(stream)
    return None if isinstance(decode, str) else decode


def _field(holder: object, name: str) -> object:
    return holder.field(name) if isinstance(holder, Sparse) else getattr(holder, name)

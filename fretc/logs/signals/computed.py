"""The values of computed signals over the time of a recording, for evidence and plots.

Propositions do not read them: they compute the same from the recorded signals.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from fretc.logs.signals.measures import number
from fretc.logs.signals.propositions import history_of
from fretc.logs.signals.samples import Recording, Samples
from fretish import expressions as e
from fretish.bindings.declarations import ComputedSignal, Declarations


def computed_samples(
    names: Iterable[str], declarations: Declarations, recording: Recording
) -> dict[str, Samples]:
    """Computed signal → its value wherever one of its signals has a sample or becomes unknown.

    Args:
        names: computed signals.
        declarations: these, and the recorded signals that they read.
        recording: with the samples of the recorded signals.

    Returns:
        64-bit floats in base units; NaN: unknown.
    """
    return {name: _samples(declarations.computed[name], declarations, recording) for name in names}


def _samples(signal: ComputedSignal, declarations: Declarations, recording: Recording) -> Samples:
    read = dict.fromkeys(name.id for name in e.names(signal.value))
    history = history_of({name: declarations.signals[name] for name in read}, recording)
    tree = e.Calculation(signal.name, signal.value, signal.is_rounded)
    values = np.broadcast_to(number(tree, history.scope()), history.times.shape)
    return Samples(history.times, values)

"""Audits that step each monitor tick by tick; their results are those of whole columns."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from unittest.mock import patch

from fretc.audit.measurements.judgement import judge
from monitors import kernel


@contextmanager
def stepping() -> Iterator[None]:
    """Within this context, audits of this process step the monitors."""
    with patch("fretc.audit.one_log.judge", partial(judge, engine=kernel.stepped)):
        yield

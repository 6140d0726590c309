"""The targets, in one table: what `--emit` can make."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from compiler.targets import (
    ajpf,
    bundle,
    dafny,
    dot,
    fret,
    hoa,
    interceptor,
    ltl,
    monitor,
    prism,
    records,
    smv,
)
from compiler.targets.target import Target

TARGETS: Mapping[str, Target] = MappingProxyType(
    {
        target.name: target
        for target in (
            ltl.TARGET,
            monitor.TARGET,
            ajpf.TARGET,
            bundle.TARGET,
            smv.TARGET,
            hoa.TARGET,
            dot.TARGET,
            prism.TARGET,
            records.TARGET,
            fret.TARGET,
            interceptor.TARGET,
            dafny.TARGET,
        )
    }
)

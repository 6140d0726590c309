"""The targets, in one table: what `--emit` can make."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from compiler.targets import dafny, fret, ltl, prism
from compiler.targets import json_record as records
from compiler.targets.ajpf import bundle
from compiler.targets.ajpf import properties as ajpf
from compiler.targets.automata import dot, hoa, smv
from compiler.targets.python import interceptor, monitor
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

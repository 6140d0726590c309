"""What people wait for, beside its limit, one line each.

    python -m benchmarks [NAME ...]    # for example: python -m benchmarks startup tables

Runs every benchmark that has limits, or those that are named; all of them take some 25 minutes on
idle cores. `benchmarks/README.md` tells what each one measures.
"""

from __future__ import annotations

import argparse
from importlib import import_module

NAMES = (
    "startup",
    "editing",
    "small_logs",
    "columns",
    "fleet",
    "watching",
    "live_latency",
    "tables",
    "monitoring",
    "compiled_monitors",
    "report",
    "requirement_sets",
    "verification",
)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("name", nargs="*", help=f"one of {', '.join(NAMES)}")
    names = parser.parse_args().name or NAMES
    unknown = sorted({*names}.difference(NAMES))
    if unknown:
        parser.error(f"no benchmark {unknown[0]}: one of {', '.join(NAMES)}")
    for name in names:
        place = f"benchmarks.{name}"
        module = f"{place}.__main__" if hasattr(import_module(place), "__path__") else place
        for figure in import_module(module).figures():
            print(figure, flush=True)


if __name__ == "__main__":
    main()

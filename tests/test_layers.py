"""Packages stand in one order, folders stay small, and each library comes in through its own door.

The order below is the architecture: a package imports only what stands above it in the list.
"""

import ast
import sys
from functools import cache
from pathlib import Path

import pytest

from tests.each import each

ROOT = Path(__file__).parent.parent
ORDER = """
monitors.kernel  monitors
fretish.classes  fretish.system  fretish.diagnostics  fretish.reading  fretish.error_rules  fretish
fretish.formulas  fretish.bindings  fretish.bindings.tables  fretish.english
compiler.files  compiler.logic.diagrams  compiler.logic.ordering  compiler.logic.spelling
compiler.logic  compiler.formalization  compiler.formalization.numbers
compiler.situations  compiler.project  compiler.project.tlsf  compiler.agents
compiler.program  compiler.signals
compiler.targets  compiler.targets.python  compiler.targets.c  compiler.targets.rust
compiler.targets.java  compiler.targets.ros  compiler.targets.javascript
compiler.targets.automata  compiler.targets.ajpf
compiler  compiler.explanation
fretc.logs.signals  fretc.logs.mcap  fretc.logs.messages  fretc.logs.storage  fretc.logs.tables
fretc.logs.agents  fretc.logs.frames  fretc.logs.windows
fretc.logs
fretc.audit.measurements  fretc.audit.phases  fretc.audit.evidence  fretc.audit.store  fretc.audit
fretc.audit.selection  fretc.audit.outputs  fretc.audit.bindings
fretc.verification.engines  fretc.verification.monitor  fretc.verification.compiled
fretc.verification.c  fretc.verification.rust  fretc.verification.java
fretc.verification.javascript  fretc.verification.interceptor
fretc.verification.loop  fretc.verification.layers  fretc.verification
fretc.analysis.arena  fretc.analysis.arithmetic  fretc.analysis.games  fretc.analysis.controllers
fretc.analysis
fretc.testing  fretc.testing.exports  fretc.testing.conformance  fretc.writing  fretc.coverage
fretc.traceability  fretc.attestation  fretc.reproduction
fretc.report.model  fretc.report.pictures  fretc.report.set_analysis
fretc.report.sections  fretc.report.front
fretc.report.across  fretc.report.page  fretc.report.forms  fretc.report  fretc.checking
fretc.trends
simulation.world  simulation.nodes  simulation
fretc.play  fretc.terminal  fretc.rosbridge  fretc.campaigns  fretc.testing.log_synthesis
fretc.watch.sources  fretc.watch.zenoh  fretc.watch  fretc.watch.publishing  fretc.lsp
fretc.api  fretc.commands  fretc
""".split()
ROOMS = {package.partition(".")[0] for package in ORDER}
NOT = {  # what stands above, and is still not to be known
    "fretc.logs": {"compiler"},
    "simulation": ROOMS - {"simulation"},
    "fretc.verification": {"fretc.logs", "fretc.audit"},
    "fretish": {"monitors"},
}
CLICK = {
    "fretc/cli.py",
    *(
        f"fretc/{p}/{m.name}"
        for p in ("commands", "terminal")
        for m in ROOT.joinpath("fretc", p).glob("*.py")
    ),
}
LSP = {f"fretc/lsp/{module.name}" for module in ROOT.glob("fretc/lsp/*.py")}
"""The types of the protocol are those of the answers; `server.py` alone sends and receives."""
DOORS = {
    "lark": {
        "compiler/agents/gwendolen.py",
        "compiler/agents/gwendolen_errors.py",
        "fretish/reading/grammars.py",
    },
    "spot": {"compiler/logic/diagrams/buddy_engine.py", "compiler/logic/spot.py"},
    "buddy": {"compiler/logic/diagrams/buddy_engine.py", "compiler/logic/spot.py"},
    "oxidd": {"compiler/logic/diagrams/oxidd_engine.py"},
    "jinja2": {"compiler/files/template_engine.py", "compiler/files/templating.py"},
    "pygments": {"fretc/pygments_lexer.py"},
    "securesystemslib": {"fretc/attestation/keys.py"},
    "cryptography": {"fretc/attestation/keys.py"},
    "cyclonedx": {"fretc/attestation/sbom.py"},
    "pyarrow": {
        "fretc/audit/outputs/table.py",
        "fretc/audit/store/earlier_store.py",
        "fretc/logs/tables/arrow_rows.py",
    },
    "distributed": {"fretc/audit/dask_executor.py"},
    "dask": {"fretc/audit/dask_executor.py"},
    "mujoco": {"simulation/world/robot.py"},
    "matplotlib": {"simulation/picture.py"},
    "msgspec": {"compiler/files/records.py"},
    "rosbags": {
        "fretc/logs/messages/idl.py",
        "fretc/logs/messages/ros2_types.py",
        "fretc/logs/storage/bags.py",
        "fretc/testing/log_synthesis/messages.py",
        "simulation/nodes/messages.py",
        "simulation/recording.py",
    },
    "mcap": {
        "fretc/audit/outputs/annotations.py",
        "fretc/logs/mcap/container.py",
        "fretc/logs/mcap/index.py",
        "fretc/logs/mcap/metadata.py",
        "fretc/logs/mcap/projection.py",
        "fretc/logs/mcap/walk.py",
        "fretc/logs/messages/decoding.py",
        "fretc/logs/storage/bags.py",
        "fretc/logs/storage/packed_topics.py",
        "fretc/logs/tables/contents.py",
        "fretc/watch/decoding.py",
        "fretc/watch/recording.py",
        "fretc/watch/sources/log.py",
        "simulation/recording.py",
    },
    "pyulog": {"fretc/logs/storage/ulog.py"},
    "fsspec": {"fretc/logs/storage/inputs.py", "fretc/logs/storage/listings.py"},
    "aiohttp": {"fretc/logs/storage/web.py"},
    "z3": {
        "compiler/formalization/numbers/reals.py",
        "compiler/formalization/numbers/terms.py",
        "fretc/analysis/arithmetic/alphabet.py",
        "fretc/analysis/arithmetic/atoms.py",
        "fretc/analysis/arithmetic/cells.py",
        "fretc/analysis/arithmetic/group_content.py",
        "fretc/analysis/arithmetic/groups.py",
        "fretc/analysis/arithmetic/past.py",
        "fretc/analysis/arithmetic/projection.py",
        "fretc/analysis/arithmetic/separate.py",
        "fretc/analysis/arithmetic/steps.py",
        "fretc/analysis/arithmetic/thresholds.py",
        "fretc/analysis/games/unrolling.py",
        "fretc/verification/loop/invariant.py",
    },
    "reqif": {"compiler/project/parents.py", "fretc/report/forms/reqif.py"},
    "yaml": {"fretc/report/forms/gsn.py", "fretish/reading/yaml_text.py"},
    "mcap_protobuf": {"fretc/logs/messages/protobuf.py"},
    "mcap_ros1": {"fretc/logs/messages/decoding.py"},
    "mcap_ros2": {"fretc/logs/messages/decoding.py"},
    "zstandard": {"fretc/audit/store/container.py", "fretc/logs/mcap/container.py"},
    "zlib_ng": {"fretc/logs/mcap/container.py"},
    "lz4": {"fretc/logs/mcap/container.py"},
    "wcwidth": {"fretc/terminal/screen.py"},
    "cyclonedds": {"fretc/watch/sources/dds_domain.py", "fretc/watch/sources/dds_types.py"},
    "zenoh": {"fretc/watch/zenoh/session.py"},
    "websockets": {"fretc/rosbridge/endpoint.py", "fretc/watch/sources/foxglove.py"},
    "foxglove": {"fretc/watch/publishing/foxglove_server.py"},
    "pygls": {"fretc/lsp/server.py"},
    "lsprotocol": LSP,
    "click": CLICK,
    # Only Linux and macOS have these, or only Windows.
    "fcntl": {"compiler/targets/ajpf/runner.py", "fretish/system/files.py"},
    "resource": {"fretish/system/resources.py"},
    "msvcrt": {"fretish/system/files.py"},
    **{key: set[str]() for key in ("grp", "pty", "pwd", "termios", "tty")},
}
"""Each library, and the modules that import it."""
MOST = 16
"""Modules of a folder, beside its `__init__.py`."""


def modules() -> list[Path]:
    return sorted(path for room in ROOMS for path in (ROOT / room).rglob("*.py"))


def package_of(module: Path) -> str:
    return ".".join(module.relative_to(ROOT).parent.parts)


def within(package: str, room: str) -> bool:
    return package == room or package.startswith(room + ".")


@cache
def names(module: Path) -> frozenset[str]:
    """Everything that it imports, wherever in it."""
    found = set[str]()
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}: imports are absolute"
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return frozenset(found)


def imported(module: Path) -> set[str]:
    """The packages of ours that it imports from."""
    return {package(name) for name in names(module) if name.partition(".")[0] in ROOMS}


@cache
def package(name: str) -> str:
    """The innermost one that the name is in."""
    parts = name.split(".")
    while not (ROOT.joinpath(*parts).is_dir() and ".".join(parts) in ORDER):
        parts.pop()
    return ".".join(parts)


def libraries(module: Path) -> set[str]:
    """The top-level names of everything that it imports."""
    return {name.partition(".")[0] for name in names(module)}


@pytest.mark.slow
@each("module", modules())
def test_a_module_imports_only_from_packages_before_its_own(module: Path) -> None:
    here = package_of(module)
    forbidden = {one for room, others in NOT.items() if within(here, room) for one in others}
    for there in imported(module):
        assert ORDER.index(there) <= ORDER.index(here), f"{here} -> {there}"
        assert not any(within(there, one) for one in forbidden), f"{here} -> {there}"


@pytest.mark.slow
@each("module", modules())
def test_a_library_comes_in_through_its_door(module: Path) -> None:
    name = module.relative_to(ROOT).as_posix()
    for library in libraries(module) & DOORS.keys():
        assert name in DOORS[library], f"{name} imports {library}"


def test_the_order_names_every_package_once() -> None:
    assert len(ORDER) == len(set(ORDER))
    assert {package_of(module) for module in modules()} == set(ORDER)


@each("package", ORDER)
def test_a_folder_can_be_taken_in_at_a_glance(package: str) -> None:
    names = [p for p in ROOT.joinpath(*package.split(".")).glob("*.py") if p.stem != "__init__"]
    assert len(names) <= MOST or package == "fretc.commands"  # a module a command
    assert package.count(".") <= 2


@each("package", ORDER)
def test_a_package_s_face_imports_nothing(package: str) -> None:
    """Or to import one module of it would import them all: that is how hidden circles begin."""
    if package == "monitors.kernel":  # a monitor that is loaded needs all of it
        return
    if package == "fretc":  # names for a type checker alone: tests/fretc/test_api.py
        return
    face = ROOT.joinpath(*package.split("."), "__init__.py")
    assert not imported(face)


def test_what_flies_needs_the_standard_library_only() -> None:
    for module in (ROOT / "monitors").rglob("*.py"):
        assert libraries(module) <= {*sys.stdlib_module_names, "monitors"}, module


def test_the_kernel_needs_nothing_of_ours_but_itself() -> None:
    """Its text is copied into every monitor."""
    for module in (ROOT / "monitors/kernel").glob("*.py"):
        assert imported(module) <= {"monitors.kernel"}, module


def test_the_interceptor_needs_the_standard_library_only() -> None:
    """Its text is copied into every emitted one."""
    assert libraries(ROOT / "monitors/interceptor.py") <= {*sys.stdlib_module_names}


def test_the_ticks_need_the_standard_library_only() -> None:
    """Their text is copied into every emitted node."""
    assert libraries(ROOT / "monitors/ticking.py") <= {*sys.stdlib_module_names}


def test_the_script_of_a_bundle_needs_the_standard_library_only() -> None:
    """Its text is copied into every bundle, which runs where fretc is not installed."""
    assert libraries(ROOT / "compiler/targets/ajpf/runner.py") <= {*sys.stdlib_module_names}

"""Which monitors a recorded proof may be about."""

import pytest

from compiler.emit import TARGETS
from compiler.files.text_files import sha256
from compiler.logic.claims import ClaimResult, Layer, Proof
from compiler.targets.target import TargetOptions
from fretc.traceability.artefacts import joint_monitors
from tests.monitoring import requirement


@pytest.mark.parametrize(
    ("target", "file"),
    [
        ("monitor", "monitors.py"),
        ("c", "monitors.c"),
        ("rust", "lib.rs"),
        ("js", "monitors.mjs"),
        ("java", "Monitors.java"),
    ],
)
def test_a_proof_about_a_file_for_several_requirements_is_about_the_file_of_today(
    target: str, file: str
) -> None:
    first = requirement("whenever p the sw shall within 3 ticks satisfy q", id="R1")
    second = requirement("the sw shall always satisfy p", id="R2")
    products = TARGETS[target].emit([first, second], TargetOptions(one_file=True))
    text = next(product.text for product in products if product.path.name == file)
    proofs = [
        Proof(id, Layer.MONITOR, "c", ClaimResult.PROVED, "d", (), "e", {file: sha256(text)})
        for id in ("R1", "R2")
    ]
    assert sha256(text) in joint_monitors([first, second], proofs)
    assert joint_monitors([first, second], []) == frozenset()

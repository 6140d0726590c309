"""What the JUnit reader of Jenkins takes: the schema as far as our elements go.

Source: https://github.com/jenkinsci/xunit-plugin, junit-10.xsd.
"""

from collections.abc import Iterator
from xml.etree.ElementTree import Element

MAY: dict[str, tuple[set[str], set[str], set[str]]] = {
    "testsuites": (set(), {"name", "time", "tests", "failures", "errors"}, {"testsuite"}),
    "testsuite": (
        {"name", "tests", "failures", "errors"},
        {"group", "time", "skipped", "timestamp", "hostname", "id", "package", "file", "log"},
        {"testsuite", "properties", "testcase", "system-out", "system-err"},
    ),
    "testcase": (
        {"name"},
        {"time", "classname", "group"},
        {"skipped", "error", "failure", "system-out", "system-err"},
    ),
    **{kind: (set(), {"type", "message"}, set()) for kind in ("skipped", "error", "failure")},
}
"""Of each element the attributes that it must have, those that it may have, and its children."""


def complaints(root: Element) -> Iterator[str]:
    """Elements and attributes that the schema does not have, or misses."""
    if root.tag not in ("testsuites", "testsuite"):
        yield f"{root.tag} is no root"
    for element in root.iter():
        must, may, children = MAY.get(element.tag, (set(), set(), set()))
        names = set(element.keys())
        yield from (f"{element.tag} without {name}" for name in must - names)
        yield from (f"{element.tag} with {name}" for name in names - must - may)
        yield from (
            f"{child.tag} in {element.tag}" for child in element if child.tag not in children
        )

"""`--gsn`: the assurance argument as YAML that gsn2x reads.

Counter-solutions and what they defeat are written as gsn2x reads the dialectic extension.
Source: gsn2x, Syntax in YAML; Dialectic Extension.
"""

from __future__ import annotations

from typing import Any

import yaml

from fretc.report.model.views import ReportView
from fretc.report.sections.argument import Element, argument


def gsn(report: ReportView) -> str:
    """The argument as YAML."""
    head = f"# The argument of the report by fretc {report.fretc}; for gsn2x.\n"
    elements = {element.id: _attributes(element) for element in argument(report)}
    return head + yaml.safe_dump(elements, sort_keys=False, allow_unicode=True, width=100)


def _attributes(element: Element) -> dict[str, Any]:
    attributes: dict[str, Any] = {"text": " ".join(element.text.split())}
    if element.supported_by:
        attributes["supportedBy"] = list(element.supported_by)
    if element.in_context_of:
        attributes["inContextOf"] = list(element.in_context_of)
    if element.undeveloped:
        attributes["undeveloped"] = True
    if element.challenges:
        attributes["challenges"] = element.challenges
    if element.defeated:
        attributes["defeated"] = True
    return attributes

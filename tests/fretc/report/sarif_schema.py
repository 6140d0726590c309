"""The part of the JSON schema of SARIF 2.1.0 that an audit uses, with nothing beside it.

A file that fits this fits the whole schema: each object has the fields, types and demands that it
has there, less the fields that fretc does not write.

Source: OASIS, sarif-schema-2.1.0.json (errata 01).
"""

from typing import Any

TEXT = {"type": "string"}
INDEX = {"type": "integer", "minimum": -1}
LINE = {"type": "integer", "minimum": 1}
LEVEL = {"type": "string", "enum": ["none", "note", "warning", "error"]}
TEXTS = {"type": "object", "additionalProperties": TEXT}


def ref(name: str) -> dict[str, Any]:
    return {"$ref": f"#/definitions/{name}"}


def many(name: str, *, unique: bool = True) -> dict[str, Any]:
    return {"type": "array", "uniqueItems": unique, "items": ref(name)}


def kind(required: str = "", any_of: str = "", **fields: Any) -> dict[str, Any]:
    """An object with these fields and a property bag."""
    fields["properties"] = ref("propertyBag")
    schema: dict[str, Any] = {"type": "object", "additionalProperties": False, "properties": fields}
    if required:
        schema["required"] = required.split()
    if any_of:
        schema["anyOf"] = [{"required": [name]} for name in any_of.split()]
    return schema


DEFINITIONS = {
    "artifact": kind(
        location=ref("artifactLocation"),
        length=INDEX,
        roles={"type": "array", "uniqueItems": True, "items": {"enum": ["analysisTarget"]}},
        hashes=TEXTS,
        sourceLanguage=TEXT,
    ),
    "artifactLocation": kind(
        uri={"type": "string", "format": "uri-reference"},
        uriBaseId=TEXT,
        index=INDEX,
        description=ref("message"),
    ),
    "invocation": kind(
        "executionSuccessful",
        executionSuccessful={"type": "boolean"},
        toolExecutionNotifications=many("notification", unique=False),
    ),
    "location": kind(physicalLocation=ref("physicalLocation")),
    "message": kind("text", text=TEXT),
    "multiformatMessageString": kind("text", text=TEXT),
    "notification": kind(
        "message",
        descriptor=ref("reportingDescriptorReference"),
        level=LEVEL,
        locations=many("location"),
        message=ref("message"),
    ),
    "physicalLocation": kind(
        "artifactLocation", artifactLocation=ref("artifactLocation"), region=ref("region")
    ),
    "propertyBag": {"type": "object"},
    "region": kind("startLine", startLine=LINE, startColumn=LINE, endLine=LINE, endColumn=LINE),
    "reportingConfiguration": kind(level=LEVEL),
    "reportingDescriptor": kind(
        "id",
        id=TEXT,
        shortDescription=ref("multiformatMessageString"),
        fullDescription=ref("multiformatMessageString"),
        help=ref("multiformatMessageString"),
        defaultConfiguration=ref("reportingConfiguration"),
    ),
    "reportingDescriptorReference": kind("", "id index", id=TEXT, index=INDEX),
    "result": kind(
        "message",
        ruleId=TEXT,
        ruleIndex=INDEX,
        kind={"enum": ["notApplicable", "pass", "fail", "review", "open", "informational"]},
        level=LEVEL,
        message=ref("message"),
        analysisTarget=ref("artifactLocation"),
        locations=many("location", unique=False),
        partialFingerprints=TEXTS,
    ),
    "run": kind(
        "tool",
        tool=ref("tool"),
        invocations=many("invocation", unique=False),
        originalUriBaseIds={"type": "object", "additionalProperties": ref("artifactLocation")},
        artifacts=many("artifact"),
        columnKind={"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
        results=many("result", unique=False),
    ),
    "tool": kind("driver", driver=ref("toolComponent")),
    "toolComponent": kind(
        "name",
        name=TEXT,
        semanticVersion=TEXT,
        informationUri={"type": "string", "format": "uri"},
        rules=many("reportingDescriptor"),
        notifications=many("reportingDescriptor"),
    ),
}

SARIF = {
    "$schema": "http://json-schema.org/draft-04/schema#",
    "type": "object",
    "additionalProperties": False,
    "required": ["version", "runs"],
    "properties": {
        "$schema": {"type": "string", "format": "uri"},
        "version": {"enum": ["2.1.0"]},
        "runs": many("run", unique=False),
    },
    "definitions": DEFINITIONS,
}

"""`--reqif`: hazards, requirements and their verdicts, for a requirements tool.

Sources: OMG, Requirements Interchange Format (ReqIF) 1.2; prostep ivip, ReqIF Implementation
Guide, for the names that begin with `ReqIF.`.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from html import escape

from reqif.models.reqif_core_content import ReqIFCoreContent
from reqif.models.reqif_data_type import (
    ReqIFDataTypeDefinitionEnumeration,
    ReqIFDataTypeDefinitionString,
    ReqIFDataTypeDefinitionXHTML,
    ReqIFEnumValue,
)
from reqif.models.reqif_namespace_info import ReqIFNamespaceInfo
from reqif.models.reqif_req_if_content import ReqIFReqIFContent
from reqif.models.reqif_reqif_header import ReqIFReqIFHeader
from reqif.models.reqif_spec_hierarchy import ReqIFSpecHierarchy
from reqif.models.reqif_spec_object import ReqIFSpecObject, SpecObjectAttribute
from reqif.models.reqif_spec_object_type import ReqIFSpecObjectType, SpecAttributeDefinition
from reqif.models.reqif_spec_relation import ReqIFSpecRelation
from reqif.models.reqif_spec_relation_type import ReqIFSpecRelationType
from reqif.models.reqif_specification import ReqIFSpecification
from reqif.models.reqif_specification_type import ReqIFSpecificationType
from reqif.models.reqif_types import SpecObjectAttributeType
from reqif.object_lookup import ReqIFObjectLookup
from reqif.reqif_bundle import ReqIFBundle
from reqif.unparser import ReqIFUnparser

from compiler.files.dates import source_date
from fretc.audit.outputs.junit import valid
from fretc.report.forms.reqif_attributes import (
    HAZARD,
    REQUIREMENT,
    WORDS,
    AttributeType,
    of_hazard,
    of_requirement,
)
from fretc.report.model.views import ReportView

_KINDS = {
    AttributeType.ID: SpecObjectAttributeType.STRING,
    AttributeType.TEXT: SpecObjectAttributeType.XHTML,
    AttributeType.WORD: SpecObjectAttributeType.ENUMERATION,
}
_HAZARDS, _REQUIREMENTS, _PARENT = "type-hazard", "type-requirement", "type-parent"
_NEVER = datetime.fromtimestamp(0, UTC)


def reqif(report: ReportView) -> str:
    """The ReqIF XML; equal reports give equal bytes.

    The time of change is `SOURCE_DATE_EPOCH`, or the beginning of 1970 if that is not set, so that
    two exports of the same report are equal.
    """
    return str(ReqIFUnparser.unparse(_Exchange(report).bundle()))


class _Exchange:
    def __init__(self, report: ReportView) -> None:
        self._report = report
        self._changed = (source_date() or _NEVER).isoformat()
        self._hazards = {hazard.id: f"hazard-{_name(hazard.id)}" for hazard in report.hazards}
        self._objects = list(_objects(report))

    def bundle(self) -> ReqIFBundle:
        report = self._report
        header = ReqIFReqIFHeader(
            identifier="header",
            creation_time=self._changed,
            req_if_tool_id=f"fretc {report.fretc}",
            req_if_version="1.0",
            source_tool_id=f"fretc {report.fretc}",
            title="Hazards, requirements and verdicts",
        )
        content = ReqIFReqIFContent(
            data_types=list(self._data_types()),
            spec_types=list(self._types()),
            spec_objects=list(self._spec_objects()),
            spec_relations=list(self._relations()),
            specifications=[self._specification()],
        )
        lookup = ReqIFObjectLookup.empty()
        space = ReqIFNamespaceInfo.create_default()
        return ReqIFBundle(space, header, ReqIFCoreContent(content), False, lookup, [])

    # Types -------------------------------------------------------------------------------------

    def _data_types(self) -> Iterator[object]:
        changed = self._changed
        yield ReqIFDataTypeDefinitionString(
            "string", last_change=changed, long_name="String", max_length="32000"
        )
        yield ReqIFDataTypeDefinitionXHTML(
            "xhtml", last_change=changed, long_name="XHTML", is_self_closed=True
        )
        for name, words in WORDS.items():
            values = [
                ReqIFEnumValue(
                    _word(name, word),
                    str(key),
                    last_change=changed,
                    long_name=word,
                    other_content="",
                )
                for key, word in enumerate(words)
            ]
            yield ReqIFDataTypeDefinitionEnumeration(
                name.lower(), last_change=changed, long_name=name, values=values
            )

    def _types(self) -> Iterator[object]:
        changed = self._changed
        yield self._type(_HAZARDS, "Hazard", HAZARD)
        yield self._type(_REQUIREMENTS, "Requirement", REQUIREMENT)
        yield ReqIFSpecRelationType(_PARENT, last_change=changed, long_name="Parent")
        yield ReqIFSpecificationType(
            "type-specification",
            last_change=changed,
            long_name="Specification",
            is_self_closed=True,
        )

    def _type(
        self, id: str, name: str, attributes: Mapping[str, AttributeType]
    ) -> ReqIFSpecObjectType:
        definitions = [
            SpecAttributeDefinition(
                attribute_type=_KINDS[kind],
                identifier=_attribute(id, attribute),
                datatype_definition=attribute.lower() if kind is AttributeType.WORD else kind.value,
                last_change=self._changed,
                long_name=attribute,
                multi_valued=False if kind is AttributeType.WORD else None,
            )
            for attribute, kind in attributes.items()
        ]
        return ReqIFSpecObjectType(
            id, last_change=self._changed, long_name=name, attribute_definitions=definitions
        )

    # Objects -----------------------------------------------------------------------------------

    def _spec_objects(self) -> Iterator[ReqIFSpecObject]:
        for hazard in self._report.hazards:
            values = of_hazard(hazard)
            yield self._object(self._hazards[hazard.id], _HAZARDS, HAZARD, values)
        for id, view in zip(self._objects, self._report.requirements, strict=True):
            yield self._object(id, _REQUIREMENTS, REQUIREMENT, of_requirement(view))

    def _object(
        self,
        id: str,
        kind_of: str,
        attributes: Mapping[str, AttributeType],
        values: Mapping[str, str],
    ) -> ReqIFSpecObject:
        """A specification object; empty values are left out."""
        attributes_ = [
            SpecObjectAttribute(
                _KINDS[kind], _attribute(kind_of, name), _value(kind, name, values[name])
            )
            for name, kind in attributes.items()
            if (values[name] if kind is AttributeType.ID else values[name].strip())
        ]
        return ReqIFSpecObject(id, attributes_, kind_of, last_change=self._changed)

    def _relations(self) -> Iterator[ReqIFSpecRelation]:
        """A relation from each requirement to each of its parents in the file."""
        ids = [view.id for view in self._report.requirements]
        identifiers = {
            **dict(zip(reversed(ids), reversed(self._objects), strict=True)),
            **self._hazards,
        }
        for id, view in zip(self._objects, self._report.requirements, strict=True):
            for parent in dict.fromkeys(parent.id for parent in view.parents):
                if parent in identifiers:
                    yield ReqIFSpecRelation(
                        identifier=f"parent-{id}-of-{identifiers[parent]}",
                        last_change=self._changed,
                        relation_type_ref=_PARENT,
                        source=id,
                        target=identifiers[parent],
                    )

    # The order ---------------------------------------------------------------------------------

    def _specification(self) -> ReqIFSpecification:
        return ReqIFSpecification(
            "specification",
            last_change=self._changed,
            long_name=valid(self._report.project),
            specification_type="type-specification",
            children=list(self._places()),
        )

    def _places(self) -> Iterator[ReqIFSpecHierarchy]:
        """The hierarchy: each hazard with its requirements, then requirements without a hazard.

        An object appears only once, because tools treat it as one item (StrictDoc refuses a second
        one). A requirement appears below its first hazard; relations give the others.
        """
        anchors = [view.anchor for view in self._report.requirements]
        left = dict(zip(anchors, self._objects, strict=True))
        for hazard in self._report.hazards:
            rows = [row.anchor for row in self._report.matrix if row.hazard == hazard.id]
            below = [left.pop(anchor) for anchor in rows if anchor in left]
            children = [self._place(id, 2) for id in below]
            yield self._place(self._hazards[hazard.id], 1, children)
        for id in left.values():
            yield self._place(id, 1)

    def _place(
        self, id: str, level: int, children: Sequence[ReqIFSpecHierarchy] = ()
    ) -> ReqIFSpecHierarchy:
        return ReqIFSpecHierarchy(
            identifier=f"place-{id}",
            spec_object=id,
            level=level,
            children=list(children) or None,
            last_change=self._changed,
            editable=None,
            is_table_internal=None,
        )


def _objects(report: ReportView) -> Iterator[str]:
    """The identifier of each requirement; distinct even for duplicate ids."""
    counts: Counter[str] = Counter()
    for view in report.requirements:
        counts[view.id] += 1
        again = f"__{counts[view.id]}" if counts[view.id] > 1 else ""
        yield f"requirement-{_name(view.id)}{again}"


# XML -------------------------------------------------------------------------------------------


def _value(kind: AttributeType, name: str, text: str) -> str | list[str]:
    if kind is AttributeType.WORD:
        return [_word(name, text)]
    return _xhtml(text) if kind is AttributeType.TEXT else valid(text)


def _xhtml(text: str) -> str:
    """The text as XHTML, with a `<br/>` and a line end after each line."""
    lines = re.split(r"\r\n|[\r\n]", escape(valid(text.strip())))
    return "<xhtml:div>" + "<xhtml:br/>\n".join(lines) + "</xhtml:div>"


def _attribute(kind_of: str, name: str) -> str:
    return f"{kind_of}-{_name(name)}"


def _word(name: str, word: str) -> str:
    return f"{name.lower()}-{_name(word)}"


def _name(id: str) -> str:
    """A valid XML id: other characters become `_` code point `_`; distinct for distinct ids."""
    return re.sub(r"[^A-Za-z0-9.-]", lambda match: f"_{ord(match[0]):x}_", id)

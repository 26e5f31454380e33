"""States of a schema as a rule sees them: a subject with the one as it is and the other as it was."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from mutations import write

from generator import rules
from generator.diagnostics import Diagnostic, Span
from generator.ledger import Ledger
from generator.protoc import compile_tree
from generator.protos import Schema
from generator.subject import Change, Subject
from generator.table import EnvelopeSettings, Outputs, ProtoSettings, Table

ROOT = "proto"
_NOWHERE = Span("mapping.yaml")
TABLE = Table(
    file="mapping.yaml",
    whole=True,
    numbers=frozenset(),
    proto=ProtoSettings(_NOWHERE, {}, ROOT, ()),
    envelope=EnvelopeSettings(_NOWHERE, {}, "", "", "", "proto"),
    package="rover_msgs",
    package_span=_NOWHERE,
    maintainer="",
    peers=(),
    rows=(),
    retired=(),
    enums=(),
    outputs=Outputs(_NOWHERE, {}, (), ()),
    lint=(),
)
FAMILIES = ("WIR", "JSN", "SRC")
"""What the ids of the rules about changes begin with."""


def compiled(state: Mapping[str, str], folder: Path, shown_root: str = ROOT) -> Schema:
    """The schema of a state, which has to compile."""
    schema, findings = compile_tree(write(dict(state), folder), sorted(state), shown_root)
    assert not findings, "\n".join(finding.render() for finding in findings)
    return schema


def changes_found(before: Schema | Iterable[Change], after: Schema, ledger: Ledger | None = None) -> list[Diagnostic]:
    """What the rules about changes find between two states."""
    changes = (Change(before, after, "before"),) if isinstance(before, Schema) else tuple(before)
    return found(Subject(table=TABLE, schema=after, ledger=ledger or Ledger(), changes=changes))


def found(subject: Subject) -> list[Diagnostic]:
    """What the rules about changes find."""
    ours = (module for id, module in rules.modules().items() if id.startswith(FAMILIES))
    return list(dict.fromkeys(finding for module in ours for finding in module.check(subject)))

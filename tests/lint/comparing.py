"""States of a schema as a rule sees them: a context with the one as it is and the other as it was."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from mutations import write

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.lint.comparison import SchemaChange
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.rules import lint_rules
from roverlink.generator.lock import Ledger
from roverlink.generator.protos.protoc import compile_tree
from roverlink.generator.protos.schema import Schema
from roverlink.generator.table import FORMAT_VERSION, EnvelopeSettings, ProtoSettings, RosSettings, Table

ROOT = "proto"
_NOWHERE = Span("mapping.yaml")
TABLE = Table(
    file="mapping.yaml",
    whole=True,
    numbers=frozenset(),
    version=FORMAT_VERSION,
    proto=ProtoSettings(span=_NOWHERE, root=ROOT),
    envelope=EnvelopeSettings(span=_NOWHERE, file="", message="", oneof="", owner="proto"),
    ros=RosSettings(span=_NOWHERE, package="rover_msgs"),
    peers=(),
    rows=(),
)
FAMILY = "WIR"
"""What the ids of the rules about changes begin with."""


def compiled(state: Mapping[str, str], folder: Path, shown_root: str = ROOT) -> Schema:
    """The schema of a state, which has to compile."""
    schema, findings = compile_tree(write(dict(state), folder), sorted(state), shown_root)
    assert not findings, "\n".join(finding.render() for finding in findings)
    return schema


def changes_found(
    before: Schema | Iterable[SchemaChange], after: Schema, ledger: Ledger | None = None
) -> list[Diagnostic]:
    """What the rules about changes find between two states."""
    changes = (SchemaChange(before, after),) if isinstance(before, Schema) else tuple(before)
    return found(Context(table=TABLE, schema=after, ledger=ledger or Ledger(), changes=changes))


def found(context: Context) -> list[Diagnostic]:
    """What the rules about changes find."""
    ours = (rule for id, rule in lint_rules().items() if id.startswith(FAMILY))
    return list(dict.fromkeys(finding for rule in ours for finding in rule.check(context)))


def case_table(text: str) -> dict[str, tuple[str, str, str]]:
    """Read cases of two lines, ``NAME | BEFORE`` and ``EXPECTED | AFTER``: before, after and what is expected, by name.

    A dash stands for nothing that is expected.
    """
    cells = [line.split(" | ") for line in text.strip().splitlines()]
    return {
        name: (before, after, "" if expected == "-" else expected)
        for (name, before), (expected, after) in zip(cells[::2], cells[1::2], strict=True)
    }

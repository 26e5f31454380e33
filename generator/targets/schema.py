"""The JSON Schema of mapping.yaml, by which editors complete and check it."""

from __future__ import annotations

import json

from generator import ir
from generator.table_format import json_schema
from generator.targets.rendering import REGENERATE, Files


def emit(_: ir.Bridge) -> Files:
    """The schema; it says what a table may hold, whatever this one does."""
    yield "generated/mapping.schema.json", json.dumps({"$comment": REGENERATE, **json_schema()}, indent=2) + "\n"

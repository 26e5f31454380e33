"""The JSON Schema of mapping.yaml, by which editors complete and check it."""

from __future__ import annotations

import json

from generator.rendering import REGENERATE, Files
from generator.table_format import json_schema


def emit() -> Files:
    """The schema; it says what a table may hold, whatever this one does."""
    yield "generated/mapping.schema.json", json.dumps({"$comment": REGENERATE, **json_schema()}, indent=2) + "\n"

"""The JSON Schema of mapping.yaml, by which editors complete and check it."""

from __future__ import annotations

import json

from generator.json_schema import json_schema
from generator.rendering import REGENERATE, Files


def emit() -> Files:
    """The schema; it says what a table may hold, whatever this one does."""
    yield "generated/mapping.schema.json", json.dumps({"$comment": REGENERATE, **json_schema()}, indent=2) + "\n"

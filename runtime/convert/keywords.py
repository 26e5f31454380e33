"""Fields of payloads that are named by keywords of Python."""

from __future__ import annotations

from typing import Any


def keywords(fields: dict[str, Any]) -> dict[str, Any]:
    """Fields as keyword arguments, whatever their names and their types."""
    return fields

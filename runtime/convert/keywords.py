"""Proto fields whose names are Python keywords."""

from __future__ import annotations

from typing import Any


def keywords(fields: dict[str, Any]) -> dict[str, Any]:
    """Return a dict typed so that it can be passed as keyword arguments of any type: ``Payload(**keywords({...}))``."""
    return fields

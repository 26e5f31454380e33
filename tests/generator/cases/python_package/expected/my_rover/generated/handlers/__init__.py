# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The handlers: one a row of the table."""

from __future__ import annotations

from my_rover.generated.handlers.note import NoteHandler

__all__ = [
    "NoteHandler",
]

# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The handlers and the registry that are compiled from mapping.yaml."""

from __future__ import annotations

from my_rover.generated.handlers import NoteHandler
from my_rover.generated.registry import REGISTRY

__all__ = [
    "NoteHandler",
    "REGISTRY",
]

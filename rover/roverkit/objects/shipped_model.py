"""Model that ships with roverkit: it finds rendered rocks and parts of rendered panels (rover/docs/model-card.md)."""

from __future__ import annotations

from pathlib import Path

PATH = Path(__file__).with_name("rocks_and_panels.onnx")
"""ONNX file of the model."""

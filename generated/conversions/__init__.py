# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Conversions of the messages that stand inside payloads, one module each."""

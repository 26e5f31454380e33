# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Conversions of the messages inside payloads: one module for each."""

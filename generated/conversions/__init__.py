# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Conversions of nested messages: one module for each message."""

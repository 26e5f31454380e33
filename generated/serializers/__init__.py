# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Handlers that convert and serialize in one step; the registry loads them."""

# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The code that is compiled from the table."""

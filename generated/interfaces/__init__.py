# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The messages of other ROS 2 packages that are used here, one module a package."""

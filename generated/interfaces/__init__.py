# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of other ROS 2 packages: one module for each package."""

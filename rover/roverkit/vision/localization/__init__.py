"""Localization: landmarks with known poses on the field, and the poses of the cameras and the rover from them."""

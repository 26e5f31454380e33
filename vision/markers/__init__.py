"""Markers: definition, detection, and tracking."""

"""Markers: which there are, how they are found, and how they are followed."""

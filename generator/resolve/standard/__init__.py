"""Conversion of rows to standard messages of ROS 2: checked in both directions, and resolved to the IR."""

from roverlink.generator.resolve.standard.mappings import StandardTopics

__all__ = ["StandardTopics"]

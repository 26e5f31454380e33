"""Conversion between payloads and standard messages: checks the table's entries, and resolves them to the IR."""

from roverlink.generator.resolve.standard.mappings import StandardTopics

__all__ = ["StandardTopics"]

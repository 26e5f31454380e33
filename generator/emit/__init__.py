"""Emission of the IR as files."""

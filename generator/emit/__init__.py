"""The IR, written as files."""

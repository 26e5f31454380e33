"""From mapping.yaml to files: read, resolve, lint, emit, write."""

from generator.findings import Finding, FindingsError, Severity, Span
from generator.pipeline import Compiled, compile_table
from generator.write import Change, compare, write

__all__ = ["Change", "Compiled", "Finding", "FindingsError", "Severity", "Span", "compare", "compile_table", "write"]

"""Loaders of YAML: a fast one, and ones for texts from outside, with a limit for their nesting."""

from __future__ import annotations

from typing import Any

import yaml

FAST_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # ten times as fast; PyYAML may be built without it
_DEEPEST = 100  # levels; the composer calls itself for each one, and the scanner needs seconds for 1000 brackets


class _BoundedScanner(yaml.reader.Reader, yaml.scanner.Scanner):
    def fetch_flow_collection_start(self, token_class: Any) -> None:
        """Read a bracket or a brace."""
        self._check_depth()
        super().fetch_flow_collection_start(token_class)

    def add_indent(self, column: int) -> bool:
        """Begin a mapping or a list if the column is indented."""
        self._check_depth()
        return bool(super().add_indent(column))

    def _check_depth(self) -> None:
        if self.flow_level + len(self.indents) >= _DEEPEST:
            raise yaml.scanner.ScannerError(None, None, "it is nested too deeply", self.get_mark())


class BoundedLoader(_BoundedScanner, yaml.SafeLoader):
    """PyYAML's safe loader; it refuses a text that is nested too deeply."""


class BoundedBaseLoader(_BoundedScanner, yaml.BaseLoader):
    """PyYAML's loader of lists, mappings and texts alone; it refuses a text that is nested too deeply."""

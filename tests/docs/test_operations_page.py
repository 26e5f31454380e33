"""docs/operations.md lists the parameters of the node."""

from __future__ import annotations

import committed_tables
from page import ROOT


def test_the_parameters_are_those_of_the_node() -> None:
    """The table of parameters is made from their declarations."""
    page = (ROOT / "docs" / "operations.md").read_text(encoding="utf-8")

    assert page == committed_tables.current(page), "run: make docs-reference"

"""docs/targets.md lists the targets that there are."""

from __future__ import annotations

import re

from page import ROOT

from roverlink.generator.emit import targets

_PAGE = (ROOT / "docs" / "targets.md").read_text(encoding="utf-8")


def test_every_target_is_on_the_page() -> None:
    """The targets that come with the project are listed."""
    listed = re.findall(r"^\| `(\w+)` \| `", _PAGE, re.MULTILINE)
    assert set(targets.names()) <= set(listed)

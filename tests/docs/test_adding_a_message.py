"""docs/adding-a-message.md is true: whoever follows it gets there."""

from __future__ import annotations

from pathlib import Path

import pytest
from needs import NO_DDS
from page import ROOT, Reader, blocks


@pytest.mark.slow
def test_the_page_can_be_followed_step_by_step(tmp_path: Path) -> None:
    """Every file, edit and command of the page, in order, shows what the page shows."""
    pytest.importorskip("cyclonedds", reason=NO_DDS)
    with Reader.in_copy(tmp_path) as reader:
        reader.follow(blocks(ROOT / "docs" / "adding-a-message.md"))

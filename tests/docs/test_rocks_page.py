"""docs/rocks.md: its reasons are those of the code, and the lint accepts the fields that it proposes."""

from __future__ import annotations

import re
from importlib.util import find_spec
from pathlib import Path

import pytest
from needs import NO_OPENCV
from page import ROOT, Reader, blocks

_PAGE = ROOT / "docs" / "rocks.md"
_PROPOSAL = "Add a camera and a reason to the messages"


@pytest.mark.slow
def test_the_lint_accepts_the_proposed_fields(tmp_path: Path) -> None:
    """In a copy of the project, compared with the messages as they are."""
    with Reader.in_copy(tmp_path) as reader:
        reader.follow(blocks(_PAGE, _PROPOSAL))


@pytest.mark.skipif(not find_spec("cv2"), reason=NO_OPENCV)
def test_every_reason_stands_there() -> None:
    """In the table, and in the proposed enum."""
    from roverlink.vision.rocks import Unmeasurable

    page = _PAGE.read_text(encoding="utf-8")
    reasons = [reason.value for reason in Unmeasurable]
    assert re.findall(r"^\| `(\w+)` \| [^|]* \|$", page, re.MULTILINE) == reasons
    assert [name.lower() for name in re.findall(r"ROCK_MEASURE_FAILURE_(\w+) = [1-9]", page)] == reasons

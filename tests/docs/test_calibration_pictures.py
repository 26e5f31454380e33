"""The pictures of docs/calibration.md, made anew."""

from __future__ import annotations

from pathlib import Path

import pytest
from needs import NO_OPENCV
from page import ROOT

FOLDER = ROOT / "docs" / "calibration"


@pytest.mark.slow
def test_the_pictures_are_what_a_browser_shows(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """But for the letters of another version of the browser, and for what moves."""
    cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
    from bench.vision.page_pictures import main

    if main(["--out", str(tmp_path)]) != 0:
        pytest.skip(capsys.readouterr().err)
    made = sorted(path.name for path in tmp_path.glob("*.png"))
    assert made == sorted(path.name for path in FOLDER.glob("*.png"))
    for name in made:
        new, old = (cv2.imread(str(folder / name)).astype(int) for folder in (tmp_path, FOLDER))
        assert new.shape == old.shape
        assert abs(new - old).mean() < 12, name

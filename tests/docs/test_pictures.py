"""The pictures of rover/docs/vision.md, made anew."""

from __future__ import annotations

from pathlib import Path

import pytest
from needs import NO_OPENCV
from page import ROOT


def _differ(made: Path, shown: Path, tolerance: float) -> list[str]:
    """The pictures that do not look as they do on the page, but for another version's letters and rounding."""
    import cv2

    differ = []
    for path in sorted(made.glob("*.png")):
        new, old = (cv2.imread(str(one)).astype(int) for one in (path, shown / path.name))
        differ += [path.name] if new.shape != old.shape or abs(new - old).mean() >= tolerance else []
    return differ


@pytest.mark.slow
def test_the_pictures_of_vision_are_what_the_programs_draw(tmp_path: Path) -> None:
    """With the files beside them."""
    pytest.importorskip("cv2", reason=NO_OPENCV)
    pytest.importorskip("matplotlib", reason="need matplotlib (pip install matplotlib)")
    from rover.bench.vision.pictures import main

    shown = ROOT / "rover" / "docs" / "vision"
    assert main(["--quick", "--out", str(tmp_path)]) == 0
    assert _differ(tmp_path, shown, 6) == []
    for name in ("camera.yml", "landmarks.yaml", "cameras.yaml"):
        assert (tmp_path / name).read_bytes() == (shown / name).read_bytes()

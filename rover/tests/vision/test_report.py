"""The report of a calibration, read as a browser would."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from xml.etree import ElementTree

import numpy as np
import pytest
from roverkit.calibration import Calibration, calibrate
from roverkit.calibration.report import report

from rover.tests.vision.boards import BOARD, CAMERA, NOISE, views

pytestmark = pytest.mark.slow

VERSIONS = {"roverlink": "1.2.3", "OpenCV": "5.0.0"}
START_NS = 1_700_000_000_000_000_000  # 2023-11-14 22:13:20


@cache
def calibration() -> Calibration:
    """Twenty views: one is blurred and has a name that is no HTML, one has too few corners."""
    good = [replace(view, stamp_ns=START_NS + place * 10**9) for place, view in enumerate(views(CAMERA, 20, 11))]
    shake = np.random.default_rng(1).normal(0, 2, good[7].corners.shape)
    good[7] = replace(good[7], corners=good[7].corners + shake, name="<b>blurred & bent</b>.png")
    good[3] = replace(good[3], ids=good[3].ids[:5], corners=good[3].corners[:5])
    return calibrate(good, BOARD)


@cache
def page() -> str:
    return report(calibration(), BOARD, VERSIONS)


class _Text(HTMLParser):
    """The text of each table's rows, and whatever would be fetched."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.items: list[str] = []
        self.fetched: list[str] = []
        self._into: list[str] | None = None
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.fetched += [f"{tag} {name}" for name, _ in attributes if name in ("src", "href", "srcset", "data")]
        self.fetched += [tag] if tag in ("script", "link", "iframe", "object") else []
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")
            self._into = self.rows[-1]
        elif tag == "li":
            self.items.append("")
            self._into = self.items

    def handle_endtag(self, tag: str) -> None:
        if tag in ("td", "th", "li"):
            self._into = None

    def handle_data(self, data: str) -> None:
        if self._into is not None:
            self._into[-1] = (self._into[-1] + data).strip()


def pictures() -> dict[str, ElementTree.Element]:
    """The drawings of the page by their labels, read as XML."""
    drawn = [ElementTree.fromstring(text) for text in re.findall(r"<svg.*?</svg>", page(), re.DOTALL)]  # noqa: S314
    return {one.get("aria-label", ""): one for one in drawn}


def lines(picture: ElementTree.Element, kind: str) -> np.ndarray:
    """Beginning and direction (N, 4) of the lines of the paths of a class."""
    paths = [one.get("d", "") for one in picture.iter("path") if one.get("class") == kind]
    numbers = [re.findall(r"-?[\d.]+", step) for path in paths for step in path.split("M")[1:]]
    return np.array(numbers, dtype=float)


def test_it_needs_nothing_else() -> None:
    """Nothing is fetched, nothing runs, and the same calibration gives the same bytes: its times are the views'."""
    assert _Text(page()).fetched == []
    assert not re.search(r"url\(|@import|https?:", page())
    assert report(calibration(), BOARD, VERSIONS) == page()
    assert "2023-11-14 22:13:20 to 22:13:39 UTC" in page()


def test_every_number_has_its_interval() -> None:
    """With two digits of the interval, and as many decimals of the value."""
    rows = {row[0]: row[1:] for row in _Text(page()).rows if len(row) == 3}
    found = calibration()
    for name, value, deviation in zip(found.names, [*found.camera.focal, *found.camera.centre], found.deviations):
        half = calibration().interval * deviation
        said, interval = rows[name][0], rows[name][1].removeprefix("± ")
        assert float(interval) == pytest.approx(half, rel=0.05)
        assert float(said) == pytest.approx(value, abs=half / 10)
        assert len(said.partition(".")[2]) == len(interval.partition(".")[2])


def test_views_have_their_errors_and_dropped_ones_their_reasons() -> None:
    """Root mean square, worst, and place of the board; dropped views also in a list. A name is text, whatever it is."""
    text = _Text(page())
    few, blurred = sorted(text.items, key=lambda item: "blurred" in item)
    assert few.startswith("view 3: 5 corners found")
    assert blurred.startswith("<b>blurred & bent</b>.png: its corners are off by")
    table = {row[1]: row for row in text.rows if len(row) == 8}
    assert table["view 3"][2:7] == ["0 of 5", "–", "–", "–", "–"]
    assert "off by" in table["<b>blurred & bent</b>.png"][7]
    assert len(table) == 1 + 20
    for fitted in calibration().views:
        if not fitted.dropped:
            row = table[fitted.view.name]
            assert row[2] == f"{fitted.used.sum()} of {fitted.used.size}"
            assert float(row[3]) == pytest.approx(fitted.rms, abs=6e-4)
            assert float(row[3]) <= float(row[4]) < 12 * NOISE
            assert 0.2 < float(row[5]) < 2
            assert 0 <= float(row[6]) <= 45


def test_the_residuals_are_drawn_where_they_are() -> None:
    """A line begins where a corner should be, and leads towards where it was seen, magnified as is said."""
    magnified = float(re.search(r"magnified ([\d.]+) times", page())[1])  # type: ignore[index]  # else it fails
    picture = pictures()["Residuals over the image"]
    for kind, used in (("arrows", True), ("arrows bad", False)):
        drawn = lines(picture, kind)
        judged = [one for one in calibration().views if np.isfinite(one.residuals).all()]
        seen = np.concatenate([one.view.corners[one.used == used] for one in judged])
        misses = np.concatenate([one.residuals[one.used == used] for one in judged])
        assert drawn[:, :2] == pytest.approx(seen - misses + 0.5, abs=0.051)
        assert drawn[:, 2:] == pytest.approx(misses * magnified, abs=0.051)

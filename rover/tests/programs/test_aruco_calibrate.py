"""`roverlink aruco board` and `roverlink aruco calibrate`, as somebody calls them."""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path

import pytest
from needs import NO_OPENCV, NO_PYPDFIUM2

from roverlink.__main__ import main

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)
pypdfium2 = pytest.importorskip("pypdfium2", reason=NO_PYPDFIUM2)

from roverkit.aruco.board_options import add_board, board_of  # noqa: E402  # they need OpenCV
from roverkit.calibration import (  # noqa: E402
    AprilGrid,
    BoardDetector,
    CalibrationBoard,
    CharucoBoard,
    Chessboard,
)
from roverkit.vision.camera.parameters_file import read_parameters  # noqa: E402

from rover.tests.vision.board_frames import BOARD, MATRIX, SIZE, frame, frames  # noqa: E402

IMAGES = 12


@pytest.fixture(scope="module")
def images(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of images of a board, by a pinhole camera that is known; and one without a board."""
    folder = tmp_path_factory.mktemp("images")
    for index, image in enumerate(frames(IMAGES)):
        cv2.imwrite(str(folder / f"view{index}.png"), image)
    cv2.imwrite(str(folder / "wall.png"), np.full(SIZE[::-1], 120, np.uint8))
    day = 1_700_000_000  # 2023-11-14
    for path in folder.iterdir():
        os.utime(path, (day, day))
    return folder


def filmed(folder: Path, count: int, still: int) -> Path:
    """A video of a board that is held still for some frames, so many times."""
    film = folder / "board.avi"
    writer = cv2.VideoWriter(str(film), cv2.VideoWriter_fourcc(*"MJPG"), 30, SIZE)
    for image in frames(count):
        for _ in range(still):
            writer.write(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR))
    writer.release()
    return film


@pytest.mark.slow
def test_images_become_a_file_of_parameters(images: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The camera is found to a thousandth; the file says how sure that is, and the image that is of no use is named."""
    out = tmp_path / "camera.yml"
    assert main(["aruco", "calibrate", str(images), "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert next(line for line in said.splitlines() if line.startswith("wall.png")).endswith("dropped: no board found")
    assert f"wrote {out}" in said.replace("\n", " ")
    camera = read_parameters(out)
    assert camera.size == SIZE
    assert camera.matrix == pytest.approx(MATRIX, abs=0.5)
    file = cv2.FileStorage(str(out), cv2.FILE_STORAGE_READ)
    assert file.getNode("views").real() == IMAGES
    assert file.getNode("data_date").string() == "2023-11-14"
    assert 0 < file.getNode("reprojection_error_rms").real() < 0.1
    assert file.getNode("standard_deviations").mat().shape == (1, 9)
    report = out.with_suffix(".html")
    assert "wall.png: no board found" in report.read_text(encoding="utf-8")

    before = out.read_bytes(), report.read_bytes()
    assert main(["aruco", "calibrate", str(images), "--json", "--out", str(out)]) == 0
    assert (out.read_bytes(), report.read_bytes()) == before
    found = json.loads(capsys.readouterr().out)
    assert found["model"] == "plumb_bob"
    assert found["size"] == list(SIZE)
    for name, value in (("fx", MATRIX[0, 0]), ("fy", MATRIX[1, 1]), ("cx", MATRIX[0, 2]), ("cy", MATRIX[1, 2])):
        assert found["parameters"][name]["value"] == pytest.approx(value, abs=0.5)
        assert 0 < found["parameters"][name]["deviation"] < 0.3
    assert 0 < found["uncertainty"]["mean"] < found["uncertainty"]["max"] < 0.5
    assert [view["name"] for view in found["views"] if view["dropped"]] == ["wall.png"]
    assert found["judgement"]["verdict"] in ("good", "usable")
    assert all(doubt["text"] for doubt in found["judgement"]["doubts"])


@pytest.mark.slow
def test_parameters_that_must_not_be_used_replace_no_good_ones(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """They are in a file with another name; the reason is there, and the exit code is 1."""
    folder = tmp_path / "images"
    folder.mkdir()
    rows, columns = np.indices(SIZE[::-1], np.float32)
    shears = np.random.default_rng(2).normal(0, 6, IMAGES)
    for index, (image, shear) in enumerate(zip(frames(IMAGES), shears)):
        moved = columns - np.float32(shear) * (rows / SIZE[1] - np.float32(0.5))
        cv2.imwrite(str(folder / f"view{index}.png"), cv2.remap(image, moved, rows, cv2.INTER_CUBIC))
    out = tmp_path / "camera.yml"
    out.write_text("good parameters")
    assert main(["aruco", "calibrate", str(folder), "--out", str(out)]) == 1
    said = capsys.readouterr().out
    assert "judgement: do not use" in said
    assert "rolling shutter" in said
    assert out.read_text() == "good parameters"
    rejected = tmp_path / "camera.rejected.yml"
    assert read_parameters(rejected).size == SIZE
    assert cv2.FileStorage(str(rejected), cv2.FILE_STORAGE_READ).getNode("judgement").string() == "do not use"
    assert "rolling shutter" in (tmp_path / "camera.rejected.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_too_few_views_are_refused(images: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With the reason, exit code 1, and no file."""
    for name in ("view1.png", "view2.png", "wall.png"):
        (tmp_path / name).write_bytes((images / name).read_bytes())
    out = tmp_path / "camera.yml"
    assert main(["aruco", "calibrate", str(tmp_path), "--out", str(out)]) == 1
    said = capsys.readouterr()
    assert "wall.png: no board found" in said.err
    assert "2 of 3 views are usable, but 10 are needed" in said.err
    assert not out.exists()
    assert main(["aruco", "calibrate", str(tmp_path), "--out", str(out), "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["useless"] == {"wall.png": "no board found"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("board", "given", "seen"),
    [
        (CharucoBoard(9, 6, 0.03, 0.022, "DICT_5X5_50"), "charuco", "--dictionary DICT_5X5_50 --squares 9x6"),
        (CharucoBoard(9, 6, 0.03, 0.022), "charuco", "--dictionary DICT_4X4_50 --squares 9x6"),
        (CharucoBoard(9, 6, 0.03, 0.022), "aprilgrid", "--board charuco --dictionary DICT_4X4_50 --squares 9x6"),
        (AprilGrid(5, 4, 0.04), "aprilgrid", "--board aprilgrid --squares 5x4"),
        (AprilGrid(5, 4, 0.04), "charuco", "--board aprilgrid --squares 5x4"),
        (Chessboard(13, 9, 0.02), "chessboard", "--board chessboard --squares 13x9"),
    ],
)
def test_another_board_is_named(
    board: CalibrationBoard, given: str, seen: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With the options for it, instead of a request for more images; its corners count for nothing."""
    cv2.imwrite(str(tmp_path / "view.png"), frame((22, 10), (0.5, 0.5), 0.45, board))
    assert main(["aruco", "calibrate", str(tmp_path), "--board", given, "--out", str(tmp_path / "camera.yml")]) == 1
    said = capsys.readouterr().err
    assert seen in said
    assert "view.png: no board found" in said


@pytest.mark.slow
def test_of_a_video_the_views_that_add_something_are_taken(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Of a board that is held still for two frames each time, one; until nothing is missing."""
    film = filmed(tmp_path, 20, 2)
    out = tmp_path / "camera.yml"
    assert main(["aruco", "calibrate", str(film), "--views", "12", "--out", str(out), "--json"]) == 0
    said = capsys.readouterr()
    *views, result = [json.loads(line) for line in said.out.splitlines()]
    assert len(views) == len(result["views"]) >= 12
    assert len(views[0]["missing"]) > len(views[-2]["missing"]) >= len(views[-1]["missing"]) == 0
    assert "adds" in views[0]
    assert read_parameters(out).matrix == pytest.approx(MATRIX, abs=2.0)


@pytest.mark.slow
def test_a_video_in_words_says_what_is_missing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What each view adds, and what still has none; then why that is not enough."""
    film = filmed(tmp_path, 3, 2)
    assert main(["aruco", "calibrate", str(film), "--out", str(tmp_path / "camera.yml")]) == 1
    said = capsys.readouterr().err
    assert "hold the board still" in said
    assert "view 1 (frame 1): " in said
    assert "missing: parts of the image: " in said
    assert "distances: " in said
    assert "tilts: " in said
    assert "3 of 3 views are usable, but 10 are needed" in said


def test_a_board_is_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """As a PDF by default; the detector finds it there."""
    out = tmp_path / "board.pdf"
    assert main(["aruco", "board", "--squares", "8x6", "--square", "0.03", "--marker", "0.02", "--out", str(out)]) == 0
    assert f"{out}: 1 sheet of A4; print it at 100 %" in capsys.readouterr().out
    page = np.ascontiguousarray(pypdfium2.PdfDocument(out)[0].render(scale=2, grayscale=True).to_numpy())
    assert len(BoardDetector(CharucoBoard(8, 6, 0.03, 0.02)).find(page).ids) == 7 * 5


def test_markers_are_printed(tmp_path: Path) -> None:
    """Ranges and single ones, as a PNG."""
    out = tmp_path / "markers.png"
    assert main(["aruco", "board", "--markers", "7,20-22", "--side", "0.04", "--dpi", "150", "--out", str(out)]) == 0
    bits = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_5X5_250)
    _, ids, _ = cv2.aruco.ArucoDetector(bits).detectMarkers(cv2.imread(str(out), cv2.IMREAD_GRAYSCALE))
    assert sorted(np.ravel(ids)) == [7, 20, 21, 22]


def test_the_default_board_is_the_library_s() -> None:
    """The help knows it without loading OpenCV."""
    parser = argparse.ArgumentParser()
    add_board(parser)
    board = board_of(parser.parse_args([]))
    for name in ("columns", "rows", "square", "marker", "dictionary", "legacy"):
        assert getattr(board, name) == getattr(BOARD, name)

"""The file of landmarks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from runtime.errors import SetupError
from vision import read_landmarks

EXAMPLE = """
frame: arena
survey: {position: 0.02, rotation: 1}
landmarks:
  7: {position: [1.0, 2.0, 0.5], rpy: [90, 0, -90]}
  gate: {position: [4, 0, 1], orientation: [0, 0, 0.70710678, 0.70710678], survey: {position: 0.03}}
"""


def read(folder: Path, text: str) -> object:
    path = folder / "landmarks.yaml"
    path.write_text(text, encoding="utf-8")
    return read_landmarks(path)


def test_landmarks_have_poses_and_sigmas(tmp_path: Path) -> None:
    """Angles are degrees about fixed axes or a quaternion; a landmark's own survey goes before the field's."""
    found = read(tmp_path, EXAMPLE)
    assert found.frame == "arena"
    assert list(found.places) == [7, "gate"]
    facing_back = found.places[7].pose
    assert facing_back.translation == pytest.approx([1, 2, 0.5])
    assert facing_back.rotation @ [0, 0, 1] == pytest.approx([-1, 0, 0], abs=1e-12)  # out of the print is -x
    assert facing_back.rotation @ [0, 1, 0] == pytest.approx([0, 0, 1], abs=1e-12)  # up the print is up
    assert found.places["gate"].pose.rotation @ [1, 0, 0] == pytest.approx([0, 1, 0], abs=1e-7)
    assert (found.places[7].position_sigma, found.places["gate"].position_sigma) == (0.02, 0.03)
    assert found.places["gate"].rotation_sigma == pytest.approx(np.radians(1))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("landmarks: [", "cannot read"),
        ("- 1", "no mapping"),
        ("frame: field", "no landmarks"),
        ("landmarks: {}", "no landmarks"),
        ("landmark: {}", "did you mean landmarks"),
        ("landmarks: {1.5: {position: [0, 0, 0], rpy: [0, 0, 0]}}", "1.5"),
        ("landmarks: {7: {rpy: [0, 0, 0]}}", "landmark 7 has no position"),
        ("landmarks: {7: {position: [0, 0, 0]}}", "either rpy or orientation"),
        ("landmarks: {7: {position: [0, 0, 0], rpy: [0, 0, 0], orientation: [0, 0, 0, 1]}}", "either"),
        ("landmarks: {7: {position: [0, 0], rpy: [0, 0, 0]}}", "list of 3 numbers"),
        ("landmarks: {7: {position: [0, 0, .nan], rpy: [0, 0, 0]}}", "finite"),
        ("landmarks: {7: {position: [0, 0, 0], orientation: [0, 0, 1, 1]}}", "length"),
        ("landmarks: {7: {position: [0, 0, 0], rpy: [0, 0, 0], survey: {position: -1}}}", "standard deviation"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, text: str, words: str) -> None:
    """The message says where and what."""
    with pytest.raises(SetupError, match=words):
        read(tmp_path, text)


def test_a_missing_file_is_a_setup_error(tmp_path: Path) -> None:
    """Its path is named."""
    with pytest.raises(SetupError, match="nowhere"):
        read_landmarks(tmp_path / "nowhere.yaml")

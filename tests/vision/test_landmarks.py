"""The file of landmarks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from roverlink.runtime.core.errors import SetupError
from roverlink.vision import Landmarks, read_landmarks

EXAMPLE = """
frame: arena
survey: {position: 0.02, rotation: 1}
landmarks:
  7: {position: [1.0, 2.0, 0.5], rpy: [90, 0, -90]}
  gate: {position: [4, 0, 1], orientation: [0, 0, 0.70710678, 0.70710678], survey: {position: 0.03}}
"""


def read(folder: Path, text: str) -> Landmarks:
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
        ("landmarks: [", r":1:13: not valid YAML"),
        ("", r":1:1: the file is not a mapping"),
        ("- 1", r":1:1: the file is not a mapping"),
        ("[" * 3000, "nested too deeply"),
        ("frame: field", "no landmarks found"),
        ("landmarks: {}", "no landmarks found"),
        ("landmarks: [7]", r":1:12: the file: landmarks is not a mapping"),
        ("frame: a\nlandmark: {}", r":2:1: the file has an unknown key .*did you mean 'landmarks'"),
        ("frame: 3\nlandmarks: {7: {}}", r":1:8: .* is 3; it must be a name"),
        ("frame: 2026-02-30\nlandmarks: {7: {}}", r":1:8: the file: frame: 2026-02-30 is not a valid value"),
        ("frame: !!python/none\nlandmarks: {7: {}}", r":1:8: the file: frame: an empty value is not a valid value"),
        ("frame: !!bool maybe\nlandmarks: {7: {}}", r":1:8: the file: frame: maybe is not a valid value"),
        ("frame: !!int ''\nlandmarks: {7: {}}", r":1:8: the file: frame: '' is not a valid value"),
        ("frame: !!timestamp x\nlandmarks: {7: {}}", r":1:8: the file: frame: x is not a valid value"),
        ("landmarks: {!!bool x: {}}", r":1:13: x is not a valid value"),
        ("frame: [3]\nlandmarks: {7: {}}", r":1:8: .* is a list of 1; it must be a name"),
        ("landmarks: {1.5: {position: [0, 0, 0], rpy: [0, 0, 0]}}", "1.5"),
        (
            "landmarks: {[7]: {position: [0, 0, 0], rpy: [0, 0, 0]}}",
            r":1:13: a key is a list of 1; it must be a name",
        ),
        ("landmarks:\n  7: {}\n  8: {}\n  7: {}", r":4:3: the key 7 occurs twice"),
        ("landmarks:\n  7: {}\nlandmarks: {}", r":3:1: the key landmarks occurs twice"),
        ("landmarks: {<<: 3}", r":1:17: not valid YAML: expected a mapping"),
        ("landmarks: {7: {<<: {rpy: [0, 0, 0]}, <<: {rpy: [0, 0, 9]}}}", r":1:39: the key << occurs twice"),
        ("landmarks: {7: {<<: {rpy: [0, 0, 0], rpy: [0, 0, 9]}}}", r":1:38: the key rpy occurs twice"),
        ("landmarks: {7: {<<: {side: 1}}}", r":1:22: landmark 7 has an unknown key 'side'"),
        ("landmarks: {7: {rpy: [0, 0, 0]}}", r":1:16: landmark 7 has no position"),
        ("landmarks: {7: {position: [0, 0, 0]}}", "either rpy or orientation"),
        ("landmarks: {7: {position: [0, 0, 0], rpy: [0, 0, 0], orientation: [0, 0, 0, 1]}}", "either"),
        ("landmarks: {7: {position: [0, 0], rpy: [0, 0, 0]}}", r":1:27: landmark 7: position is .* list of 3 numbers"),
        (
            "landmarks: {7: {position: [0, 0, .nan], rpy: [0, 0, 0]}}",
            r":1:34: .* is .nan; it must be a finite number",
        ),
        (f"landmarks: {{7: {{position: [0, 0, {'9' * 400}], rpy: [0, 0, 0]}}}}", r":1:34: .* is too large"),
        (
            f"survey: {{position: -0x{'f' * 5000}}}\nlandmarks: {{7: {{}}}}",
            r":1:20: .*: -0xf+\.\.\. is too large",
        ),
        ("landmarks: {7: {position: [0, 0, 1.0e+300], rpy: [0, 0, 0]}}", r":1:34: .* is 1.0e\+300; that is too large"),
        (f"landmarks: {{{'9' * 400}: {{}}}}", r":1:13: 9+\.\.\. is too large"),
        ("landmarks: {7: {position: [0, 0, 0], orientation: [0, 0, 1, 1]}}", "length"),
        ("landmarks: {7: {position: [0, 0, 0], rpy: [0, 0, 0], survey: {position: -1}}}", "standard deviation"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, text: str, words: str) -> None:
    """The message says where and what; nothing is taken for something else or left out in silence."""
    with pytest.raises(SetupError, match=words):
        read(tmp_path, text)


def test_what_landmarks_have_in_common_is_merged(tmp_path: Path) -> None:
    """YAML's `<<` gives what a landmark does not say itself, also of what is merged itself, or used again after it."""
    text = """
landmarks:
  7: &seven {position: [1, 2, 3], rpy: [0, 0, 0], survey: &good {position: 0.01, rotation: 1}}
  8: {<<: *seven, position: [4, 5, 6], survey: &better {<<: *good, position: 0.005}}
  9: {<<: *seven, survey: {<<: *better, rotation: 2}}
  10: {<<: *seven, survey: *better}
"""
    assert read(tmp_path, text).places.keys() == {7, 8, 9, 10}
    places = read(tmp_path, text).places.values()
    assert [place.pose.translation.tolist() for place in places] == [[1, 2, 3], [4, 5, 6], [1, 2, 3], [1, 2, 3]]
    assert [place.position_sigma for place in places] == [0.01, 0.005, 0.005, 0.005]
    assert [round(np.degrees(place.rotation_sigma), 9) for place in places] == [1, 1, 2, 1]


def test_a_missing_file_is_a_setup_error(tmp_path: Path) -> None:
    """Its path is named."""
    with pytest.raises(SetupError, match="nowhere"):
        read_landmarks(tmp_path / "nowhere.yaml")

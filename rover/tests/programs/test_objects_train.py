"""``roverlink objects render``, ``train`` and ``measure``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from needs import NO_ONNX, NO_OPENCV, needs_jax

from roverlink.__main__ import main

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("onnxruntime", reason=NO_ONNX)

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with 8 rendered images."""
    folder = tmp_path_factory.mktemp("objects") / "scenes"
    assert main(["objects", "render", str(folder), "--images", "8", "--seed", "7"]) == 0
    return folder


def _refused(capsys: pytest.CaptureFixture[str], *words: object) -> str:
    capsys.readouterr()
    assert main(["objects", *map(str, words)]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    return line


def test_rendered_scenes_are_a_folder_to_learn_from(scenes: Path) -> None:
    """Every eighth image is for the measurement, and each has a file of labels."""
    assert len(list((scenes / "images/train").iterdir())) == 7
    assert len(list((scenes / "labels/val").iterdir())) == 1
    assert "names: [rock, main_switch," in (scenes / "data.yaml").read_text()


@needs_jax
def test_a_network_is_trained_and_measured(scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The file is a model for `measure` and `track`; the result has each class of the images."""
    model = tmp_path / "m.onnx"
    words = ("--out", str(model), "--epochs", "1", "--size", "128x96")
    assert main(["objects", "train", str(scenes), *words]) == 0
    out = capsys.readouterr().out.splitlines()
    assert out[-1].split()[0] == "mAP50"
    assert out[-1].endswith("(1 image)")
    assert main(["objects", "measure", str(scenes), "--model", str(model), "--json"]) == 0
    result: Any = json.loads(capsys.readouterr().out)
    assert set(result) == {"images", "mAP50", "AP50"}
    assert [line.split()[0] for line in out[:-1]] == list(result["AP50"])
    assert main(["objects", "track", str(scenes / "images/val"), "--model", str(model), "--json"]) == 0
    assert list(tmp_path.iterdir()) == [model]


@needs_jax
def test_a_training_that_is_stopped_goes_on(
    scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """After Ctrl-C, the result is that of the complete epochs; --resume leads to the network of one without a stop."""
    from roverkit.objects.training import checkpoint

    whole, parts = tmp_path / "whole.onnx", tmp_path / "parts.onnx"
    words = ["objects", "train", str(scenes), "--epochs", "2", "--size", "64x64", "--out"]
    assert main([*words, str(whole)]) == 0
    write = checkpoint.write_checkpoint

    def stopped(*arguments: Any) -> None:
        write(*arguments)
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(checkpoint, "write_checkpoint", stopped)
        assert main([*words, str(parts)]) == 0
    assert "stopped after 1 of 2 epochs; --resume goes on" in capsys.readouterr().err
    assert parts.read_bytes() != whole.read_bytes()
    assert "is of other images or options" in _refused(capsys, *words[1:], parts, "--resume", "--seed", "2")
    assert main([*words, str(parts), "--resume"]) == 0
    assert parts.read_bytes() == whole.read_bytes()
    assert sorted(tmp_path.iterdir()) == [parts, whole]


@needs_jax
def test_a_file_of_somebody_else_stays(scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The exit code is 2."""
    other = tmp_path / "other.onnx"
    other.write_text("somebody's")
    assert f"{other} exists, and" in _refused(capsys, "train", scenes, "--out", other)
    assert other.read_text() == "somebody's"


def test_other_classes_are_refused(scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A measurement would be 0 for each class."""
    np = pytest.importorskip("numpy")
    pytest.importorskip("onnx", reason=NO_ONNX)
    from rover.tests.vision.onnx_models import write

    model = write(tmp_path / "m.onnx", {"output0": np.zeros((1, 6, 84), np.float32)}, metadata={"names": ["a", "b"]})
    assert "those of m.onnx are a, b; give both the same names" in _refused(capsys, "measure", scenes, "--model", model)

"""Training: folders of labelled images, the network, and its ONNX file."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from needs import NO_JAX, NO_ONNX, NO_OPENCV

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)
onnx = pytest.importorskip("onnx", reason=NO_ONNX)
onnxruntime = pytest.importorskip("onnxruntime", reason=NO_ONNX)

from roverkit.objects.detected_objects import Box  # noqa: E402
from roverkit.objects.training.training_examples import batches, changed, random_order, target  # noqa: E402
from roverkit.objects.yolo_folder import read_folder, write_folder  # noqa: E402

from roverlink.runtime.core.errors import SetupError  # noqa: E402  # they need the libraries

_SIZE = (64, 64)
_NAMES = ("disk", "square")


@pytest.fixture(scope="module")
def training() -> Any:
    """The package with the modules that need jax. They are imported late: jax starts threads where it is imported."""
    for name in ("jax", "optax"):
        pytest.importorskip(name, reason=NO_JAX)
    from roverkit.objects import training
    from roverkit.objects.training import jax_network, learning, onnx_file  # noqa: F401  # members of it

    return training


def _picture(seed: int) -> tuple[object, list[tuple[int, Box]]]:
    """A disk and a square on a dark ground."""
    rng = np.random.default_rng(seed)
    image = rng.integers(0, 60, (64, 64, 3), np.uint8)
    (x, y), (u, v) = rng.integers(10, 22, 2).tolist(), rng.integers(38, 50, 2).tolist()
    cv2.circle(image, (x, y), 8, (30, 60, 250), -1)
    cv2.rectangle(image, (u - 8, v - 8), (u + 8, v + 8), (250, 200, 30), -1)
    return image, [(0, Box(x - 8, y - 8, 17, 17)), (1, Box(u - 8, v - 8, 17, 17))]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with 40 labelled images."""
    made = ((("val" if seed % 8 == 0 else "train"), *_picture(seed)) for seed in range(40))
    write_folder(tmp_path / "set", _NAMES, made)  # type: ignore[arg-type]  # of the picture
    return tmp_path / "set"


def _numbers(box: Box) -> list[float]:
    return [box.x, box.y, box.width, box.height]


def test_what_is_written_is_read(folder: Path) -> None:
    """Names, images, and boxes to a hundredth of a pixel. A folder with files is not written to: they stay."""
    data = read_folder(folder)
    assert data.names == _NAMES
    assert (len(data.train), len(data.val)) == (35, 5)
    image, labels = data.val[0].read()
    assert image.shape == (64, 64, 3)
    for (index, box), (expected, place) in zip(labels, _picture(0)[1], strict=True):
        assert index == expected
        assert _numbers(box) == pytest.approx(_numbers(place), abs=0.01)
    with pytest.raises(SetupError, match="is not empty; name another folder"):
        write_folder(folder, _NAMES, [])


def _listed(folder: Path, part: str) -> str:
    """A list of images as CVAT writes it."""
    return "".join(f"data/{path.relative_to(folder)}\n" for path in sorted((folder / part).glob("*.jpg")))


def _of_ultralytics(folder: Path) -> None:
    (folder / "data.yaml").write_text(
        "path: /home/somebody/set\ntrain: ../images/train\nval: images/val\nnc: 2\nnames: {0: disk, 1: square}\n"
    )


def _of_roboflow(folder: Path) -> None:
    (folder / "data.yaml").write_text(
        "train: [../images/train]\nval: [../images/val]\nnames: [disk, square]\ndate: 1\n"
    )


def _of_cvat(folder: Path) -> None:
    (folder / "train.txt").write_text(_listed(folder, "images/train"))
    (folder / "data.yaml").write_text("path: ./\ntrain: train.txt\nnames: {0: disk, 1: square}\n")


def _of_cvat_1_1(folder: Path) -> None:
    (folder / "images/train").rename(folder / "obj_train_data")
    for path in (folder / "labels/train").iterdir():
        path.rename(folder / "obj_train_data" / path.name)
    (folder / "train.txt").write_text(_listed(folder, "obj_train_data"))
    (folder / "data.yaml").unlink()
    (folder / "obj.data").write_text("classes = 2\nnames = data/obj.names\ntrain = data/train.txt\nbackup = backup/\n")
    (folder / "obj.names").write_text("disk\nsquare\n")


def _of_label_studio(folder: Path) -> None:
    for kind in ("images", "labels"):
        for path in [*(folder / kind / "train").iterdir()]:
            path.rename(folder / kind / path.name)
        for path in (folder / kind / "val").iterdir():
            path.unlink()
    (folder / "data.yaml").unlink()
    (folder / "classes.txt").write_text("disk\nsquare\n")


def _of_everything(folder: Path) -> None:
    (folder / "data.yaml").write_text("train: images\nval: images/val\nnames: [disk, square]\n")


@pytest.mark.parametrize(
    ("export", "counts", "told"),
    [
        (_of_ultralytics, (35, 5), []),
        (_of_roboflow, (35, 5), ["the key 'date' is unknown, and has no effect"]),
        (_of_cvat, (30, 5), ["there are no images for val only; 5 of train are measured, and not learnt"]),
        (_of_cvat_1_1, (30, 5), ["there are no images for val only"]),
        (_of_label_studio, (30, 5), ["there are no images for val only"]),
        (_of_everything, (35, 5), ["5 images of train are in val, too, and are not learnt"]),
    ],
)
def test_exports_of_labelling_programs_are_read(
    folder: Path, export: Callable[[Path], None], counts: tuple[int, int], told: Sequence[str]
) -> None:
    """Each with its labels; no image is learnt and measured, and what is unusual is told."""
    export(folder)
    messages: list[str] = []
    data = read_folder(folder, messages.append)
    assert (len(data.train), len(data.val)) == counts
    assert data.names == _NAMES
    assert not {image.path.resolve() for image in data.train} & {image.path.resolve() for image in data.val}
    assert all(len(image.read()[1]) == 2 for image in (*data.train, *data.val))
    for message, text in zip(messages, told, strict=True):
        assert text in message


def test_labels_are_read_as_boxes_inside_the_image(folder: Path) -> None:
    """An outline becomes a box, a box is clipped, the number of a track is left out, and no file is no object."""
    first, second, *_, last = sorted((folder / "labels/train").iterdir())
    first.write_text("1 0.1 0.2 0.5 0.2 0.5 0.6 0.1 0.6\n\n")
    second.write_text("0 0.98 0.5 0.1 0.2 7\n")
    last.unlink()
    messages: list[str] = []
    images = {image.path.stem: image for image in read_folder(folder, messages.append).train}
    assert "1 image without a file of labels" in messages[0]
    ((index, box),) = images[first.stem].read()[1]
    assert index == 1
    assert _numbers(box) == pytest.approx([6.4, 12.8, 25.6, 25.6])
    ((_, box),) = images[second.stem].read()[1]
    assert _numbers(box) == pytest.approx([59.52, 25.6, 4.48, 12.8])
    assert [images[path.stem].clipped() for path in (first, second, last)] == [0, 1, 0]
    assert images[last.stem].read()[1] == []


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("2 0.5 0.5 0.1 0.1", "there is no class 2; there are 2, from 0"),
        ("0 0.5 0.5 0.1", "is not 'class x y width height'"),
        ("0 0.5 0.5 1.3 0.1", "is no box inside the image; numbers are parts of it, from 0 to 1"),
        ("0 0.5 nan 0.1 0.1", "is no box inside the image"),
    ],
)
def test_mistakes_in_labels_are_located(folder: Path, line: str, text: str) -> None:
    """File and line, before the training begins."""
    path = sorted((folder / "labels/train").iterdir())[0]
    path.write_text(f"0 0.5 0.5 0.1 0.1\n{line}\n")
    image = next(one for one in read_folder(folder).train if one.labels == path)
    with pytest.raises(SetupError, match=re.escape(f"{path}:2: ") + ".*" + re.escape(text)):
        image.clipped()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("names: [a]\nval: images/val", "the key 'train' is missing"),
        ("names: [a]\ntrain: none\nval: images/val", "2:8: train: there is no "),
        ("names: [a]\ntrain: labels/val\nval: images/val", "labels/val has no images"),
        ("names: [a]\ntrain: data.yaml", "names: [a], which does not exist; export the images, too"),
    ],
)
def test_mistakes_in_data_yaml_are_located(folder: Path, text: str, message: str) -> None:
    """In one line."""
    (folder / "data.yaml").write_text(text)
    with pytest.raises(SetupError, match=re.escape(message)) as raised:
        read_folder(folder)
    assert str(raised.value).startswith(str(folder / "data.yaml"))


def test_an_image_that_cannot_be_read_is_named(folder: Path) -> None:
    """With what to do."""
    data = read_folder(folder)
    data.train[3].path.write_bytes(b"no image")
    with pytest.raises(SetupError, match="cannot read the image; remove it, or write it again"):
        list(batches(data.train, _SIZE, 2, random_order(len(data.train), np.random.default_rng(0))))


def test_a_changed_image_has_its_boxes_where_its_objects_are() -> None:
    """Scaled, moved, mirrored: the pixels of the disk fill its box."""
    image = np.zeros((100, 160, 3), np.uint8)
    cv2.circle(image, (60, 40), 15, (255, 255, 255), -1)
    for seed in range(40):
        shown, labels = changed(image, [(0, Box(45, 25, 31, 31))], (96, 64), np.random.default_rng(seed))
        assert shown.shape == (64, 96, 3)
        rows, columns = np.nonzero(shown.min(axis=2) > 0.7 * shown.max())  # brighter than the grey border
        for _, box in labels:
            assert [columns.min(), rows.min()] == pytest.approx([box.x, box.y], abs=1.6)
            lower_right = [box.x + box.width, box.y + box.height]
            assert [columns.max() + 1, rows.max() + 1] == pytest.approx(lower_right, abs=1.6)


def test_the_target_of_an_object_is_its_cell() -> None:
    """The score is 1 in one cell; its offset, and the logarithms of its size, lead back to the box."""
    heat, boxes, weights = target([(1, Box(20, 30, 12, 24))], _SIZE, 2)
    assert [tuple(place) for place in np.argwhere(heat[..., 1] == 1)] == [(5, 3)]
    assert heat[..., 0].max() == 0
    assert weights[5, 3] == 1
    x, y, width, height = boxes[5, 3]
    assert [(3.5 + x) * 8, (5.5 + y) * 8] == pytest.approx([26, 42], abs=1e-4)
    assert [16 * np.exp(width), 16 * np.exp(height)] == pytest.approx([12, 24], rel=1e-5)


@pytest.mark.slow
def test_the_file_gives_what_the_network_gives(training: Any, tmp_path: Path) -> None:
    """ONNX Runtime and jax agree to 1e-4; at other cells than peaks, the file has no score."""
    weights, statistics = training.jax_network.new_weights(3, 2)
    rng = np.random.default_rng(1)
    weights = {name: one + rng.normal(0, 0.02, one.shape).astype(np.float32) for name, one in weights.items()}
    statistics = {
        name: np.abs(one + rng.normal(0, 0.2, one.shape)).astype(np.float32) for name, one in statistics.items()
    }
    path = tmp_path / "m.onnx"
    training.onnx_file.write_model(path, weights, statistics, _NAMES, (96, 64), "test")
    image = rng.random((1, 64, 96, 3), np.float32)
    expected = np.asarray(training.jax_network.outputs(weights, statistics, image, train=False)[0])[0]
    session = onnxruntime.InferenceSession(path)
    (found,) = session.run(None, {"images": image.transpose(0, 3, 1, 2)})
    assert found.shape == (1, 6, 96)
    table = found[0].reshape(6, 8, 12)
    columns, rows = np.meshgrid(np.arange(12), np.arange(8))
    assert table[0] == pytest.approx((columns + 0.5 + expected[..., 0]) * 8, abs=1e-3)
    assert table[1] == pytest.approx((rows + 0.5 + expected[..., 1]) * 8, abs=1e-3)
    assert table[2] == pytest.approx(16 * np.exp(expected[..., 2]), rel=1e-4)
    scores = 1 / (1 + np.exp(-expected[..., 4:]))
    kept = table[4:].transpose(1, 2, 0)
    assert np.where(kept > 0, scores, 0) == pytest.approx(kept, abs=1e-4)
    best = np.unravel_index(scores[..., 0].argmax(), scores[..., 0].shape)
    assert kept[(*best, 0)] > 0

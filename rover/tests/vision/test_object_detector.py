"""Detectors in ONNX files: layouts, preprocessing, and files that cannot be used."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from needs import NO_ONNX, NO_OPENCV

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)
onnx = pytest.importorskip("onnx", reason=NO_ONNX)
pytest.importorskip("onnxruntime", reason=NO_ONNX)

from onnx import TensorProto  # noqa: E402  # they need onnx
from roverkit.objects.detected_objects import Box, ObjectDetection  # noqa: E402
from roverkit.objects.detector import ObjectDetector  # noqa: E402
from roverkit.objects.layouts import LAYOUTS  # noqa: E402
from roverkit.objects.preprocessing import Fit, Preprocessing  # noqa: E402

from rover.tests.vision.onnx_models import save, write  # noqa: E402
from roverlink.runtime.core.errors import SetupError  # noqa: E402

_W, _H = 96, 64  # Size of the networks' input
_IMAGE = (200, 100)  # Width and height of the image: of another shape than the input
_CELLS = [(stride, x, y) for stride in (8, 16, 32) for y in range(_H // stride) for x in range(_W // stride)]
"""Stride, column and row of the cells of the grids, in the order of YOLOX."""
_NAMES = ("rock", "socket", "plate")
_BLACK = np.zeros((_H, _W, 3), np.uint8)

# --- layouts
# What follows is written from the formats' descriptions, one number at a time, without numpy's tricks.

Truth = tuple[float, float, float, float, int, float]
"""Object: x1 y1 x2 y2 in pixels of the network's input, class, score."""
Outputs = Mapping[str, Any]


def _filled(rows: list[Any], none: Any, count: int = 20) -> list[Any]:
    return [rows + [none] * (count - len(rows))]


def _centre(one: Truth) -> list[float]:
    x1, y1, x2, y2, _, _ = one
    return [(x1 + x2) / 2, (y1 + y2) / 2, x2 - x1, y2 - y1]


def _part(one: Truth) -> list[float]:
    """The centre and the size in parts of the input."""
    return [value / whole for value, whole in zip(_centre(one), (_W, _H, _W, _H))]


def _scores(one: Truth) -> list[float]:
    return [one[5] if index == one[4] else 0.0 for index in range(len(_NAMES))]


def _yolov8(truths: list[Truth]) -> Outputs:
    (rows,) = _filled([_centre(one) + _scores(one) for one in truths], [0.0] * 7, 126)
    return {"output0": [[[row[column] for row in rows] for column in range(7)]]}


def _yolov5(truths: list[Truth]) -> Outputs:
    rows = [[*_centre(one), 0.9, *(score / 0.9 for score in _scores(one))] for one in truths]
    return {"output0": _filled(rows, [0.0] * 8, 3 * 126)}


def _yolox(truths: list[Truth]) -> Outputs:
    rows = []
    for one, (stride, column, row) in zip(truths, _CELLS):
        x, y, w, h = _centre(one)
        place = [x / stride - column, y / stride - row, math.log(w / stride), math.log(h / stride)]
        rows.append([*place, 1.0, *_scores(one)])
    return {"output": _filled(rows, [0.0] * 8, len(_CELLS))}


def _yolox_decoded(truths: list[Truth]) -> Outputs:
    rows = [[(x + 0.5) * stride, (y + 0.5) * stride, stride, stride, 0.0, 0.0, 0.0, 0.0] for stride, x, y in _CELLS]
    rows[: len(truths)] = [[*_centre(one), 1.0, *_scores(one)] for one in truths]
    return {"output": [rows]}


def _yolov5_with_grids(truths: list[Truth]) -> Outputs:
    """Return the outputs of YOLOv5 v6.0: the table, and the maps of the three grids behind it."""
    maps = {str(stride): np.full((1, 3, _H // stride, _W // stride, 8), 7.0) for stride in (8, 16, 32)}
    return {"output": _yolov5(truths)["output0"]} | maps


def _queries(truths: list[Truth], boxes: str, scores: str, extra: int = 0) -> Outputs:
    logits = [
        [math.log(score / (1 - score)) if score else -20.0 for score in _scores(one)] + [5.0] * extra for one in truths
    ]
    return {boxes: _filled(list(map(_part, truths)), [0.5] * 4), scores: _filled(logits, [-20.0] * (3 + extra))}


def _rtdetr_in_one(truths: list[Truth]) -> Outputs:
    return {"output0": _filled([_part(one) + _scores(one) for one in truths], [0.5] * 4 + [0.0] * 3)}


def _rtdetr_ranked(truths: list[Truth]) -> Outputs:
    return {"output0": _filled([[*_part(one), one[5], float(one[4])] for one in truths], [0.5] * 4 + [0.0] * 2)}


def _rtdetr_labels(truths: list[Truth]) -> Outputs:
    return {
        "labels": np.array(_filled([one[4] for one in truths], 0), np.int64),
        "boxes": _filled([list(one[:4]) for one in truths], [0.0] * 4),
        "scores": _filled([one[5] for one in truths], 0.0),
    }


def _nms(truths: list[Truth]) -> Outputs:
    return {"output0": _filled([[*one[:4], one[5], float(one[4])] for one in truths], [0.0] * 6)}


def _nms_in_batch(truths: list[Truth]) -> Outputs:
    return {"output": [[0.0, *one[:4], float(one[4]), one[5]] for one in truths] or np.zeros((0, 7))}


def _nms_in_parts(truths: list[Truth]) -> Outputs:
    return {
        "num_dets": np.array([[len(truths)]], np.int32),
        "det_boxes": _filled([list(one[:4]) for one in truths], [1.0, 1.0, 9.0, 9.0]),
        "det_scores": _filled([one[5] for one in truths], 0.9),
        "det_classes": np.array(_filled([one[4] for one in truths], 0), np.int32),
    }


_FORMATS: dict[str, tuple[str, Callable[[list[Truth]], Outputs], Fit]] = {
    "yolov8": ("yolov8", _yolov8, Fit.CENTRED),
    "yolov5": ("yolov5", _yolov5, Fit.CENTRED),
    "yolov5 with grids": ("yolov5", _yolov5_with_grids, Fit.CENTRED),
    "yolox": ("yolox", _yolox, Fit.CORNER),
    "yolox decoded": ("yolox", _yolox_decoded, Fit.CORNER),
    "rtdetr": ("rtdetr", lambda truths: _queries(truths, "pred_boxes", "logits"), Fit.STRETCHED),
    "rtdetr in one": ("rtdetr", _rtdetr_in_one, Fit.STRETCHED),
    "rtdetr ranked": ("rtdetr", _rtdetr_ranked, Fit.STRETCHED),
    "rtdetr with labels": ("rtdetr", _rtdetr_labels, Fit.STRETCHED),
    "rfdetr": ("rfdetr", lambda truths: _queries(truths, "dets", "labels"), Fit.STRETCHED),
    "rfdetr with background": ("rfdetr", lambda truths: _queries(truths, "dets", "labels", 1), Fit.STRETCHED),
    "nms": ("nms", _nms, Fit.CENTRED),
    "nms in batch": ("nms", _nms_in_batch, Fit.CENTRED),
    "nms in parts": ("nms", _nms_in_parts, Fit.CENTRED),
}


def _write(path: Path, name: str, truths: list[Truth]) -> Path:
    """A model of a format that sees these objects."""
    arrays = {key: np.asarray(one) for key, one in _FORMATS[name][1](truths).items()}
    arrays = {key: one.astype(np.float32) if one.dtype.kind == "f" else one for key, one in arrays.items()}
    inputs = {"images": (1, 3, _H, _W)} | ({"orig_target_sizes": (1, 2)} if "with labels" in name else {})
    return write(path, arrays, metadata={"names": dict(enumerate(_NAMES))}, inputs=inputs)


def _in_image(one: Truth, fit: Fit) -> list[float]:
    """Where an object of the input is in the image: x, y, width, height, clipped."""
    if fit is Fit.STRETCHED:
        scales, offsets = (_W / _IMAGE[0], _H / _IMAGE[1]), (0, 0)
    else:  # 200x100 becomes 96x48, with 8 rows above if it is centred
        scales, offsets = (0.48, 0.48), (0, 8 if fit is Fit.CENTRED else 0)
    found = []
    for axis in (0, 1):
        low, high = (min(max((one[axis + 2 * end] - offsets[axis]) / scales[axis], 0), _IMAGE[axis]) for end in (0, 1))
        found.append((low, high - low))
    return [found[0][0], found[1][0], found[0][1], found[1][1]]


_SHIFTS, _SIZES = st.floats(0, 10), st.floats(4, 12)
_TRUTHS = st.lists(
    st.tuples(_SHIFTS, _SHIFTS, _SIZES, _SIZES, st.integers(0, 2), st.floats(0.3, 0.99)), max_size=4
).map(
    lambda spots: [
        (24.0 * number + x, 16 + y, 24.0 * number + x + w, 16 + y + h, kind, score)
        for number, (x, y, w, h, kind, score) in enumerate(spots)
    ]
)
"""Up to four objects that do not overlap, also at the borders of the input."""


@pytest.mark.parametrize("name", _FORMATS)
@settings(max_examples=10)
@given(truths=_TRUTHS)
def test_every_layout_gives_the_objects(name: str, tmp_path_factory: Any, truths: list[Truth]) -> None:
    """The boxes, classes and scores are those of the format's description; the layout is recognized."""
    layout, _, fit = _FORMATS[name]
    detector = ObjectDetector(_write(tmp_path_factory.mktemp("models") / "model.onnx", name, truths))
    assert (detector.layout, detector.class_names) == (layout, _NAMES)
    found = detector.detect(np.zeros((_IMAGE[1], _IMAGE[0], 3), np.uint8))
    expected = sorted(truths, key=lambda one: -np.float32(one[5]))
    assert [one.class_name for one in found] == [_NAMES[one[4]] for one in expected]
    for one, truth in zip(found, expected):
        assert [one.box.x, one.box.y, one.box.width, one.box.height] == pytest.approx(_in_image(truth, fit), abs=1e-4)
        assert one.confidence == pytest.approx(truth[5], abs=1e-5)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 3e38])
@pytest.mark.parametrize("name", _FORMATS)
def test_numbers_out_of_range_give_no_warning(tmp_path: Path, name: str, value: float) -> None:
    """A network may compute them in a bright image; boxes of objects are numbers and lie in the image."""
    path = _write(tmp_path / "m.onnx", name, [(20, 20, 40, 40, 1, 0.9)])
    model = onnx.load(path)
    limit = np.float32(200 if "yolox" in name else 0.9)  # above the border's grey
    (image,) = (one.name for one in model.graph.input if len(one.type.tensor_type.shape.dim) == 4)
    nodes = [onnx.helper.make_node("ReduceMax", [image], ["light"], keepdims=0)]
    nodes.append(onnx.helper.make_node("Greater", ["light", "limit"], ["bright"]))
    model.graph.initializer.append(onnx.numpy_helper.from_array(limit, "limit"))
    model.graph.initializer.append(onnx.numpy_helper.from_array(np.float32(value), "value"))
    floats = {one.name for one in model.graph.initializer if one.data_type == TensorProto.FLOAT}
    for node in model.graph.node:
        (given,) = node.input
        choice = given in floats  # integers stay as they are
        nodes.append(onnx.helper.make_node("Where", ["bright", "value", given], node.output) if choice else node)
    graph = onnx.helper.make_graph(nodes, "detector", model.graph.input, model.graph.output, model.graph.initializer)
    detector = ObjectDetector(save(path, graph, {"names": dict(enumerate(_NAMES))}))
    assert len(detector.detect(np.zeros((_IMAGE[1], _IMAGE[0], 3), np.uint8))) == 1
    for one in detector.detect(np.full((_IMAGE[1], _IMAGE[0], 3), 255, np.uint8)):
        assert 0 <= one.box.x <= one.box.x + one.box.width <= _IMAGE[0]


def _everywhere(row: list[float], count: int = 20) -> Outputs:
    return {"o": np.array([[row] * count], np.float32)}


@pytest.mark.parametrize(
    ("outputs", "layout", "text"),
    [
        ({"o": np.full((1, 7, 126), math.nan, np.float32)}, None, "as yolov8, its scores are nan to nan"),
        (_everywhere([50, 30, 9, 9, 31, 0.9, 0.5], 126), None, "as yolox, its scores are 27.9 to 27.9, and not 0 to 1"),
        (_everywhere([0.5, 0.5, 0.2, 0.3, 0.9, 1]), "nms", "that does not fit the layout nms"),
        (_everywhere([0.1, 0.1, 0.8, 0.8, 0.9, 1.5]), "nms", "no coordinate of a box is above 0.8 pixels"),
        (_everywhere([50, 30, 20, 10, 0.9, 1]), "nms", "boxes end before they begin"),
        (_everywhere([50, 30, 9, 9, 0.9, 0.1]), "rtdetr", "100% of the boxes lie outside of the image"),
        (_everywhere([50, 30, math.inf, 9, 0.9, 1]), "nms", "boxes are not finite"),
    ],
)
def test_what_is_impossible_is_refused(
    tmp_path: Path, refused: Callable[..., None], outputs: Outputs, layout: str | None, text: str
) -> None:
    """The outputs for a grey image tell a wrong layout, such as NanoDet as YOLOX, before it finds nothing, silently."""
    write(tmp_path / "m.onnx", outputs, (_W, _H))
    refused(text, layout=layout)


def test_an_image_of_yolox_is_as_small_as_in_its_own_code() -> None:
    """It truncates where the others round: 1000x668 in 416x416 is 277 pixels high, and not 278."""
    heights = {}
    for fit in (Fit.CORNER, Fit.CENTRED):
        blob, _ = Preprocessing(fit, unit=False).prepare(np.full((668, 1000, 3), 255, np.uint8), (416, 416))
        heights[fit] = int((blob[0, 0, :, 0] == 255).sum())
    assert heights == {Fit.CORNER: 277, Fit.CENTRED: 278}


def test_of_boxes_that_overlap_the_best_one_of_each_class_remains(tmp_path: Path) -> None:
    """Objects of different classes may overlap, and so may the visible parts of boxes that reach out of the image."""
    truths: list[Truth] = [(20, 20, 40, 40, 0, 0.8), (21, 20, 41, 40, 0, 0.9)]
    truths += [(20, 21, 40, 41, 1, 0.6), (50, 20, 70, 40, 0, 0.2), (-30, 30, 10, 45, 2, 0.7), (0, 30, 10, 45, 2, 0.5)]
    path = _write(tmp_path / "m.onnx", "yolov8", truths)
    found = ObjectDetector(path).detect(_BLACK[:, :, 0])
    assert [f"{one.class_name[0]} {one.confidence:.1f}" for one in found] == ["r 0.9", "p 0.7", "s 0.6", "p 0.5"]
    assert [round(one.confidence, 3) for one in ObjectDetector(path, score=0.8).detect(_BLACK)] == [0.9]


def test_half_precision_is_supported_but_not_used_for_the_boxes(tmp_path: Path) -> None:
    """Exports for GPUs have inputs and outputs of float16; at 600 pixels, its numbers have steps of half a pixel."""
    table = np.zeros((1, 7, 8400), np.float16)
    table[0, :, 0] = [600.5, 300.25, 2.25, 2.25, 0, 0.75, 0]
    path = write(tmp_path / "m.onnx", {"output0": table}, (640, 640), kind=TensorProto.FLOAT16)
    found = ObjectDetector(path, names=_NAMES).detect(np.zeros((640, 640, 3), np.uint8))
    assert found == [ObjectDetection(Box(599.375, 299.125, 2.25, 2.25), "socket", 0.75)]


_PIXELS, _INPUTS = st.integers(1, 2000), st.sampled_from([(640, 640), (416, 416), (320, 256), (96, 64)])


@settings(max_examples=40)
@given(_PIXELS, _PIXELS, _INPUTS, st.sampled_from(Fit), st.floats(0, 1), st.floats(0, 1))
def test_a_letterbox_and_back_is_the_same_place(width: int, height: int, size: Any, fit: Fit, x: Any, y: Any) -> None:
    """Within half a pixel, for any image and any input; the image lies inside the input."""
    _, placement = Preprocessing(fit).prepare(np.zeros((height, width, 3), np.uint8), size)
    x, y = x * width, y * height
    inside = [x * placement.scale[0] + placement.offset[0], y * placement.scale[1] + placement.offset[1]]
    assert 0 <= inside[0] <= size[0] + 1e-6
    assert 0 <= inside[1] <= size[1] + 1e-6
    back = placement.to_image(np.array([[*inside, *inside]]))
    assert back[0] == pytest.approx([x, y, x, y], abs=0.5)


def test_the_colours_are_those_that_the_network_expects() -> None:
    """Order, range and normalization; the border is grey."""
    image = np.full((10, 20, 3), (10, 20, 200), np.uint8)  # blue, green, red
    plain, _ = Preprocessing(Fit.CORNER, rgb=False, unit=False).prepare(image, (40, 40))
    assert plain[0, :, 0, 0].tolist() == [10, 20, 200]
    assert plain[0, :, 39, 0].tolist() == [114, 114, 114]
    rgb, _ = Preprocessing().prepare(image, (40, 40))
    assert rgb[0, :, 20, 20] == pytest.approx([200 / 255, 20 / 255, 10 / 255])
    normal, _ = Preprocessing(Fit.STRETCHED, normalized=True).prepare(image, (40, 40))
    expected = [(200 / 255 - 0.485) / 0.229, (20 / 255 - 0.456) / 0.224, (10 / 255 - 0.406) / 0.225]
    assert normal[0, :, 5, 5] == pytest.approx(expected, rel=1e-5)


@pytest.fixture
def refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> Callable[..., None]:
    """Demands an error in one line about a file, and that ONNX Runtime prints nothing."""

    def refused(text: str, path: Path = tmp_path / "m.onnx", **options: Any) -> None:
        with pytest.raises(SetupError) as raised:
            ObjectDetector(path, **options)
        message = str(raised.value)
        assert message.startswith(f"{path}: ")
        assert text in message
        assert "\n" not in message
        assert capfd.readouterr() == ("", "")

    return refused


def test_a_file_that_is_no_model_is_refused(tmp_path: Path, refused: Callable[..., None]) -> None:
    """A missing one, an empty one, text, noise, and a model that is truncated at any length."""
    refused("cannot read the model: No such file or directory")
    whole = write(tmp_path / "net.onnx", {"output0": np.ones((1, 7, 84), np.float32)}).read_bytes()
    parts = [whole[:length] for length in range(10, len(whole) - 1, len(whole) // 7)]
    for content in (b"", b"no model", b"\x08\x08\x12", bytes(1000), *parts):
        (tmp_path / "m.onnx").write_bytes(content)
        refused("")


def test_models_that_cannot_be_opened_say_why(tmp_path: Path, refused: Callable[..., None]) -> None:
    """Weights in another file, an operator that nobody has, texts as outputs, another task, and other inputs."""
    path = tmp_path / "m.onnx"
    model = onnx.load(write(path, {"output0": np.ones((1, 7, 84), np.float32)}))
    onnx.save(model, path, save_as_external_data=True, size_threshold=0, location="weights.bin")
    refused("the weights are in another file; export the model as one file")
    model = onnx.load(write(path, {"output0": np.ones((1, 7, 84), np.float32)}))
    model.graph.node[0].op_type = "NonsenseOp"
    onnx.save(model, path)
    refused("NonsenseOp")
    model.graph.node[0].op_type = "Identity"
    del model.graph.input[:]
    onnx.save(model, path)
    refused("the inputs are none; a detector has one for an image")
    write(path, {"o": np.full((1, 7, 84), "rock", object)})
    refused("an output has the type tensor(string); a detector has tensors of numbers")
    write(path, {"output0": np.zeros((1, 56, 84), np.float32)}, metadata={"task": "pose"})
    refused("the model is for the task 'pose'")
    for inputs, text in (
        ({"x": (1, 3, 64)}, "the inputs are x (1, 3, 64); a detector has one for an image"),
        ({"x": (1, 1, 64, 64)}, "a detector has one for an image, (1, 3, height, width)"),
        ({"x": (1, 3, 64, 64), "y": (1, 3, 64, 64)}, "the inputs are x (1, 3, 64, 64), y (1, 3, 64, 64)"),
        ({"x": (1, 3, 8, 8)}, "has 8x8 pixels; 32 to 4096 are possible"),
    ):
        write(path, {"output0": np.zeros((1, 7, 84), np.float32)}, inputs=inputs)
        refused(text)


_NO_LAYOUT = "no known layout has them"
_PARTS = {"num_dets": (1, 0), "det_boxes": (1, 5, 4), "det_scores": (1, 5), "det_classes": (1, 5)}


@pytest.mark.parametrize(
    ("outputs", "options", "text"),
    [
        ({"o": (1, 300, 6)}, {}, "the outputs are o (1, 300, 6); this may be rtdetr or nms; choose with --layout"),
        ({"o": (1, 300, 6)}, {"names": ["a", "b"]}, "(1, 300, 6) and 2 classes; this may be rtdetr or nms"),
        ({"o": (1, 10)}, {}, "the outputs are o (1, 10); no known layout has them; rover/docs/objects.md lists"),
        ({"o": (1, 7, 84)}, {"layout": "yolox"}, "that does not fit the layout yolox; leave --layout out"),
        ({"labels": (1, 5), "boxes": (1, 5, 4), "scores": (1, 9)}, {}, _NO_LAYOUT),
        ({"logits": (1, 5, 0), "pred_boxes": (1, 5, 4)}, {}, _NO_LAYOUT),
        ({"logits": (5,), "pred_boxes": (5,)}, {"layout": "rtdetr"}, "that does not fit the layout rtdetr"),
        ({"dets": (1, 5, 4), "labels": (1, 7, 3)}, {}, _NO_LAYOUT),
        (_PARTS, {}, _NO_LAYOUT),
    ],
)
def test_other_outputs_are_refused(tmp_path: Path, refused: Any, outputs: Outputs, options: Any, text: str) -> None:
    """A model that may have two layouts is not guessed at."""
    write(tmp_path / "m.onnx", {name: np.zeros(shape, np.float32) for name, shape in outputs.items()})
    refused(text, **options)


def test_the_metadata_can_say_that_it_is_rtdetr(tmp_path: Path) -> None:
    """The classes are ranked since Ultralytics 8.4; without objects, the rows may be those of other layouts."""
    path = write(tmp_path / "m.onnx", {"o": np.zeros((1, 300, 6), np.float32)}, metadata={"head": "RTDETRDecoder"})
    assert ObjectDetector(path).layout == "rtdetr"


@pytest.mark.parametrize("metadata", [{"end2end": "True"}, {"args": {"batch": 1, "nms": True}}])
@pytest.mark.parametrize("rows", [5, 84, 300])
def test_the_metadata_can_say_that_suppression_is_inside(tmp_path: Path, metadata: Outputs, rows: int) -> None:
    """The shapes alone may be those of other layouts, too; what the user says comes first."""
    path = write(tmp_path / "m.onnx", {"o": np.zeros((1, rows, 6), np.float32)}, metadata=metadata)
    assert ObjectDetector(path, names=("rock", "socket") if rows == 300 else None).layout == "nms"
    if rows == 300:
        assert ObjectDetector(path, "rtdetr").layout == "rtdetr"
        write(path, {"o": np.zeros((1, rows, 6), np.float32)})
        assert [ObjectDetector(path, layout).layout for layout in ("rtdetr", "nms")] == ["rtdetr", "nms"]
        assert set(LAYOUTS) == {"yolov8", "yolov5", "yolox", "rtdetr", "rfdetr", "nms"}


_STRANGE = ("{[]: 1}", "((((", "{0: [1]}", "nan", "[" * 100_000)
"""Texts that only look like names, sizes and options of an export."""


@pytest.mark.parametrize(
    ("metadata", "size"),
    [({}, (640, 640)), ({"imgsz": "[64, 96]"}, (96, 64)), ({"imgsz": "128"}, (128, 128))]
    + [(dict.fromkeys(("names", "imgsz", "args", "end2end"), text), (640, 640)) for text in _STRANGE],
)
def test_an_open_size_is_that_of_training(tmp_path: Path, metadata: Outputs, size: tuple[int, int]) -> None:
    """The metadata has height and width; what half of the input is, is half of the image."""
    boxes, scores = np.zeros((1, 5, 4), np.float32), np.zeros((1, 5), np.float32)
    boxes[0, 0], scores[0, 0] = [0, 0, size[0] / 2, size[1] / 2], 0.9
    outputs = {"boxes": boxes, "scores": scores, "labels": np.zeros((1, 5), np.int64)}
    path = write(tmp_path / "m.onnx", outputs, metadata=metadata, inputs={"images": ("batch", 3, "h", "w")})
    (found,) = ObjectDetector(path).detect(np.zeros((50, 70, 3), np.uint8))
    assert found.box == Box(0, 0, 35, 25)

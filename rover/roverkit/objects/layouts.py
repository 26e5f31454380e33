"""Layouts of detectors: what the inputs and outputs of their ONNX files mean.

| layout | outputs                                       | boxes                           | scores              |
|--------|-----------------------------------------------|---------------------------------|---------------------|
| yolov8 | (1, 4+C, N); also YOLO11                      | cx cy w h, pixels of the input  | of classes          |
| yolov5 | (1, N, 5+C), N: 3 for each cell of the grids  | cx cy w h, pixels of the input  | objectness, classes |
| yolox  | (1, N, 5+C), N: 1 for each cell of the grids  | cx cy in cells, log of w h      | objectness, classes |
|        | the same, with --decode_in_inference          | cx cy w h, pixels of the input  | objectness, classes |
| rtdetr | logits, pred_boxes                            | cx cy w h, part of the input    | logits of classes   |
|        | (1, Q, 4+C)                                   | cx cy w h, part of the input    | of classes          |
|        | (1, Q, 6)                                     | cx cy w h, part of the input    | of one class        |
|        | labels, boxes, scores                         | x1 y1 x2 y2, pixels             | of one class        |
| rfdetr | dets, labels                                  | cx cy w h, part of the input    | logits of classes   |
| nms    | (1, K, 6); (K, 7); num_dets, det_boxes,       | x1 y1 x2 y2, pixels             | of one class        |
|        | det_scores, det_classes                       |                                 |                     |

The layouts are those that the exporters of ultralytics, YOLOX (Megvii), RT-DETR (lyuwenyu, transformers), RF-DETR
(Roboflow) and YOLOv7 write; `nms` is the output of exports that contain the suppression of overlapping boxes. YOLOv5
v6.0 writes the maps of its three grids, too, which are not needed. Where shapes leave several layouts, the outputs for
a grey image decide.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverkit.objects.preprocessing import Fit, Preprocessing
from roverkit.vision.camera.camera_model import Floats

_STRIDES = ((8, 16, 32), (8, 16, 32, 64))
"""Cells of the grids of YOLOv5 and YOLOX in pixels: of the usual models, and of those for large images (P6)."""
_RATIOS = 3  # anchors of YOLOv5 for each cell
_CLASSES = 2**31  # OpenCV's indices of classes have 32 bits
_RANKED = "RTDETRDecoder"
"""Last layer of Ultralytics' RT-DETR, which ranks the classes of all boxes since version 8.4 (its #24403)."""

Array = NDArray[Any]
Outputs = Mapping[str, Array]
"""Outputs of a network by their names."""


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """Boxes that a network has found."""

    boxes: Floats
    """Boxes (N, 4) of x1 y1 x2 y2 in pixels of the network's input."""
    scores: Floats
    """Scores (N,) from 0 to 1."""
    classes: NDArray[np.intp]
    """Indices (N,) of the classes."""


@dataclass(frozen=True, slots=True, eq=False)
class Signature:
    """Facts about a model from which its layout is recognized."""

    size: tuple[int, int]
    """Width and height of the input in pixels."""
    outputs: Outputs
    """Outputs for a grey image."""
    classes: int | None
    """Number of classes; None if it is unknown."""
    suppressed: bool = False
    """True if the metadata says that the network has chosen the best one of overlapping boxes."""
    head: str = ""
    """Class of the network's last layer in the metadata of Ultralytics, such as ``RTDETRDecoder``."""

    @property
    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Shapes of the outputs by their names."""
        return {name: output.shape for name, output in self.outputs.items()}

    @property
    def only(self) -> tuple[int, ...]:
        """Shape of the only output; () if there are several."""
        return next(iter(self.shapes.values())) if len(self.outputs) == 1 else ()

    def has(self, **columns: int | None) -> bool:
        """Return true if these are the outputs, for one image, with the same number of rows.

        The number of each output is that of its columns: 0 for any, None if it has rows without columns.
        """
        shapes = self.shapes
        if columns.keys() != shapes.keys():
            return False
        rows = {shapes[name][1:2] for name in columns}
        return len(rows) == 1 and all(_is_part(shapes[name], wanted) for name, wanted in columns.items())

    def cells(self) -> list[int]:
        """Return the numbers of cells that the grids can have."""
        width, height = self.size
        return [sum((width // stride) * (height // stride) for stride in strides) for strides in _STRIDES]

    def fits(self, columns: int, others: int) -> bool:
        """Return true if a number of columns is that of the classes and of `others`; true if that is unknown."""
        return columns > others if self.classes is None else columns == self.classes + others


Decoder = Callable[[Outputs, Signature], Candidates]
"""Function that returns the boxes that the outputs of a model mean."""


@dataclass(frozen=True, slots=True)
class Layout:
    """Meaning of a model's input and outputs."""

    name: str
    """Name for the user; variants of a layout share it."""
    matches: Callable[[Signature], bool]
    decode: Decoder
    preprocessing: Preprocessing = Preprocessing()  # noqa: RUF009  # it is frozen
    overlapping: bool = False
    """True if an object may have several boxes, so that the best one has to be chosen."""


def _yolov8(outputs: Outputs, _: Signature) -> Candidates:
    table = _single(outputs).T
    return _best(_corners(table[:, :4]), table[:, 4:])


def _yolov5(outputs: Outputs, _: Signature) -> Candidates:
    table = _single(outputs)
    return _best(_corners(table[:, :4]), table[:, 4:5] * table[:, 5:])


def _yolox(outputs: Outputs, model: Signature) -> Candidates:
    table = _single(outputs)
    cells, strides = _grid(model.size, len(table))
    boxes = np.hstack([(table[:, :2] + cells) * strides, np.exp(np.minimum(table[:, 2:4], 20.0)) * strides])
    return _best(_corners(boxes), table[:, 4:5] * table[:, 5:])


def _detr(boxes: str, scores: str) -> Decoder:
    def decode(outputs: Outputs, model: Signature) -> Candidates:
        # RF-DETR can have a last column for the background, which is no class.
        logits = outputs[scores][0][:, : model.classes]
        return _best(_corners(outputs[boxes][0]) * _twice(model.size), _sigmoid(logits))

    return decode


def _detr_in_one(outputs: Outputs, model: Signature) -> Candidates:
    table = _single(outputs)
    return _best(_corners(table[:, :4]) * _twice(model.size), table[:, 4:])


def _detr_ranked(outputs: Outputs, model: Signature) -> Candidates:
    table = _single(outputs)
    return Candidates(_corners(table[:, :4]) * _twice(model.size), table[:, 4], _indices(table[:, 5]))


def _detr_with_labels(outputs: Outputs, _: Signature) -> Candidates:
    return Candidates(outputs["boxes"][0], outputs["scores"][0], _indices(outputs["labels"][0]))


def _suppressed(outputs: Outputs, _: Signature) -> Candidates:
    table = _single(outputs)
    return Candidates(table[:, :4], table[:, 4], _indices(table[:, 5]))


def _suppressed_in_batch(outputs: Outputs, _: Signature) -> Candidates:
    (table,) = outputs.values()  # image, x1, y1, x2, y2, class, score
    return Candidates(table[:, 1:5], table[:, 6], _indices(table[:, 5]))


def _suppressed_in_parts(outputs: Outputs, _: Signature) -> Candidates:
    count = int(outputs["num_dets"].item())
    boxes, scores, classes = (outputs[f"det_{name}"][0][:count] for name in ("boxes", "scores", "classes"))
    return Candidates(boxes, scores, _indices(classes))


def _indices(classes: Array) -> NDArray[np.intp]:
    """Return indices of classes that a network has computed as numbers; -1 for NaN and for what is no index."""
    return np.where((classes >= 0) & (classes < _CLASSES), classes, -1).astype(np.intp)


def _is_table(shape: Sequence[int]) -> bool:
    return len(shape) == 3 and shape[0] == 1


def _has_parts(model: Signature) -> bool:
    others = dict(model.outputs)
    count = others.pop("num_dets", None)
    others_fit = replace(model, outputs=others).has(det_boxes=4, det_scores=None, det_classes=None)
    return count is not None and count.size == 1 and others_fit


def _has_cells(model: Signature) -> bool:
    return _is_table(model.only) and model.only[1] in model.cells() and model.fits(model.only[2], 5)


def _is_decoded(model: Signature) -> bool:
    """Return true if the boxes of YOLOX are in pixels: then they are nearer to their cells than as numbers of cells."""
    middles = _single(model.outputs)[:, :2]
    cells, strides = _grid(model.size, len(middles))
    decoded, raw = middles / strides - cells - 0.5, middles - 0.5
    return bool(np.median(np.abs(decoded)) < np.median(np.abs(raw)))


def _is_ranked(model: Signature) -> bool:
    """Return true if each row of the only output is a box in parts of the image, a score, and the number of a class."""
    if not _is_table(model.only) or model.only[2] != 6 or model.head not in ("", _RANKED):
        return False
    table = _single(model.outputs)
    boxes, classes = table[:, :4], table[:, 5]
    in_parts = 0 < boxes.max(initial=0) <= 1 and boxes.min(initial=0) >= 0
    return model.head == _RANKED or bool(in_parts and (classes == np.rint(classes)).all())


def _is_part(shape: Sequence[int], columns: int | None) -> bool:
    """Return true for a shape (1, N), or (1, N, columns); 0 is any number of columns except 0."""
    if columns is None:
        return len(shape) == 2 and shape[0] == 1
    return _is_table(shape) and shape[2] > 0 and columns in (0, shape[2])


_STRETCHED = Preprocessing(Fit.STRETCHED)
_YOLOX = Preprocessing(Fit.CORNER, rgb=False, unit=False)
_VARIANTS = (
    Layout(
        "yolov8",
        lambda model: _is_table(model.only) and model.only[1] < model.only[2] and model.fits(model.only[1], 4),
        _yolov8,
        overlapping=True,
    ),
    Layout(
        "yolov5",
        lambda model: (
            _is_table(model.only)
            and model.only[1] in [_RATIOS * cells for cells in model.cells()]
            and model.fits(model.only[2], 5)
        ),
        _yolov5,
        overlapping=True,
    ),
    Layout("yolox", lambda model: _has_cells(model) and not _is_decoded(model), _yolox, _YOLOX, overlapping=True),
    Layout("yolox", lambda model: _has_cells(model) and _is_decoded(model), _yolov5, _YOLOX, overlapping=True),
    Layout("rtdetr", lambda model: model.has(logits=0, pred_boxes=4), _detr("pred_boxes", "logits"), _STRETCHED),
    Layout("rtdetr", lambda model: model.has(labels=None, boxes=4, scores=None), _detr_with_labels, _STRETCHED),
    Layout(
        "rtdetr",
        lambda model: (
            _is_table(model.only)
            and model.only[1] > model.only[2]
            and not _is_on_grid(model)
            and not _is_ranked(model)
            and model.fits(model.only[2], 4)
        ),
        _detr_in_one,
        _STRETCHED,
    ),
    Layout("rtdetr", _is_ranked, _detr_ranked, _STRETCHED),
    Layout(
        "rfdetr",
        lambda model: model.has(dets=4, labels=0),
        _detr("dets", "labels"),
        Preprocessing(Fit.STRETCHED, normalized=True),
    ),
    Layout(
        "nms",
        lambda model: (
            _is_table(model.only)
            and model.only[2] == 6
            and not _is_ranked(model)
            and (model.suppressed or not _is_on_grid(model))
        ),
        _suppressed,
    ),
    Layout("nms", lambda model: len(model.only) == 2 and model.only[1] == 7, _suppressed_in_batch),
    Layout("nms", _has_parts, _suppressed_in_parts),
)
LAYOUTS = tuple(dict.fromkeys(layout.name for layout in _VARIANTS))
"""Names of the layouts."""


def candidates(signature: Signature, name: str | None = None) -> list[Layout]:
    """Return the layouts that a model can have; `name` is that of the only one that is possible, if it is known."""
    found = [layout for layout in _VARIANTS if name in (None, layout.name) and layout.matches(signature)]
    stated = [layout for layout in found if signature.suppressed and layout.name == "nms"]
    return stated or found


def without_grids(outputs: Outputs) -> Outputs:
    """Return the outputs without the maps (1, 3, H, W, 5+C) of YOLOv5 v6.0, if there is a table (1, N, 5+C), too."""
    tables = {name: output for name, output in outputs.items() if output.ndim == 3}
    columns = {output.shape[-1] for output in outputs.values() if output.ndim in (3, 5)}
    only_table = len(tables) == len(columns) == 1 and all(output.ndim in (3, 5) for output in outputs.values())
    return tables if only_table else outputs


def _is_on_grid(signature: Signature) -> bool:
    """Return true if the rows of the only output are as many as the cells of the grids of YOLOv5 or YOLOX."""
    return signature.only[1] in [count * cells for cells in signature.cells() for count in (1, _RATIOS)]


def _single(outputs: Outputs) -> Array:
    """Return the only output without its first axis."""
    (table,) = outputs.values()
    first: Array = table[0]
    return first


def _best(boxes: Floats, scores: Floats) -> Candidates:
    """Return each box with its best class."""
    classes = scores.argmax(axis=1)
    return Candidates(boxes, scores[np.arange(len(scores)), classes], classes)


def _corners(boxes: Floats) -> Floats:
    """Return boxes (N, 4) of cx cy w h as x1 y1 x2 y2."""
    half = boxes[:, 2:4] / 2
    return np.hstack([boxes[:, :2] - half, boxes[:, :2] + half])


def _grid(size: tuple[int, int], count: int) -> tuple[Floats, Floats]:
    """Return the column and row (N, 2) of each cell of YOLOX's grids, and the cells' sides (N, 1) in pixels."""
    strides = next(group for group in _STRIDES if sum((size[0] // s) * (size[1] // s) for s in group) == count)
    cells, sides = [], []
    for stride in strides:
        columns, rows = np.meshgrid(np.arange(size[0] // stride), np.arange(size[1] // stride))
        cells.append(np.column_stack([columns.ravel(), rows.ravel()]))
        sides.append(np.full((columns.size, 1), float(stride)))
    return np.vstack(cells).astype(float), np.vstack(sides)


def _twice(size: tuple[int, int]) -> Floats:
    return np.array([*size, *size], float)


def _sigmoid(logits: Floats) -> Floats:
    with np.errstate(over="ignore"):
        found: Floats = 1 / (1 + np.exp(-logits.astype(float)))
    return found

"""ONNX file of a trained network. Its layout is that of YOLOv8, so other programs can run it, too."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from roverkit.objects.detector import AUTHOR
from roverkit.objects.training.jax_network import EPSILON
from roverkit.objects.training.libraries import onnx
from roverkit.objects.training.network import BOX, SIZE_UNIT, STRIDE, network
from roverlink.runtime.atomic_files import replacing
from roverlink.runtime.core.errors import SetupError

_OPSET, _IR = 13, 8  # what ONNX Runtime of 2022 can read
_LARGEST = 6.0
"""Largest logarithm of a size: exp(6) * 16 pixels is larger than any input."""


def write_model(
    path: Path,
    weights: Mapping[str, Any],
    statistics: Mapping[str, Any],
    names: Sequence[str],
    size: tuple[int, int],
    description: str,
) -> None:
    """Write a network for images of `size` (width, height). Raises `SetupError` if the file cannot be written."""
    do = _Onnx(weights, statistics)
    _decoded(do, network(do, "images", len(names)), len(names), size)
    graph = onnx.helper.make_graph(
        do.nodes,
        "detector",
        [onnx.helper.make_tensor_value_info("images", onnx.TensorProto.FLOAT, (1, 3, size[1], size[0]))],
        [onnx.helper.make_tensor_value_info("output0", onnx.TensorProto.FLOAT, (1, BOX + len(names), _cells(size)))],
        do.constants,
    )
    model = onnx.helper.make_model(
        graph, opset_imports=[onnx.helper.make_opsetid("", _OPSET)], ir_version=_IR, producer_name=AUTHOR
    )
    onnx.helper.set_model_props(
        model,
        {
            "author": AUTHOR,
            "description": description,
            "imgsz": str([size[1], size[0]]),
            "names": str(dict(enumerate(names))),
            "stride": str(STRIDE),
            "task": "detect",
        },
    )
    onnx.checker.check_model(model)
    try:
        with replacing(path) as part:
            part.write_bytes(model.SerializeToString(deterministic=True))
    except OSError as error:
        raise SetupError(f"{path}: cannot write the model: {error.strerror or error}") from error


def check_replaceable(path: Path) -> None:
    """Raise `SetupError` if a path is taken by a file that `write_model` has not written, or has no folder."""
    if not path.resolve().parent.is_dir():
        raise SetupError(f"{path}: the folder does not exist")
    if not path.exists():
        return
    try:
        props = {entry.key: entry.value for entry in onnx.load(path, load_external_data=False).metadata_props}
    except Exception:  # noqa: BLE001  # the parser's errors have no common class; it is no model then
        props = {}
    if props.get("author") != AUTHOR:
        raise SetupError(f"{path} exists, and `roverlink objects train` has not written it; give --out another name")


def _cells(size: tuple[int, int]) -> int:
    return (size[0] // STRIDE) * (size[1] // STRIDE)


def _decoded(do: _Onnx, outputs: str, classes: int, size: tuple[int, int]) -> None:
    """Add the operations from the cells' outputs (1, 4 + C, H, W) to boxes and scores (1, 4 + C, N)."""
    offset = do.node("Slice", outputs, do.constant([0]), do.constant([2]), do.constant([1]))
    extent = do.node("Slice", outputs, do.constant([2]), do.constant([BOX]), do.constant([1]))
    scores = do.node("Slice", outputs, do.constant([BOX]), do.constant([BOX + classes]), do.constant([1]))
    columns, rows = np.meshgrid(np.arange(size[0] // STRIDE), np.arange(size[1] // STRIDE))
    middles = (np.stack([columns, rows])[None] + 0.5).astype(np.float32)
    centres = do.node("Mul", do.node("Add", offset, do.constant(middles)), do.constant(np.float32(STRIDE)))
    limited = do.node("Min", extent, do.constant(np.float32(_LARGEST)))
    lengths = do.node("Mul", do.node("Exp", limited), do.constant(np.float32(SIZE_UNIT)))
    # A cell whose neighbour has a better score is no middle.
    sure = do.node("Sigmoid", scores)
    best = do.node("MaxPool", sure, kernel_shape=[3, 3], pads=[1, 1, 1, 1], strides=[1, 1])
    peak = do.node("Cast", do.node("Equal", sure, best), to=onnx.TensorProto.FLOAT)
    whole = do.node("Concat", centres, lengths, do.node("Mul", sure, peak), axis=1)
    do.node("Reshape", whole, do.constant([1, BOX + classes, _cells(size)]), name="output0")


class _Onnx:
    """Operations that add nodes to a graph; a feature map (1, C, H, W) is the name of a node's output."""

    def __init__(self, weights: Mapping[str, Any], statistics: Mapping[str, Any]) -> None:
        self._weights, self._statistics = weights, statistics
        self.nodes: list[Any] = []
        self.constants: list[Any] = []

    def node(self, kind: str, *inputs: str, name: str = "", **attributes: Any) -> str:
        """Add a node, and return the name of its output."""
        output = name or f"{kind.lower()}_{len(self.nodes)}"
        self.nodes.append(onnx.helper.make_node(kind, list(inputs), [output], **attributes))
        return output

    def constant(self, value: Any) -> str:
        """Add a constant, and return its name; a list becomes an array of 64-bit integers."""
        name = f"constant_{len(self.constants)}"
        array = np.asarray(value, np.int64) if isinstance(value, list) else np.asarray(value)
        self.constants.append(onnx.numpy_helper.from_array(array, name))
        return name

    def convolve(self, x: str, name: str, channels: int, *, stride: int = 1, side: int = 3) -> str:  # noqa: ARG002
        # In use, normalization is a factor and a summand for each channel, and so a part of the convolution.
        scale = np.asarray(self._weights[f"{name}.scale"]) / np.sqrt(
            np.asarray(self._statistics[f"{name}.variance"]) + EPSILON
        )
        bias = np.asarray(self._weights[f"{name}.bias"]) - np.asarray(self._statistics[f"{name}.mean"]) * scale
        return self._convolved(x, name, scale, bias, stride)

    def relu(self, x: str) -> str:
        return self.node("Relu", x)

    def add(self, x: str, y: str) -> str:
        return self.node("Add", x, y)

    def enlarge(self, x: str) -> str:
        scales = self.constant(np.array([1, 1, 2, 2], np.float32))
        return self.node(
            "Resize", x, "", scales, mode="nearest", coordinate_transformation_mode="asymmetric", nearest_mode="floor"
        )

    def predict(self, x: str, name: str, channels: int) -> str:
        return self._convolved(x, name, np.ones(channels), np.asarray(self._weights[f"{name}.bias"]), 1)

    def _convolved(self, x: str, name: str, scale: Any, bias: Any, stride: int) -> str:
        kernel = (np.asarray(self._weights[f"{name}.kernel"]) * scale).transpose(3, 2, 0, 1).astype(np.float32)
        around = kernel.shape[2] // 2
        return self.node(
            "Conv",
            x,
            self.constant(kernel),
            self.constant(bias.astype(np.float32)),
            strides=[stride] * 2,
            pads=[around] * 4,
            kernel_shape=list(kernel.shape[2:]),
        )

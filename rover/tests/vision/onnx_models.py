"""Small ONNX files whose outputs are constants, or simple functions of the image."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from onnx import TensorProto, helper, numpy_helper


def write(
    path: Path,
    outputs: Mapping[str, Any],
    size: tuple[int, int] = (64, 64),
    metadata: Mapping[str, object] = {},  # it is not changed
    inputs: Mapping[str, Sequence[int | str]] | None = None,
    kind: int = TensorProto.FLOAT,
) -> Path:
    """A detector that finds the same in every image; ``size`` is the width and height of its input."""
    given = inputs or {"images": (1, 3, size[1], size[0])}
    arrays = {name: np.asarray(value) for name, value in outputs.items()}
    types = {name: helper.np_dtype_to_tensor_dtype(one.dtype) for name, one in arrays.items()}
    info = helper.make_tensor_value_info
    graph = helper.make_graph(
        [helper.make_node("Identity", [f"{name}_value"], [name]) for name in arrays],
        "detector",
        [info(name, kind if len(shape) == 4 else TensorProto.INT64, shape) for name, shape in given.items()],
        [info(name, types[name], one.shape) for name, one in arrays.items()],
        [numpy_helper.from_array(one, f"{name}_value") for name, one in arrays.items()],
    )
    return save(path, graph, metadata)


def save(path: Path, graph: Any, metadata: Mapping[str, object] = {}) -> Path:  # it is not changed
    """Write a graph with metadata, as ONNX Runtime of 2022 reads it."""
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)], ir_version=8)
    helper.set_model_props(model, {name: str(value) for name, value in metadata.items()})
    path.write_bytes(model.SerializeToString())
    return path

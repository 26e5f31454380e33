"""ONNX Runtime: opening of model files. Only this module imports it; without it, the error says how to install it."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverlink import bounded_files
from roverlink.runtime.core.errors import SetupError

_INSTALL = "install it with `pip install 'onnxruntime>=1.17'`"
_PROVIDERS = ("TensorrtExecutionProvider", "CUDAExecutionProvider", "CPUExecutionProvider")
"""Execution providers, the fastest one first; those of the installed ONNX Runtime are used."""
_FATAL = 4  # log level: errors are reported as exceptions, too
_TYPES = {"tensor(float)": np.float32, "tensor(float16)": np.float16, "tensor(int64)": np.int64}

Array = NDArray[Any]
_LARGEST = 2 << 30  # bytes of a model; protobuf, ONNX's format, has no more


class Session:
    """Open model."""

    def __init__(self, path: Path) -> None:
        """Open an ONNX file. Raises `SetupError` if that is not possible."""
        self._path = path
        runtime = import_runtime()
        runtime.set_default_logger_severity(_FATAL)
        try:
            data = bounded_files.read(path, _LARGEST)
        except OSError as error:
            raise SetupError(f"{path}: cannot read the model: {error.strerror}") from error
        options = runtime.SessionOptions()
        options.log_severity_level = _FATAL
        # Threads that wait busily for the next image need twice the CPU time of the computation.
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")
        there = runtime.get_available_providers()
        try:
            # From bytes: then a model cannot read other files as its weights.
            self._session = runtime.InferenceSession(
                data, options, [provider for provider in _PROVIDERS if provider in there]
            )
        except Exception as error:  # ONNX Runtime's errors have no common class
            raise SetupError(f"{path}: {_reason(error)}") from error
        self.provider: str = self._session.get_providers()[0]
        """Execution provider that runs the model, such as ``CUDAExecutionProvider``."""
        self.metadata: dict[str, str] = dict(self._session.get_modelmeta().custom_metadata_map)
        self.inputs: dict[str, tuple[int | None, ...]] = {
            given.name: tuple(side if isinstance(side, int) and side > 0 else None for side in given.shape)
            for given in self._session.get_inputs()
        }
        """Shapes of the inputs by their names; None for a side that the file leaves open."""
        self._types = {given.name: given.type for given in self._session.get_inputs()}
        if unknown := sorted(set(self._types.values()) - _TYPES.keys()):
            raise SetupError(f"{path}: an input has the type {unknown[0]}; export the model with inputs of float32")
        outputs = self._session.get_outputs()
        if other := [
            output.type for output in outputs if not output.type.startswith("tensor(") or "string" in output.type
        ]:
            raise SetupError(f"{path}: an output has the type {other[0]}; a detector has tensors of numbers")
        self._outputs = [output.name for output in outputs]

    def run(self, inputs: Sequence[Array]) -> dict[str, Array]:
        """Return the outputs by their names for the inputs in their order. Raises `SetupError` if the model fails."""
        feed = {name: value.astype(_TYPES[self._types[name]], copy=False) for name, value in zip(self.inputs, inputs)}
        try:
            outputs = self._session.run(None, feed)
        except Exception as error:  # ONNX Runtime's errors have no common class
            raise SetupError(f"{self._path}: the model fails on an image: {_reason(error)}") from error
        # In half precision, the arithmetic of boxes would round them to half a pixel.
        return {
            name: output.astype(np.float32) if output.dtype == np.float16 else output
            for name, output in zip(self._outputs, outputs)
        }


def import_runtime() -> Any:
    """Return the module of ONNX Runtime. Raises `SetupError` if it is not installed."""
    try:
        return importlib.import_module("onnxruntime")
    except ImportError as error:
        raise SetupError(f"the detection of objects needs ONNX Runtime ({error}); {_INSTALL}") from error


def _reason(error: Exception) -> str:
    """Return the reason of an error of ONNX Runtime as one line, with the cure where it is known."""
    text = " ".join(str(error).split())
    if "INVALID_PROTOBUF" in text:
        return "this is not an ONNX model, or it is truncated; export or copy it again"
    if "external data" in text.lower() or "external_data" in text.lower():
        return "the weights are in another file; export the model as one file (onnx.save without external data)"
    if "NOT_IMPLEMENTED" in text or "is not a registered function/op" in text or "No Op registered" in text:
        return f"ONNX Runtime lacks an operator of the model; update it, or export an older opset ({text[-150:]})"
    _, _, rest = text.rpartition(" : ")
    return f"ONNX Runtime cannot use the model: {rest or text}"

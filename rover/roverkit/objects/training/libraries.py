"""Import of the libraries for training. Only this module imports them; without one, the error says how to install it.

They have the type Any, because optax has no type stubs, and those of jax need Python 3.11.
"""

from __future__ import annotations

import importlib
from typing import Any

from roverlink.runtime.core.errors import SetupError


def _load(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        cure = "install what it needs with `pip install 'jax>=0.4.30' 'optax>=0.2' 'onnx>=1.16'`"
        raise SetupError(f"training needs {name.partition('.')[0]} ({error}); {cure}") from error


jax: Any = _load("jax")
jnp: Any = _load("jax.numpy")
optax: Any = _load("optax")
onnx: Any = _load("onnx")

"""Import of GTSAM, which is optional, as `gtsam`, with an explanation of how to install it."""

from __future__ import annotations

import sys
from typing import Any

from roverlink.runtime.core.errors import SetupError

_PACKAGE = "gtsam>=4.3.0" if sys.version_info >= (3, 11) else "gtsam==4.3a1"  # as in pyproject.toml

try:
    import gtsam as _gtsam
except ImportError as error:
    raise SetupError(f"the fusion needs GTSAM ({error}); install it with `pip install '{_PACKAGE}'`") from error

__all__ = ["gtsam", "is_unsolvable"]

gtsam: Any = _gtsam
"""GTSAM. Its own types differ from version to version, and not all of them are right."""


def is_unsolvable(error: RuntimeError) -> bool:
    """Return true if GTSAM could not solve a graph, because its inputs contradict each other or do not suffice."""
    return "linear system" in str(error)  # of an IndeterminantLinearSystemException, which Python gets as its text only

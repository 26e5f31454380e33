# Generated from mapping.yaml and tree.proto; do not edit.
# Regenerate with: roverlink generate
"""Expression to and from rover/msg/ExpressionLevel2."""

from __future__ import annotations

from generated.conversions import sum_level2
from generated.messages import ExpressionLevel2
from generated.pb2 import tree_pb2
from runtime import depth, oneof

_WHICH_KIND = {"value": ExpressionLevel2.KIND_VALUE, "sum": ExpressionLevel2.KIND_SUM}


def to_ros(payload: tree_pb2.Expression) -> ExpressionLevel2:
    """The message that says what the payload says."""
    depth.check_end(payload, "negated")
    return ExpressionLevel2(
        which_kind=oneof.number(payload, "kind", _WHICH_KIND),
        value=payload.value,
        sum=sum_level2.to_ros(payload.sum),
    )


def from_ros(message: ExpressionLevel2) -> tree_pb2.Expression:
    """The payload that says what the message says."""
    which_kind = oneof.member(
        message.which_kind,
        _WHICH_KIND,
        "ExpressionLevel2.which_kind",
    )
    return tree_pb2.Expression(
        value=message.value if which_kind == "value" else None,
        sum=sum_level2.from_ros(message.sum) if which_kind == "sum" else None,
    )

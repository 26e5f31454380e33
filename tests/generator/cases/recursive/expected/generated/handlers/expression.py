# Generated from mapping.yaml (row expression) and tree.proto; do not edit.
# Regenerate with: roverlink generate
"""expression (3): Expression to rover/msg/Expression on expression."""

from __future__ import annotations

from generated.conversions import expression_level2, sum_
from generated.messages import Expression
from generated.pb2 import tree_pb2
from runtime import oneof
from runtime.handler import Handler, Route

_WHICH_KIND = {
    "value": Expression.KIND_VALUE,
    "sum": Expression.KIND_SUM,
    "negated": Expression.KIND_NEGATED,
}


class ExpressionHandler(Handler[tree_pb2.Expression, Expression]):
    """Expression to the topic expression."""

    route = Route(
        number=3,
        name="expression",
        topic="expression",
        direction="board_to_ros",
    )
    payload_type = tree_pb2.Expression
    message_type = Expression

    @staticmethod
    def to_ros(payload: tree_pb2.Expression) -> Expression:
        """The message that says what the payload says."""
        return Expression(
            which_kind=oneof.number(payload, "kind", _WHICH_KIND),
            value=payload.value,
            sum=sum_.to_ros(payload.sum),
            negated=expression_level2.to_ros(payload.negated),
        )

    @staticmethod
    def from_ros(message: Expression) -> tree_pb2.Expression:
        """The payload that says what the message says."""
        which_kind = oneof.member(message.which_kind, _WHICH_KIND, "which_kind")
        return tree_pb2.Expression(
            value=message.value if which_kind == "value" else None,
            sum=sum_.from_ros(message.sum) if which_kind == "sum" else None,
            negated=(
                expression_level2.from_ros(message.negated)
                if which_kind == "negated"
                else None
            ),
        )

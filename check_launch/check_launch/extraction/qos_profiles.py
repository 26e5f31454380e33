"""Reliability and durability that a C++ expression of a QoS profile gives (`rclcpp/qos.hpp`)."""

from __future__ import annotations

import re
from collections.abc import Callable

from check_launch.extraction.cpp_expressions import Scope

_DEFAULT = ("reliable", "volatile")
_RELIABILITY = (
    (r"best_effort\(\)|BEST_EFFORT|BestEffort", "best_effort"),
    (r"(?<!best_)\breliable\(\)|POLICY_RELIABILITY_RELIABLE|::Reliable", "reliable"),
)
_DURABILITY = ((r"transient_local\(\)|TRANSIENT_LOCAL|TransientLocal", "transient_local"),)


def qos_of(expression: str, scope: Scope, linked: Callable[[str], str], is_topic: bool) -> tuple[str, str]:
    """Return reliability and durability; both are empty if they are not known.

    ``linked`` returns the parameter of which a variable has the value; the reliability is then ``$(parameter)``.
    """
    if not is_topic:
        return "", ""
    text = " ".join(expression.split())
    if not text or re.fullmatch(r"\d+", text):
        return _DEFAULT
    if re.fullmatch(r"\w+", text):
        written = scope.written_with(text)
        if not written and scope.value(text)[0] == "integer":
            return _DEFAULT  # the depth of the queue
        text = f"{text} {written}"
    if "from_rmw" in text:
        return "", ""  # a text in a parameter names the profile
    if by_parameter := re.search(
        r"reliability\((?:\([\w:]+\)\s*)?([\w.]+(?:\(\))?)\)|RCLCPP_QOS\([^,]*,\s*(?:\([\w:]+\)\s*)?([\w.]+(?:\(\))?)\)",
        text,
    ):
        variable = by_parameter[1] or by_parameter[2]
        if parameter := linked(variable):
            durability = "" if "?" in text else "volatile"
            return f"$({parameter})", durability
    if "SensorDataQoS" in text or "qos_profile_sensor_data" in text:
        base = ("best_effort", "volatile")
    elif re.search(r"SystemDefaultsQoS|QoS\(|QoS\b|KeepLast|rmw_qos_profile_default|SystemDefault", text):
        base = _DEFAULT
    else:
        return "", ""
    reliability = next((value for pattern, value in _RELIABILITY if re.search(pattern, text)), base[0])
    durability = next((value for pattern, value in _DURABILITY if re.search(pattern, text)), base[1])
    if "?" in text or scope.is_conditional(expression.strip()):
        durability = ""  # a parameter decides
        if "SensorDataQoS" in text:
            reliability = ""  # it decides about the whole profile
    return reliability, durability

"""ROS_DOMAIN_ID: the DDS domain, for every middleware alike."""

from __future__ import annotations

import os
import re

from roverlink.runtime.core.errors import MiddlewareError

_LARGEST = 232  # ports are 7400 + 250 * domain and up (RTPS 2.2, 9.6.1); above 232 they exceed 65535
# rcl takes a number with a leading zero for an octal one.
_NUMBER = re.compile("0|[1-9][0-9]{0,2}")


def ros_domain() -> int:
    """Return the domain that ROS_DOMAIN_ID selects. Raises `MiddlewareError` if it is not a number from 0 to 232."""
    text = os.environ.get("ROS_DOMAIN_ID", "") or "0"
    if not _NUMBER.fullmatch(text) or int(text) > _LARGEST:
        raise MiddlewareError(f"ROS_DOMAIN_ID is {text!r}; set it to a number from 0 to {_LARGEST}")
    return int(text)

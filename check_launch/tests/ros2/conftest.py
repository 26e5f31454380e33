"""The fixtures of the tests with a real ROS 2."""

from ros2_fixtures import (  # type: ignore[import-not-found]  # in tests/ros2, which only its run has on the path
    bridge,
    environment,
    join,
    judge,
    middleware,
)

__all__ = ["bridge", "environment", "join", "judge", "middleware"]

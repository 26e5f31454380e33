"""The fixtures of the tests with a real ROS 2."""

from ros2_fixtures import bridge, environment, installed, join, judge, middleware

__all__ = ["bridge", "environment", "installed", "join", "judge", "middleware"]

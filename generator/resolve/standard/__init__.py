"""Conversion between payloads and standard messages, such as sensor_msgs/Imu.

The package checks the table's entries for these messages and resolves them to the IR, the compiler's own model.
"""

from roverlink.generator.resolve.standard.mappings import StandardTopics

__all__ = ["StandardTopics"]

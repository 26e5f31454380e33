"""The rows' mappings to messages of ROS 2's common interfaces: checked both ways, and made into the IR."""

from roverlink.generator.resolve.standard.mappings import StandardTopics

__all__ = ["StandardTopics"]

"""The messages of ROS 2's common interfaces: their definitions, and what those say of units and of zero."""

"""Conversion of well-known types (google.protobuf.*) to their ROS 2 counterparts and back, one module for each type.

``field`` is the name of the field that is converted. Error messages contain it.
"""

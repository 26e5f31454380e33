"""Well-known types (google.protobuf.*) to and from their ROS 2 counterparts, one module each.

``field`` is the field's name, for errors.
"""

"""Types of google.protobuf that mean more than their fields: to and from what ROS 2 has for them, a module each.

``field``, in all of them, is the name of the field for an error.
"""

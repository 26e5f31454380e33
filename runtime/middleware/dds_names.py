"""Names of ROS 2 types in DDS, which rmw_zenoh uses, too: ``comms/msg/Imu`` is ``comms::msg::dds_::Imu_``."""

from __future__ import annotations


def dds_type_name(ros_name: str) -> str:
    """Return the DDS name of a ROS type. ROS 2's IDL has each type in a module ``dds_``, and adds an underscore."""
    package, kind, name = ros_name.split("/")
    return f"{package}::{kind}::dds_::{name}_"


def ros_type_name(dds_name: str) -> str:
    """Return the ROS name of a DDS type."""
    return dds_name.replace("::dds_::", "::").replace("::", "/").removesuffix("_")

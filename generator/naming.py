"""What ROS 2 allows as a name, and the name that a thing gets where the table gives none."""

from __future__ import annotations

import re

# The patterns of rosidl_adapter and of rcl's topic rules.
_MESSAGE = re.compile(r"[A-Z][A-Za-z0-9]*")
_PACKAGE = re.compile(r"(?!.*__)(?!.*_$)[a-z][a-z0-9_]*")
_FIELD = re.compile(r"(?!.*__)(?!.*_$)[a-z][a-z0-9_]*")
_CONSTANT = re.compile(r"(?!.*__)(?!.*_$)[A-Z][A-Z0-9_]*")
_TOPIC = re.compile(r"(/|~/)?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*")


def is_message_name(name: str) -> bool:
    """Whether ROS allows it as the name of a message."""
    return _MESSAGE.fullmatch(name) is not None


def is_package_name(name: str) -> bool:
    """Whether ROS allows it as the name of a package."""
    return _PACKAGE.fullmatch(name) is not None


def is_field_name(name: str) -> bool:
    """Whether ROS allows it as the name of a field."""
    return _FIELD.fullmatch(name) is not None


def is_constant_name(name: str) -> bool:
    """Whether ROS allows it as the name of a constant."""
    return _CONSTANT.fullmatch(name) is not None


def is_topic_name(name: str) -> bool:
    """Whether ROS allows it as the name of a topic."""
    return _TOPIC.fullmatch(name) is not None


def snake_case(name: str) -> str:
    """A CamelCase name in lower case with underscores, by the rule of rosidl.

    >>> snake_case("SensorBoardPHInfo")
    'sensor_board_ph_info'
    """
    name = re.sub(r"(.)([A-Z][a-z]+)", r"\1_\2", name)
    return re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name).lower()


def camel_case(name: str) -> str:
    """A name with underscores in CamelCase.

    >>> camel_case("imu_info")
    'ImuInfo'
    """
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


def distinct(name: str) -> str:
    """What is left of a field's name where capitals and underscores do not count, as in a class and in protobuf's JSON.

    >>> distinct("imu_info") == distinct("ImuInfo")
    True
    """
    return camel_case(name).lower()


def message_name(proto: str, package: str) -> str:
    """The ROS name of a proto message that no row names: its nesting joined, without the proto package.

    >>> message_name("rover.Arm.Joint", "rover")
    'ArmJoint'
    """
    return camel_case(proto.removeprefix(f"{package}.").replace(".", "_"))

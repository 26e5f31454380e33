"""Script that writes the classes of standard messages in ``runtime/interfaces``; ``make generate`` runs it.

The runtime has the messages of `OF_THE_RUNTIME`, and those that its own node and the programs of other packages need.
Their definitions are those of ``definitions.txt``, and `_MORE` has those that the rosbags package does not know. Type
hashes come from the rosbags package. With ``--check``, the script fails if the classes are not current.
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from roverlink.generator.emit.targets.python.interfaces import OF_THE_RUNTIME, module
from roverlink.generator.ir.interfaces import Interface, InterfaceConstant
from roverlink.generator.resolve.interfaces.definitions import DISTRIBUTIONS, blocks, interface, interface_of

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

FOLDER = Path(__file__).parents[4] / "runtime" / "interfaces"
_TOP = """\
# Generated from the definitions of ROS 2; do not edit.
# Regenerate with: make generate"""
_LINE_LENGTH = 120
_NODE = (
    *("rcl_interfaces/msg/FloatingPointRange", "rcl_interfaces/msg/IntegerRange"),
    *("rcl_interfaces/msg/ListParametersResult", "rcl_interfaces/msg/Log", "rcl_interfaces/msg/Parameter"),
    *("rcl_interfaces/msg/ParameterDescriptor", "rcl_interfaces/msg/ParameterEvent"),
    *("rcl_interfaces/msg/ParameterValue", "rcl_interfaces/msg/SetParametersResult", "rosgraph_msgs/msg/Clock"),
)
_VALUE, _KINDS = "rcl_interfaces/msg/ParameterValue", "rcl_interfaces/msg/ParameterType"
# The package vision_msgs is as its repository has it since version 4.0, of Humble.
_MORE = """\
rcl_interfaces/srv/ListParameters_Request
  string[] prefixes
  uint64 depth
rcl_interfaces/srv/ListParameters_Response
  rcl_interfaces/msg/ListParametersResult result
rcl_interfaces/srv/GetParameters_Request
  string[] names
rcl_interfaces/srv/GetParameters_Response
  rcl_interfaces/msg/ParameterValue[] values
rcl_interfaces/srv/GetParameterTypes_Request
  string[] names
rcl_interfaces/srv/GetParameterTypes_Response
  uint8[] types
rcl_interfaces/srv/DescribeParameters_Request
  string[] names
rcl_interfaces/srv/DescribeParameters_Response
  rcl_interfaces/msg/ParameterDescriptor[] descriptors
rcl_interfaces/srv/SetParameters_Request
  rcl_interfaces/msg/Parameter[] parameters
rcl_interfaces/srv/SetParameters_Response
  rcl_interfaces/msg/SetParametersResult[] results
rcl_interfaces/srv/SetParametersAtomically_Request
  rcl_interfaces/msg/Parameter[] parameters
rcl_interfaces/srv/SetParametersAtomically_Response
  rcl_interfaces/msg/SetParametersResult result
vision_msgs/msg/ObjectHypothesis
  string class_id
  float64 score
vision_msgs/msg/ObjectHypothesisWithPose
  vision_msgs/msg/ObjectHypothesis hypothesis
  geometry_msgs/msg/PoseWithCovariance pose
vision_msgs/msg/Point2D
  float64 x
  float64 y
vision_msgs/msg/Pose2D
  vision_msgs/msg/Point2D position
  float64 theta
vision_msgs/msg/BoundingBox2D
  vision_msgs/msg/Pose2D center
  float64 size_x
  float64 size_y
vision_msgs/msg/Detection2D
  std_msgs/msg/Header header
  vision_msgs/msg/ObjectHypothesisWithPose[] results
  vision_msgs/msg/BoundingBox2D bbox
  string id
vision_msgs/msg/Detection2DArray
  std_msgs/msg/Header header
  vision_msgs/msg/Detection2D[] detections
vision_msgs/msg/BoundingBox3D
  geometry_msgs/msg/Pose center
  geometry_msgs/msg/Vector3 size
vision_msgs/msg/Detection3D
  std_msgs/msg/Header header
  vision_msgs/msg/ObjectHypothesisWithPose[] results
  vision_msgs/msg/BoundingBox3D bbox
  string id
vision_msgs/msg/Detection3DArray
  std_msgs/msg/Header header
  vision_msgs/msg/Detection3D[] detections
"""


def texts() -> Iterator[tuple[Path, str]]:
    """Yield path and text of each module with generated classes."""
    import black  # here, like rosbags below: only this script needs them

    found, hashes = _interfaces(), _hashes()
    for package, interfaces in itertools.groupby(found, lambda interface: interface.package):
        text = module(_TOP, package, list(interfaces), "roverlink.runtime", hashes=hashes)
        yield FOLDER / f"{package}.py", black.format_str(text, mode=black.Mode(line_length=_LINE_LENGTH))


def _interfaces() -> list[Interface]:
    # The newest distribution has all constants of the others, and the fields of these messages are the same.
    newest = DISTRIBUTIONS[-1]
    known = [found for name in (*OF_THE_RUNTIME, *_NODE) if (found := interface(name, newest))]
    kinds = interface(_KINDS, newest)
    constants = tuple(_without_prefix(constant) for constant in kinds.constants) if kinds else ()
    known = [replace(found, constants=constants) if found.name == _VALUE else found for found in known]
    return sorted([*known, *(interface_of(name, lines) for name, _, lines in blocks(_MORE))], key=lambda one: one.name)


def _without_prefix(constant: InterfaceConstant) -> InterfaceConstant:
    """Return a constant of ParameterType as ParameterValue has it in our classes: BOOL for PARAMETER_BOOL."""
    return replace(constant, name=constant.name.removeprefix("PARAMETER_"))


def _hashes() -> dict[str, str]:
    """Return the type hash of each message; services have others, which nobody compares."""
    known = store()
    return {found.name: known.hash_rihs01(found.name) for found in _interfaces() if "/msg/" in found.name}


def store() -> Typestore:
    """Return the definitions of the rosbags package, and `_MORE`, in the form of that package."""
    from rosbags.typesys import Stores, get_typestore
    from rosbags.typesys.msg import get_types_from_msg

    known = get_typestore(Stores.ROS2_JAZZY)
    for name, _, lines in blocks(_MORE):
        known.register(get_types_from_msg("\n".join(lines), name))
    return known


if __name__ == "__main__":
    stale = [(path, text) for path, text in texts() if path.read_text(encoding="utf-8") != text]
    if stale and sys.argv[1:] == ["--check"]:
        sys.exit(f"{', '.join(path.name for path, _ in stale)} in runtime/interfaces: not current; run `make generate`")
    for path, text in stale:
        path.write_text(text, encoding="utf-8")

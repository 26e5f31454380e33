"""Target `ros2`: the ROS 2 interface package with its messages, build files, launch files and parameters."""

from __future__ import annotations

import itertools
from typing import Any

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.ir.msg_types import msg_type
from roverlink.generator.node_parameters import node_parameters
from roverlink.transport_addresses import on_serial_line

_LAUNCH_ARGUMENTS = {
    "middleware": ("auto", "auto, dds, rclpy, zenoh or memory; `roverlink run --help` explains them"),
    "namespace": ("", "ROS 2 namespace of the node and its topics"),
    "log_level": ("info", "debug, info, warn, error or fatal"),
}
"""Default and description of each argument of the launch files that is not a parameter of the node."""

_PARAMS_FILE = "YAML file with the parameters of the node"
_ADDRESSES = ("listen_address", "listen_port", "dst_ip")
"""Parameters of the node that are also arguments of the launch files, because their values differ between computers.

The parameters with the addresses of peers and boards are also arguments; their names come from the table.
"""

VENDOR = "vendor"
"""Folder of the package with the runtime and the generated Python code, if the table or an option asks for it."""
NEEDS = {"python3-protobuf": "3.20", "python3-yaml": "5.4"}
"""Oldest versions of the packages that the runtime and the generated code need, by rosdep's keys."""
_NEEDS_OF_SERIAL = {"python3-serial": "3.5"}
"""Package that the runtime needs, too, if an end of the table is at a serial line."""
PROTOBUF = f"protobuf>={NEEDS['python3-protobuf']},<8"
"""Requirement for pip of the first of these packages, of which Ubuntu 22.04 has an older version."""


def emit(bridge: ir.Bridge) -> Files:
    """Yield the files of the ROS 2 interface package."""
    folder = f"generated/ros/{bridge.package}"
    for message in bridge.messages:
        yield f"{folder}/msg/{message.name}.msg", _msg(bridge, message)
    for service in bridge.services:
        yield f"{folder}/srv/{service.type}.srv", _srv(bridge, service)
    names = sorted(message.name for message in bridge.messages)
    comment = header(bridge.table)
    # Packages whose messages are fields; rosidl needs them as DEPENDENCIES when it generates code.
    others = sorted({field.type.package for message in bridge.messages for field in message.fields} - {""})
    yield (
        f"{folder}/CMakeLists.txt",
        render(
            "CMakeLists.txt.j2",
            header=comment,
            package=bridge.package,
            messages=names,
            services=[service.type for service in bridge.services],
            others=others,
            folder=bridge.folder,
            vendor=VENDOR,
        ),
    )
    name, _, address = bridge.maintainer.partition(" <")
    is_serial = on_serial_line(end.host for peer in bridge.peers for end in peer.ends)
    xml = header(bridge.table, "<!--", " -->")
    yield (
        f"{folder}/package.xml",
        render(
            "package.xml.j2",
            header=xml,
            package=bridge.package,
            maintainer=name,
            address=address.rstrip(">"),
            version=bridge.version,
            license=bridge.license,
            needs=NEEDS | (_NEEDS_OF_SERIAL if is_serial else {}),
            others=others,
            spoken=sorted({interface.package for interface in bridge.interfaces} - {*others}),
        ),
    )
    for path, template in (
        (f"{bridge.package}.launch.py", "launch.py.j2"),
        (f"{bridge.package}_launch.yaml", "launch.yaml.j2"),
    ):
        yield (
            f"{folder}/launch/{path}",
            render(
                template,
                header=comment,
                package=bridge.package,
                arguments=_LAUNCH_ARGUMENTS,
                params_file=_PARAMS_FILE,
                keys=_keys(bridge),
                addresses=_addresses(bridge),
            ),
        )
    yield (
        f"{folder}/scripts/{bridge.package}_node.py",
        render("node.py.j2", header=comment, protobuf=NEEDS["python3-protobuf"], requirement=PROTOBUF),
    )
    yield (
        f"{folder}/config/udp.yaml",
        render("udp.yaml.j2", header=comment, parameters=_parameters(bridge), addresses=_address_parameters(bridge)),
    )


def _parameters(bridge: ir.Bridge) -> dict[str, dict[str, Any]]:
    """Return the declarations of the parameters that the node of a table has, without those of the peers, by name."""
    declared = node_parameters()
    if bridge.link is None:
        return {name: parameter for name, parameter in declared.items() if not parameter.get("of_link")}
    return declared | {"link_policy": {**declared["link_policy"], "default": bridge.link.on_mismatch}}


def _keys(bridge: ir.Bridge) -> dict[str, str]:
    """Return the description of each launch argument that names a key file, without which the bridge cannot start."""
    file = "file with the keys of {0}, which `roverlink link keygen {0}` makes"
    return {f"{peer.name}_keys": file.format(peer.name) for peer in bridge.peers if peer.must_sign}


def _addresses(bridge: ir.Bridge) -> dict[str, str]:
    """Return the description of each launch argument that overrides a parameter, by the parameter's name."""
    described = {name: node_parameters()[name]["description"] for name in _ADDRESSES}
    described |= {name: text for name, (_, text) in _address_parameters(bridge).items()}
    return {name: f"{text} (if empty: the value in params_file)" for name, text in described.items()}


def _address_parameters(bridge: ir.Bridge) -> dict[str, tuple[str | int, str]]:
    """Return default and description of each parameter for the address of a peer or of a board, by its name."""
    found: dict[str, tuple[str | int, str]] = {}
    for peer in bridge.peers:
        for end in peer.ends:
            name = f"{end.name} of {peer.name}" if peer.boards else peer.name
            if end.host:
                found[end.host_parameter] = end.host, f"host of {name}"
            found[end.parameter] = end.port, f"UDP port of {name}"
    return found


def _msg(bridge: ir.Bridge, message: ir.RosMessage) -> str:
    return _definition(message, header(f"{bridge.table} ({message.source})"))


def _srv(bridge: ir.Bridge, service: ir.Service) -> str:
    request = header(f"{bridge.table} ({service.request.source} and {service.response.source})")
    return "---\n".join(map(_definition, (service.request, service.response), (request, "# The response.")))


def _definition(message: ir.RosMessage, header: str) -> str:
    return render(
        "message.msg.j2",
        header=header,
        comment=_comment(message.comment),
        enums=[
            (_heading(message, enum), [(constant, _comment(constant.comment)) for constant in constants])
            for enum, constants in itertools.groupby(message.constants, lambda constant: constant.enum)
        ],
        fields=[(msg_type(field.type), field.name, _comment(field.comment)) for field in message.fields],
    )


def _heading(message: ir.RosMessage, enum: str) -> str:
    """Return the comment above the constants of an enum in a .msg file: ``# Values of state (MotorState).``.

    It names the fields of the message that have the enum's type.
    """
    return f"# Values of {' and '.join(field.name for field in message.fields if field.enum == enum)} ({enum})."


def _comment(text: str) -> list[str]:
    """Return the lines of a comment in a .msg file. Backslashes are escaped for rosidl.

    rosidl copies comments into C headers and decodes backslashes twice. A backslash sequence that rosidl cannot decode
    stops its build. A backslash at the end of a line would make the next line of the header a comment, so a period is
    added.
    """
    lines = [f"{line}." if line.endswith("\\") else line for line in text.splitlines()]
    return ["# " + line.replace("\\", "\\" * 4) if line else "#" for line in lines]

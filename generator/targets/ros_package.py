"""The ROS 2 interface package: its messages, what builds it, and how the bridge is launched."""

from __future__ import annotations

from generator import ir
from generator.targets.conversions import Files
from generator.targets.rendering import header, render


def emit(bridge: ir.Bridge) -> Files:
    """The package's files."""
    folder = f"generated/ros/{bridge.package}"
    for message in bridge.messages:
        yield f"{folder}/msg/{message.name}.msg", _msg(bridge, message)
    names = sorted(message.name for message in bridge.messages)
    comment = header(bridge.table)
    yield f"{folder}/CMakeLists.txt", render(
        "CMakeLists.txt.j2", header=comment, package=bridge.package, messages=names
    )
    xml = header(bridge.table, "<!--", " -->")
    yield f"{folder}/package.xml", render("package.xml.j2", header=xml, package=bridge.package)
    yield f"{folder}/launch/{bridge.package}.launch.py", render("launch.py.j2", header=comment, package=bridge.package)
    yield f"{folder}/config/udp.yaml", render("udp.yaml.j2", header=comment, peers=bridge.peers)


def _msg(bridge: ir.Bridge, message: ir.RosMessage) -> str:
    return render(
        "message.msg.j2",
        header=header(f"{bridge.table} ({message.source})"),
        comment=_comment(message.comment),
        constants=[(constant, _comment(constant.comment)) for constant in message.constants],
        fields=[(_msg_type(field.type), field.name, _comment(field.comment)) for field in message.fields],
    )


def _msg_type(type: ir.RosType) -> str:
    return f"{type.name}[]" if type.is_sequence else type.name


def _comment(text: str) -> list[str]:
    return [f"# {line}".rstrip() for line in text.splitlines()]

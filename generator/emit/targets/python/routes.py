"""The route of a handler, as the arguments of its class's `Route`."""

from __future__ import annotations

import json
from collections.abc import Iterator

from roverlink.generator import ir
from roverlink.generator.emit.targets.python.layout import Group

_RCLCPP_DEFAULT = ir.Qos()


def runtime_names(route: ir.Route) -> list[str]:
    """Return what the arguments need from `roverlink.runtime.core.handler`."""
    names = ["Deadman"] if route.deadman else []
    return [*names, "Route"] if route.qos == _RCLCPP_DEFAULT else [*names, "Qos", "Route"]


def route_arguments(route: ir.Route) -> Iterator[str | Group]:
    """The arguments."""
    yield f"number={route.number}"
    yield f'name="{route.name}"'
    yield f'topic="{route.topic}"'
    yield f'direction="{route.direction}"'
    if route.qos != _RCLCPP_DEFAULT:
        qos, usual = route.qos, _RCLCPP_DEFAULT
        pairs = [
            ("reliability", f'"{qos.reliability}"', qos.reliability != usual.reliability),
            ("durability", f'"{qos.durability}"', qos.durability != usual.durability),
            ("history", f'"{qos.history}"', qos.history != usual.history),
            ("depth", str(qos.depth), qos.depth != usual.depth),
        ]
        yield Group("qos=Qos(", [f"{name}={value}" for name, value, differs in pairs if differs], ")")
    if route.forward:
        peers = [f'"{peer}"' for peer in route.forward]
        yield Group("forward=(", peers, ")") if len(peers) > 1 else f"forward=({peers[0]},)"
    if route.deadman:
        yield _deadman(route.deadman)
    if route.max_rate is not None:
        yield f"max_rate={route.max_rate}"
    if route.priority:
        yield f"priority={route.priority}"
    if route.expect_rate is not None:
        yield f"expect_rate={route.expect_rate}"


def _deadman(deadman: ir.Deadman) -> Group:
    values = [f'"{path}": {_literal(value)}' for path, value in deadman.send]
    times = [f"after_ms={deadman.after_ms}", f"repeat_ms={deadman.repeat_ms}"]
    return Group("deadman=Deadman(", [*times, Group("send={", values, "}")], ")")


def _literal(value: bool | int | float | str | bytes) -> str:
    """A value as black writes it: strings in double quotes, unless the others need fewer escapes."""
    if isinstance(value, bytes):
        return 'b"' + "".join(f"\\x{byte:02x}" for byte in value) + '"'
    if not isinstance(value, str):
        return repr(value)
    inside = json.dumps(value, ensure_ascii=False)[1:-1]
    if value.count('"') <= value.count("'"):
        return f'"{inside}"'
    single = inside.replace("'", r"\'").replace(r"\"", '"')
    return f"'{single}'"

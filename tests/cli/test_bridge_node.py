"""The declaration of the bridge's node, which is made from the table alone, and the bridge itself."""

from __future__ import annotations

from pathlib import Path

from generated.registry import REGISTRY
from roverlink.nodes import USE_SIM_TIME, Direction
from roverlink.nodes.bridge_node import read_table_nodes
from roverlink.runtime.ros_arguments.parameters import declarations

_TABLE = """\
version: 1
proto: {root: proto}
envelope: {file: envelope.proto, message: Envelope, oneof: payload}
ros: {package: probe_msgs}
peers: {drill: {port: 6000, boards: {ArmBoard: {host: 10.0.0.2}, MastBoard: {host: learn}}}, spy: {host: learn}}
messages: []
"""


def test_the_bridge_has_the_declared_topics_and_parameters() -> None:
    """They are those of the registry, which the runtime reads."""
    table = read_table_nodes(Path(__file__).parents[2] / "mapping.yaml")
    assert table
    handlers = (*REGISTRY.handlers, *REGISTRY.extra_topics)
    rows = {(one.route.topic, one.message_type.__msgtype__, one.route.qos, one.route.inbound) for one in handlers}
    declared = {
        (one.name, *one.type_names, one.qos, one.direction is Direction.PUBLISHED) for one in table.bridge.topics
    }
    assert declared == rows
    parameters = {(one.name, one.default, one.read_only) for one in (*table.bridge.parameters, USE_SIM_TIME)}
    assert parameters == {(name, one.default, one.read_only) for name, one in declarations(REGISTRY).items()}


def test_boards_have_addresses_of_their_own(tmp_path: Path) -> None:
    """A board has two parameters in place of its peer's, and a peer without a host only the port."""
    (tmp_path / "mapping.yaml").write_text(_TABLE, encoding="utf-8")
    table = read_table_nodes(tmp_path / "mapping.yaml")
    assert table
    names = [one.name for one in table.bridge.parameters if one.name.startswith(("drill", "spy"))]
    assert names == [
        *("drill_arm_board_port", "drill_arm_board_host", "drill_mast_board_port", "drill_mast_board_host"),
        *("spy_port", "spy_host"),
    ]


def test_a_table_that_cannot_be_read_has_no_bridge(tmp_path: Path) -> None:
    """Other commands say what is wrong with it."""
    (tmp_path / "mapping.yaml").write_text("version: [", encoding="utf-8")
    assert read_table_nodes(tmp_path / "mapping.yaml") is None

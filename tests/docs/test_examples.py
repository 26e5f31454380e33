"""The examples of the documentation: what they show is what the programs read, print and write."""

from __future__ import annotations

import doctest
import math
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from subprocess import PIPE, Popen
from typing import Any

import pytest
from bridge_rig import Rig, end, of_peers
from case_file import usual_table
from needs import NO_OPENCV, needs_dds
from page import ROOT, blocks
from polling import PATIENCE_S, wait_until
from repeating import repeated

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.generator.pipeline import compile_table
from roverlink.runtime import Registry, load_registry
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import NodeIdentity, open_middleware

_DOCS, _DOCS_OF_ROVERKIT = ROOT / "docs", ROOT / "rover" / "docs"
_NEEDS_OPENCV = pytest.mark.skipif(not find_spec("cv2"), reason=NO_OPENCV)
_TABLE = usual_table("ros: {package: probe_msgs}\npeers: {drill: {}}\nmessages:\n")


def test_the_session_with_a_handler_runs() -> None:
    """Python prints what it shows."""
    page = _DOCS / "targets.md"
    section = blocks(page, "Use the handlers in your own node")
    (code,) = (block.text for block in section if block.language == "pycon")
    test = doctest.DocTestParser().get_doctest(code, {}, page.name, str(page), 0)
    runner = doctest.DocTestRunner()
    runner.run(test)
    assert (runner.failures, runner.tries) == (0, len(test.examples))


@pytest.mark.slow
@needs_dds
def test_the_node_of_the_page_prints_what_arrives(
    environment: dict[str, str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """It runs as it stands, hears another node, and ends at Enter."""
    for name in ("ROS_DOMAIN_ID", "ROS_LOCALHOST_ONLY"):
        monkeypatch.setenv(name, environment[name])
    (code,) = (one.text for one in blocks(_DOCS / "targets.md") if one.language == "python" and "input(" in one.text)
    handler, node, log = REGISTRY.by_name["imu_info"], NodeIdentity("imu"), tmp_path / "output"
    with (
        log.open("w") as output,
        Popen([sys.executable, "-c", code], stdin=PIPE, stdout=output, env=environment, cwd=ROOT, text=True) as program,
        open_middleware("dds", node) as middleware,
    ):
        publisher = middleware.publisher(node.topic("imu_data"), handler.message_type, handler.route.qos)
        message = handler.to_cdr(handler.payload_type(accel_x=0.5))
        with repeated(lambda _: publisher.publish([message])):
            wait_until(lambda: "accel_x 0.5" in log.read_text() or program.poll() is not None, "a printed message")
        program.communicate("\n", PATIENCE_S)
    assert (program.returncode, "accel_x 0.5\n" in log.read_text()) == (0, True)


@pytest.mark.parametrize(
    ("page", "section", "message", "row", "others"),
    [
        ("conversions.md", "", "Survey", "presence: {started: true}", {"Bytes", "SurveyDepthsEntry"}),
        ("mapping.md", "What a proto construct becomes", "ProbeReport", "queue: 10", {"ProbeReportLayer"}),
    ],
)
def test_a_proto_becomes_the_message_beside_it(
    page: str, section: str, message: str, row: str, others: set[str], tmp_path: Path
) -> None:
    """The proto on the page becomes the message on the page, and those that it names."""
    shown = {block.language: block.text for block in reversed(blocks(_DOCS / page, section))}  # the first of each
    (tmp_path / "proto").mkdir()
    (tmp_path / "proto" / "one.proto").write_text(shown["proto"], encoding="utf-8")
    row = f"  - {{number: 1, name: one, proto: {message}, topic: one, direction: drill_to_ros, {row}}}\n"
    (tmp_path / "mapping.yaml").write_text(_TABLE + row, encoding="utf-8")
    files = compile_table(tmp_path / "mapping.yaml").files
    written = files[f"generated/ros/probe_msgs/msg/{message}.msg"]
    assert written.endswith(f"\n{shown['text']}")
    assert {Path(path).stem for path in files if path.endswith(".msg")} == {message, *others}


@_NEEDS_OPENCV
def test_the_mission_of_the_page_can_be_read(tmp_path: Path) -> None:
    """With the landmarks of the page about markers."""
    from roverkit.mission.mission_file import read_mission

    (mission,) = (
        one.text for one in blocks(_DOCS_OF_ROVERKIT / "navigation.md") if one.text.startswith("# mission.yaml")
    )
    (tmp_path / "mission.yaml").write_text(mission)
    (tmp_path / "landmarks.yaml").write_text((_DOCS_OF_ROVERKIT / "vision" / "landmarks.yaml").read_text())
    assert len(read_mission(tmp_path / "mission.yaml").goals) == 3


@_NEEDS_OPENCV
def test_the_files_of_the_page_about_cameras_are_read(tmp_path: Path) -> None:
    """The landmarks, boards and cameras that the pages about markers show are taken as they stand."""
    from roverkit.vision import read_landmarks
    from roverkit.vision.camera.cameras_file import read_cameras
    from roverkit.vision.markers.boards import read_boards

    shown = [*blocks(_DOCS_OF_ROVERKIT / "vision.md"), *blocks(_DOCS_OF_ROVERKIT / "vision-reference.md")]
    for text in (block.text for block in shown if block.language == "yaml"):
        (tmp_path / text.partition("\n")[0].removeprefix("# ")).write_text(text, encoding="utf-8")
    assert set(read_landmarks(tmp_path / "landmarks.yaml").places) == {7, "gate"}
    assert [board.name for board in read_boards(tmp_path / "boards.yaml")] == ["gate"]
    assert [camera.name for camera in read_cameras(tmp_path / "cameras.yaml")] == ["front", "left"]


@pytest.mark.slow
def test_the_request_of_the_page_is_answered(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], free_port: int, free_udp_ports: Sequence[int]
) -> None:
    """The table and the protos of the page make the service type beside them, and the client prints the response."""
    shown = {block.language: block.text for block in blocks(_DOCS / "operations.md", "Requests that are answered")}
    # A process can load two projects only if no .proto file has the same name.
    envelope = "envelope: {file: on_the_page/envelope.proto, message: on_the_page.Envelope, oneof: payload}\n"
    table = usual_table(f"{envelope}python: {{package: requests_of_the_page}}\n{shown['yaml']}")
    for path, text in (("mapping.yaml", table), ("proto/rocks.proto", shown["proto"])):
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(text, encoding="utf-8")
    assert main(["generate", "--table", str(tmp_path / "mapping.yaml")]) == 0
    assert main(["explain", "grip", "--table", str(tmp_path / "mapping.yaml")]) == 0
    told = capsys.readouterr().out
    assert "request    answered by gripped, with the same order" in told
    assert "request    service grip (rover/srv/Grip)" in told
    written = (tmp_path / "requests_of_the_page/ros/rover/srv/Grip.srv").read_text(encoding="utf-8")
    assert [line for line in written.splitlines() if line and line[0] != "#"] == shown["text"].splitlines()
    with Rig(load_registry(tmp_path, "requests_of_the_page")) as rig:
        asked, answer = rig.registry.by_name["measure"], rig.registry.by_name["measured"]
        publisher = rig.node.publisher("/rock_measured", answer.message_type, answer.route.qos)

        def measure(messages: Sequence[bytes]) -> None:
            request = asked.from_cdr(messages[0])
            length = math.hypot(request.x2 - request.x1, request.y2 - request.y1)
            publisher.publish([answer.to_cdr(answer.payload_type(request_id=request.request_id, length_cm=length))])

        rig.node.subscribe("/rock_measure", asked.message_type, asked.route.qos, measure)
        port = free_udp_ports[0]
        rig.live.change({rig.registry.peers_by_name["base"].port_parameter: port})
        where = f'host="127.0.0.1", port={rig.bridge.port}, local_port={port}, registry=registry'
        code = shown["python"].replace("generated.", "requests_of_the_page.").replace("host=host", where)
        exec(code, {"registry": rig.registry})  # noqa: S102  # it stands on our own page
    assert capsys.readouterr().out == "40.2 cm\n"
    command = shown["console"].removeprefix("$ roverlink ").split()
    _is_answered_by_a_simulated_board(rig.registry, tmp_path, command, f"tcp:127.0.0.1:{free_port}")


def _is_answered_by_a_simulated_board(registry: Registry, project: Path, command: list[str], line: str) -> None:
    """A call of the service ends when the command of the page plays the board, here at the other end of a line."""
    grip, responses = registry.by_name["grip"], list[Any]()
    service = grip.route.request.service
    with Rig(of_peers(registry, board=end("board", f"{line}?listen"))) as rig:
        request = cdr.encode(service.request(force=0.5))
        assert rig.node.client("/grip", service).call(request, responses.append)
        where = [line if ":" in word else word for word in command]
        assert main([*where, "--project", str(project), "--seconds", "2"]) == 0
        assert [cdr.decode(service.response, one).error for one in responses] == [""]
        assert rig.account.published["gripped"] == 1

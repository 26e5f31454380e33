"""``roverlink fuse``: bad input, and a drive over DDS."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from needs import NO_GTSAM, NO_OPENCV, needs_dds
from polling import wait_until
from programs import Start

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("gtsam", reason=NO_GTSAM)

from roverlink.__main__ import main
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.runtime.text.values import message_to_values
from tests.fusion_loop import TOPICS, fuse_a_drive


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--landmarks", "missing.yaml"), "missing.yaml"),
        (("--landmarks", "bad.yaml"), "bad.yaml:1:"),
        (("--landmarks", "bad.yaml", "--datum", "50", "x", "0"), "'x' is not a finite number"),
    ],
)
def test_bad_input_is_exit_code_2(
    words: tuple[str, ...],
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A message names the file or the option."""
    monkeypatch.chdir(tmp_path)
    Path("bad.yaml").write_text("landmarks: 7\n", encoding="utf-8")
    try:
        code = main(["fuse", *words, "--middleware", "memory"])
    except SystemExit as end:  # of argparse
        code = end.code  # type: ignore[assignment]
    assert code == 2
    errors = capsys.readouterr().err
    assert told in errors
    assert "Traceback" not in errors


@needs_dds
@pytest.mark.slow
def test_a_drive_over_dds(
    start: Start, environment: dict[str, str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The program finds where the rover is, and ends with Ctrl-C."""
    for name in ("ROS_DOMAIN_ID", "ROS_LOCALHOST_ONLY"):
        monkeypatch.setenv(name, environment[name])
    with open_middleware("dds", NodeIdentity("rover")) as node:
        heard: list[bytes] = []
        node.subscribe("/odometry/global", Odometry, Qos(depth=1000), heard.extend)
        publishers = {topic: node.publisher(topic, kind, Qos(depth=1000)) for topic, kind in TOPICS.items()}

        def send(topic: str, data: bytes) -> None:
            wait_until(publishers[topic].has_subscribers, f"a subscriber of {topic}")
            publishers[topic].publish([data])
            time.sleep(0.005)  # as sensors do, and not all at once: the program keeps the newest ten

        fuse_a_drive(
            start, "dds", tmp_path, send, lambda: [message_to_values(cdr.decode(Odometry, data)) for data in heard]
        )

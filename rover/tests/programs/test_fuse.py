"""``roverlink fuse`` whose callback fails: a fault of ours, which no input should cause."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import pytest
from needs import NO_GTSAM, NO_OPENCV, needs_dds
from repeating import repeated
from running import Called

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("gtsam", reason=NO_GTSAM)

from roverkit.fusion import fusing

from rover.tests.driving.simulated_tracker import write_field
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.middleware import NodeIdentity, open_middleware


@needs_dds
def test_an_exception_in_a_callback_ends_the_program(
    called: Called, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It does not go on without poses: its exit code is 2, and it names the thread and the error."""

    def fails(_: Odometry) -> None:
        raise ZeroDivisionError("of the test")

    monkeypatch.setattr(fusing, "point_of", fails)
    landmarks, _ = write_field(tmp_path, "front")
    with ExitStack() as held:
        node = held.enter_context(open_middleware("dds", NodeIdentity("odometry")))
        publisher = node.publisher("/odometry/wheel", Odometry, Qos())
        held.enter_context(repeated(lambda _: publisher.publish([cdr.encode(Odometry())]), 0.05))
        code, _, errors = called("fuse", "--landmarks", landmarks, "--middleware", "dds")
    assert code == 2
    assert "ZeroDivisionError: of the test" in errors
    assert "Traceback" not in errors

"""How the tests of the command line run `roverlink`: in this process where that will do, or as a bridge."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path

from programs import Program

from generated.registry import REGISTRY
from roverlink.__main__ import main

Bridge = Callable[..., tuple[Program, int]]
"""The fixture `bridge`: starts a bridge with options; the program, and its UDP port as soon as it listens there."""


Called = Callable[..., tuple[int, str, str]]
"""The fixture `called`: runs `roverlink` in this process; its exit code, standard output and standard error."""


def exit_code(*arguments: object) -> int:
    """The exit code of `roverlink` with arguments in this process, also where argparse ends it."""
    try:
        return main([*map(str, arguments)])
    except SystemExit as end:
        return int(str(end.code))


def record_one_message(path: Path) -> Path:
    """Write a recording of one message on /imu_data, and return its path."""
    from roverlink.runtime.recording.recorder import Recorder  # here: the environments of tests/ros2 have no MCAP

    handler = REGISTRY.by_name["imu_info"]
    with Recorder(path, REGISTRY, {"/imu_data": "imu_info"}, logging.getLogger("run")) as recorder:
        recorder.topic("/imu_data", handler.message_type, handler.route.qos)([handler.to_cdr(handler.payload_type())])
    return path

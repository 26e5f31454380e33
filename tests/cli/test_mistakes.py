"""A command that cannot do what its line says tells what is wrong: one line, exit code 2, and nothing is written."""

from __future__ import annotations

import argparse
import os
import re
import shlex
import shutil
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from golden import PROBE_PROTO, PROBE_TABLE, generate
from needs import NO_AV, NO_DDS, NO_FOXGLOVE, NO_ONNX, NO_OPENCV
from running import exit_code, record_one_message

from roverlink.command_line import command_line

_HERE = Path(__file__).parent
_ROOT = Path(__file__).parents[2]
_FILES_OF_CASES = [_HERE / "mistakes.txt", _ROOT / "rover" / "tests" / "programs" / "mistakes.txt"]
_CASES = [
    line.split(" | ")
    for file in _FILES_OF_CASES
    for line in file.read_text(encoding="utf-8").splitlines()
    if line and not line.startswith("#")
]
_IN_THE_FOLDER = {"aruco", "link", "objects", "video"}
"""Commands that need no project; their lines name the files without a folder."""
_NEEDED = {
    "aruco": (NO_OPENCV, ["cv2"]),
    "fuse": (NO_OPENCV, ["cv2", "gtsam"]),
    "objects": (NO_ONNX, ["cv2", "onnx", "onnxruntime"]),
    "rocks": (NO_OPENCV, ["cv2"]),
    "video": (NO_AV, ["cv2", "av"]),
}
_FILES = {
    "params.yaml": "udp_forwarder: {ros__parameters: {listen_prt: 5000}}",
    "seven.yaml": "landmarks: 7\n",
    "boards.yaml": "boards: {gate: {side: 0.15, markers: {7: {position: [0, 0, 0], rpy: [0, 0, 0]}}}}",
    "wall.yaml": "landmarks: {wall: {position: [0, 0, 0], rpy: [0, 0, 0]}}",
    "bare.yaml": "cameras: {front: {source: images}}",
    "video.yaml": "host: 127.0.0.1\nstreams:\n  front: {source: images, port: 4500}\n",
    "drive.mp4": "a recording",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The files that the lines name."""
    folder = tmp_path_factory.mktemp("mistakes")
    for name in ("empty", "images"):
        (folder / name).mkdir()
    for name, text in _FILES.items():
        (folder / name).write_text(text, encoding="utf-8")
    record_one_message(folder / "run.mcap")
    (folder / "small" / "proto").mkdir(parents=True)
    (folder / "small" / "proto" / "probe.proto").write_text(PROBE_PROTO, encoding="utf-8")
    (folder / "small" / "mapping.yaml").write_text(PROBE_TABLE, encoding="utf-8")
    assert generate(folder / "small").code == 0
    return folder


@pytest.fixture(scope="module")
def ports() -> Iterator[dict[str, str]]:
    """A UDP port and a TCP port that another program has."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp, socket.create_server(("127.0.0.1", 0)) as tcp:
        udp.bind(("127.0.0.1", 0))
        yield {"@port": str(udp.getsockname()[1]), "@tcp": str(tcp.getsockname()[1])}


def _write_pictures(folder: Path) -> None:
    """Write the images and the files of the camera; this needs OpenCV."""
    import cv2
    import numpy as np
    from roverkit.demo.field import write_cameras, write_field

    cv2.imwrite(str(folder / "images" / "0.png"), np.full((480, 640, 3), 128, np.uint8))
    write_field(folder)
    write_cameras(folder, {"source": "images"})


def _need(command: str, folder: Path) -> None:
    """Skip the test if a package of the command is missing; write the images and the files of the camera."""
    reason, packages = _NEEDED.get(command, ("", []))
    for package in packages:
        pytest.importorskip(package, reason=reason)
    if packages and not (folder / "camera.yml").exists():
        _write_pictures(folder)


@pytest.mark.parametrize(("line", "expected"), _CASES, ids=[line for line, _ in _CASES])
def test_a_line_that_cannot_be_obeyed_is_told(
    line: str,
    expected: str,
    folder: Path,
    ports: dict[str, str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The message quotes what is wrong; where the line itself is wrong, the command that shows the usage is named."""
    command = line.partition(" ")[0]
    _need(command, folder)
    if "--foxglove" in line:
        pytest.importorskip("foxglove", reason=NO_FOXGLOVE)
    if "--pipeline" in line and shutil.which("gst-launch-1.0") is None:
        pytest.skip("need GStreamer (apt-get install gstreamer1.0-tools)")
    side = "--side 0.15 --landmarks landmarks.yaml"
    given = {"@images": f"images --parameters camera.yml {side} --rate 10 --json", "@side": side}
    given |= {"@/": f"{folder}/", "@long": 70 * "a", "@deep": 3000 * "[", "@digits": 5000 * "9", **ports}
    for name, text in given.items():
        line, expected = line.replace(name, text), expected.replace(name, text)
    monkeypatch.setenv("ROS_DOMAIN_ID", "1")  # which the demo sets for itself
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    monkeypatch.chdir(folder if command in _IN_THE_FOLDER else _ROOT)
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    assert exit_code(*shlex.split(line)) == 2
    output, errors = capsys.readouterr()
    if "Cyclone DDS cannot be imported" in errors:
        pytest.skip(NO_DDS)
    told, *others = [text for text in errors.splitlines() if text.startswith("roverlink")]
    assert expected in told
    assert output == ""
    assert others == []
    assert told.startswith("roverlink: ") or re.search(
        r"\nrun `roverlink.* --help` for all arguments$", errors.rstrip()
    )
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


_PATHS = [
    f"{command} {option}"
    for line in (_HERE / "bad_paths.txt").read_text(encoding="utf-8").splitlines()[1:]
    for command, *options in [line.split(" | ")]
    for option in options
]
_BAD_FILES = {
    "nul.yaml": b'landmarks: "a\\0b"\n',
    "brackets.yaml": b"[" * 5000,
    "digits.yaml": b"a: " + b"1:" * 5000 + b"1",
    "binary": b"\xff\0\x80" * 100,
}


@pytest.fixture(scope="module")
def bad_paths(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[str]]:
    """Paths that cannot be written, and paths that cannot be read."""
    folder = tmp_path_factory.mktemp("bad")
    for name, data in _BAD_FILES.items():
        (folder / name).write_bytes(data)
    (folder / "loop").symlink_to("loop")
    os.mkfifo(folder / "pipe")
    with (folder / "huge").open("wb") as file:
        file.truncate(1 << 40)  # it has no blocks on the disk
    nowhere = ["n" * 300, f"{folder}/binary/x"]
    no_folder = [*nowhere, f"{folder}/loop", f"{folder}/pipe"]
    return {
        "@out": nowhere,
        "@dir": no_folder,
        "@in": no_folder + [f"{folder}/{name}" for name in ("huge", *_BAD_FILES)],
    }


@pytest.mark.parametrize("line", _PATHS)
def test_a_path_that_nobody_can_use_is_told(
    line: str,
    folder: Path,
    bad_paths: dict[str, list[str]],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Whatever the file is, no command ends with a traceback, or waits, or takes all the memory."""
    command = line.partition(" ")[0]
    _need(command, folder)
    monkeypatch.chdir(_ROOT)
    (mark,) = {"@in", "@dir", "@out"}.intersection(line.split())
    line = " ".join(str(folder / word) if (folder / word).exists() else word for word in line.split())
    for path in bad_paths[mark]:
        assert exit_code(*line.replace(mark, path).split()) in (1, 2), path
        assert "".join(capsys.readouterr()), path


def _with_paths(parser: argparse.ArgumentParser, words: str = "") -> Iterator[str]:
    """The commands that take a path; those of a group are below it."""
    if any(action.type is Path for action in parser._actions):
        yield words
    for group in parser._actions:
        if isinstance(group, argparse._SubParsersAction):
            for name, below in group.choices.items():
                yield from _with_paths(below, f"{words}{name} ")


def test_every_command_that_takes_a_path_is_walked() -> None:
    """A new command needs a line in bad_paths.txt."""
    assert [
        words for words in _with_paths(command_line()) if words not in {f"{line} "[: len(words)] for line in _PATHS}
    ] == []


@pytest.mark.parametrize("debug", ["", "1"])
def test_the_traceback_is_shown_on_request(
    debug: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The line stands at the end in any case; without the variable, it is alone."""
    monkeypatch.setenv("ROVERLINK_DEBUG", debug)
    assert exit_code("recording", "info", "a\0b") == 2
    errors = capsys.readouterr().err
    assert (errors.count("\nroverlink: ") + errors.startswith("roverlink: "), "Traceback" in errors) == (1, bool(debug))

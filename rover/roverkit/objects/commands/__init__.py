"""``roverlink objects``: commands about detected objects, one module each."""

from __future__ import annotations

from roverlink.console import Subparsers, command_group


def add(commands: Subparsers) -> None:
    """Add ``objects`` with its subcommands to the command line."""
    command_group(
        commands,
        "objects",
        "detect objects in camera images, locate the selected one, train detectors",
        "roverlink objects track topic:/camera/camera/color/image_raw --model rocks.onnx",
        "Detect and track objects in camera images, and locate the one that the operator selects.\n"
        "They need OpenCV: pip install 'opencv-contrib-python-headless>=4.8', and track needs ONNX Runtime and SciPy:\n"
        "pip install 'onnxruntime>=1.17' 'scipy>=1.11'.",
        __name__,
        ("track", "select", "train", "measure", "render_scenes"),
    )

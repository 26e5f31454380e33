"""The part of `tests/ros/build.py` that is about the target cpp: its project of CMake in a package of a workspace.

The package, called ``node``, has three programs: `speaker.cpp`, the example of docs/targets.md, and its node for rclcpp
with a stand-in for that.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

_HERE = Path(__file__).parent
ROOT = _HERE.parents[2]
sys.path.insert(0, str(_HERE))

from roverlink.generator.ir.model import Bridge  # noqa: E402
from roverlink.generator.pipeline import compile_table  # noqa: E402

_EXAMPLES = re.compile(r"^```cpp\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_NODE = """
void Bridge::send(const roverlink::Route & route, const PBEnvelope & envelope)
{
  std::printf("%s %zu\\n", route.direction, envelope.SerializeAsString().size());
}

int main()
{
  Bridge bridge;
  PBEnvelope envelope;
  envelope.mutable_imu_info();
  const std::string datagram = envelope.SerializeAsString();
  bridge.receive(datagram.data(), datagram.size());
  for (const auto & [topic, count] : rclcpp::published) {
    std::printf("%s %d\\n", topic.c_str(), count);
  }
  using Message = comms::msg::DrivingBoardMotorMessage;
  using Subscriber = std::function<void (std::shared_ptr<const Message>)>;
  const auto message = std::make_shared<Message>();
  message->distance_to_go = 1.0;
  std::any_cast<Subscriber>(rclcpp::subscribers.at("drive_motor"))(message);
}
"""
_SAID = {
    "example": [
        *("published on imu_data", "published on imu/data_raw", "published on imu/mag", "9.5", "4 handlers took it"),
        "7 bytes for a board",
    ],
    "node": ["imu/data_raw 1", "imu/mag 1", "imu_data 1", "ros_to_hardware 7"],
}
"""What the programs print."""


def write_library(folder: Path) -> Bridge:
    """What the target cpp makes of this project's table, below a folder."""
    compiled = compile_table(ROOT / "mapping.yaml", ["cpp"])
    for path, text in compiled.files.items():
        if path.startswith("generated/cpp/"):
            target = folder / path.removeprefix("generated/cpp/")
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
    return compiled.bridge


def cmake(library: Path, bridge: Bridge) -> str:
    """What CMake is told of the programs."""
    package, envelope = bridge.package, bridge.envelope.file.removesuffix(".proto")
    speaker = f"REGISTRY=<{package}/registry.hpp> PACKAGE={package} ENVELOPE=::PBEnvelope"
    return (
        "find_package(ament_cmake REQUIRED)\n"
        f'set(PROTO_ROOT "{ROOT / "proto"}")\n'
        f'add_subdirectory("{library}" handlers)\n'
        f"target_compile_options({package}_handlers PRIVATE -Wall -Wextra)\n"
        # Most of what a file reads is protobuf's. Our own headers are not here: each file has to name those it needs.
        f"target_precompile_headers({package}_handlers PRIVATE <{envelope}.pb.h> <fastcdr/Cdr.h>)\n"
        "foreach(name speaker example node)\n"
        "  add_executable(${name} ${name}.cpp)\n"
        f"  target_link_libraries(${{name}} {package}_handlers fastcdr)\n"
        "  install(TARGETS ${name} DESTINATION lib/${PROJECT_NAME})\n"
        "endforeach()\n"
        f'target_compile_definitions(speaker PRIVATE {speaker})\ntarget_include_directories(node PRIVATE "{_HERE}")\n'
    )


def write_programs(folder: Path) -> None:
    """The sources of the programs."""
    example, node = _EXAMPLES.findall((ROOT / "docs" / "targets.md").read_text(encoding="utf-8"))
    (folder / "example.cpp").write_text(example, encoding="utf-8")
    (folder / "node.cpp").write_text(node + _NODE, encoding="utf-8")
    (folder / "speaker.cpp").symlink_to(_HERE / "speaker.cpp")


def differences(programs: Path, environment: Mapping[str, str]) -> Iterator[str]:
    """Where the programs do not say what they should, and where the handlers are not what Python's are."""
    from comparing import Speaker, compare  # which wants hypothesis

    from generated.registry import REGISTRY

    for name, wanted in _SAID.items():
        said = subprocess.run([programs / name], env=dict(environment), capture_output=True, text=True, check=True)
        if said.stdout.splitlines() != wanted:
            yield f"{name} said {said.stdout!r}, and not {wanted}"
    speaker = Speaker(programs / "speaker", environment)
    try:
        count = compare(speaker, REGISTRY, [], examples=100)
        speaker.close()
        print(f"{count} answers of the C++ handlers are those of the Python handlers")
    except AssertionError as error:
        yield f"the C++ handlers differ from the Python handlers: {error}"

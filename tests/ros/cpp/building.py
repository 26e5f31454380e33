"""Compiles the target cpp's handlers with what the system has: protoc, rosidl's generators, a C++ compiler.

No CMake and no colcon, which would take ten times as long; `tests/ros/build.py` goes that way once.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from graphlib import TopologicalSorter
from pathlib import Path

from rosbags.typesys import Stores, get_typestore

from roverlink.generator.ir.model import Bridge

sys.path.insert(0, str(Path(__file__).parents[2]))
from protobuf_cpp import in_one_file

_HERE = Path(__file__).parent
_SYSTEM_PYTHON = "/usr/bin/python3"  # which has rosidl's modules
_RUNTIME = "generated/cpp/roverlink/"
_HANDLE = re.compile(r"get_message_type_support_handle<([\w:]+)>")
_WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]


def missing() -> list[str]:
    """What is not installed of what `build` needs."""
    wanted = ["/usr/bin/g++", "/usr/bin/protoc", "/usr/include/fastcdr/Cdr.h", "/usr/include/google/protobuf/message.h"]
    modules = ["rosidl_generator_cpp", "rosidl_typesupport_introspection_cpp", "rosidl_adapter"]
    found = subprocess.run([_SYSTEM_PYTHON, "-c", f"import {', '.join(modules)}"], capture_output=True).returncode == 0
    return [*(path for path in wanted if not Path(path).exists()), *([] if found else modules)]


def build(bridge: Bridge, files: Mapping[str, str], protos: Path, folder: Path, *, jazzy: bool = False) -> Path:
    """The program of `speaker.cpp` for a table's handlers, made in a folder."""
    texts = {
        f"{bridge.package}/{Path(path).stem}": text for path, text in files.items() if path.endswith(".msg")
    } | _standard(bridge, jazzy=jazzy)
    generated = folder / "rosidl"
    generated.mkdir(parents=True)
    _run([_SYSTEM_PYTHON, _HERE / "rosidl_generates.py", generated], input=json.dumps(texts))
    ours = [path for path in files if path.startswith("generated/cpp/")]
    for path in ours:
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(files[path], encoding="utf-8")
    compiled = folder / "protos"
    compiled.mkdir()
    names = sorted(bridge.modules)
    _run(["/usr/bin/protoc", f"--proto_path={protos}", f"--cpp_out={compiled}", *names])
    runtime = [folder / _RUNTIME / part for part in ("include", "c")]
    options = [f"-I{part}" for part in (folder / "generated/cpp/include", *runtime, compiled, generated / "include")]
    options += [f"-I{path}" for path in Path("/usr/include").glob("rosidl*")]
    structs = _in_one(folder / "structs.cpp", _held_first(sorted(generated.rglob("*__type_support.cpp"))))
    speaker = [
        f"-DREGISTRY=<{bridge.package}/registry.hpp>",
        f"-DPACKAGE={bridge.package}",
        f"-DENVELOPE=::{bridge.envelope.message.replace('.', '::')}",
    ]
    every = _in_one(folder / "every.hpp", [Path(bridge.package) / "registry.hpp"])
    _object(folder / "every.hpp.gch", every, [*options, *_WARNINGS])  # precompiled: reading it takes most of the time
    included = [*options, "-include", every]
    protos_in_one = in_one_file(folder / "protos.cpp", sorted(compiled.rglob("*.pb.cc")))
    jobs = [(structs, options), (protos_in_one, included), (_HERE / "speaker.cpp", [*included, *speaker])]
    sources = sorted(folder / path for path in ours if path.endswith(".cpp") and not path.startswith(_RUNTIME))
    alone = [source for source in sources if source.parent.name == "extra_topics"]  # each has functions of its own
    alone.append(_in_one(folder / "handlers.cpp", [source for source in sources if source not in alone]))
    alone.append(_in_one(folder / "runtime.cpp", sorted((folder / _RUNTIME / "src").glob("*.cpp"))))
    jobs += [(source, [*included, *_WARNINGS]) for source in alone]
    jobs += [(source, [*options, *_WARNINGS]) for source in sorted((folder / _RUNTIME / "c").glob("*.c"))]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        objects = list(pool.map(lambda job: _object(folder / f"{job[0]}.o", *job[1]), enumerate(jobs)))
    program = folder / "speaker"
    libraries = ["-lrosidl_typesupport_introspection_cpp", "-lrosidl_runtime_c", "-lprotobuf", "-lfastcdr"]
    _run(["/usr/bin/g++", "-o", program, *objects, *libraries])
    return program


def _in_one(made: Path, sources: Iterable[Path]) -> Path:
    """A source file of many, which saves reading their headers many times."""
    made.write_text("".join(f'#include "{source}"\n' for source in sources), encoding="utf-8")
    return made


def _object(made: Path, source: Path, options: list[str]) -> Path:
    _run(["/usr/bin/g++", "-std=c++17", "-O0", "-c", "-o", made, *options, source])
    return made


def _standard(bridge: Bridge, *, jazzy: bool) -> dict[str, str]:
    """The texts of the standard messages that the handlers need."""
    names = {interface.name for interface in bridge.interfaces}
    names |= {f"builtin_interfaces/msg/{name}" for name in ("Time", "Duration")}
    return {name.replace("/msg/", "/"): standard_text(name, jazzy=jazzy) for name in sorted(names)}


def standard_text(name: str, *, jazzy: bool = False) -> str:
    """The .msg of a standard message, as rosbags has it."""
    store = get_typestore(Stores.ROS2_JAZZY if jazzy else Stores.ROS2_HUMBLE)
    text, _ = store.generate_msgdef(name, ros_version=2)
    text = text.partition("\n====")[0] + "\n"
    if name == "geometry_msgs/msg/Quaternion":  # rosbags leaves out defaults; of those this alone is not zero
        text = text.replace("float64 w", "float64 w 1")
    return text


def _held_first(sources: list[Path]) -> Iterable[Path]:
    """The introspections of structs, each behind those of the structs in it."""
    texts = {source: source.read_text(encoding="utf-8") for source in sources}
    own = {_HANDLE.findall(text)[-1]: source for source, text in texts.items()}
    held = {source: {own[name] for name in _HANDLE.findall(text)} - {source} for source, text in texts.items()}
    return TopologicalSorter(held).static_order()


def _run(command: list[str | Path], input: str | None = None) -> None:
    done = subprocess.run(command, input=input, capture_output=True, text=True)
    if done.returncode:
        raise AssertionError(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")

"""Build the ROS 2 packages with ROS 2's own tools, as Debian packages them, and use what comes out: `make ros-package`.

A workspace in build/ros-package gets the interface package and the package of launch files, two packages that stand in
for what Debian does not have, the standard interfaces that the first one depends on, and a package that converts its
messages in C++. `colcon build` builds it; then these programs must give what the Python handlers give, and the others
are started as `ros2 run` would, with the links of `--symlink-install`. The package with a vendored runtime is built
without the project and moved; its bridge must run with the system's Python and its own native core. In a shell in which
ROS 2 is sourced, its parts are taken from there; from Iron on, its type hashes must be those of the generated Python.

Exit code 0: it builds, and all of that holds; 1: it does not; 2: a tool is missing.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).parents[2]
sys.path[:0] = map(str, (ROOT, ROOT / "tests", Path(__file__).parent / "cpp"))

import workspace  # noqa: E402  # the folders above are not on the path of a script
from building import standard_text  # noqa: E402
from default_signals import restore_default_signals  # noqa: E402
from polling import PATIENCE_S  # noqa: E402

import generated.messages  # noqa: E402
from generated.registry import REGISTRY  # noqa: E402
from roverlink.generator.pipeline import compile_table  # noqa: E402
from roverlink.runtime.core.messages import Message  # noqa: E402
from roverlink.runtime.native.core import REINSTALL  # noqa: E402

_WORKSPACE = ROOT / "build" / "ros-package"
_SYSTEM_PYTHON = "/usr/bin/python3"  # which has rosidl's modules
_DEBIAN = Path(__file__).with_name("debian-packages")
_OF_ROS = ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH", "PYTHONPATH", "ROS_DISTRO", "ROS_VERSION")
_SOURCED = "AMENT_PREFIX_PATH" in os.environ
_WITHOUT_ROS = frozenset({"ament_cmake", "launch", "launch_ros", "rosidl_default_generators", "rosidl_default_runtime"})
_NAVIGATION = "rtt_slam"
_LIST = """
import argparse, sys
from colcon_core.package_discovery import add_package_discovery_arguments, discover_packages
from colcon_core.package_identification import get_package_identification_extensions
parser = argparse.ArgumentParser()
add_package_discovery_arguments(parser)
arguments = parser.parse_args(["--base-paths", sys.argv[1]])
print(*(one.name for one in discover_packages(arguments, get_package_identification_extensions())))
"""
"""What `colcon list --names-only --base-paths FOLDER` does, which Debian's colcon lacks."""


def main() -> int:
    """Build, and hold what came out against the generated Python."""
    restore_default_signals()
    if missing := _missing():
        cure = f"apt-get install {' '.join(_DEBIAN.read_text().split())}"
        print(f"missing: {', '.join(missing)}; on Debian 12: {cure}", file=sys.stderr)
        return 2
    sources = _WORKSPACE / "src"
    shutil.rmtree(sources, ignore_errors=True)
    sources.mkdir(parents=True)
    if not _SOURCED:
        _write_defaults(sources)
    package = ROOT / "generated" / "ros" / REGISTRY.package
    (sources / REGISTRY.package).symlink_to(package)
    (sources / _NAVIGATION).symlink_to(ROOT / "rover" / "navigation")
    if not _SOURCED:
        _write_node(sources, _write_standards(sources, _interfaces(package)))
    if not _colcon(sources, os.environ, "--symlink-install"):
        return 1
    environment = _sourced(_WORKSPACE / "install")
    ours = {**environment, "PATH": f"{Path(sys.executable).parent}:{environment['PATH']}"}
    faults = [*_other_packages(), *_other_hashes(), *_does_not_run(ours)]
    faults += _is_not_navigation(environment)
    faults += _does_not_stand_alone(sources / REGISTRY.package, package)
    if not _SOURCED:
        faults += workspace.differences(_WORKSPACE / "install" / "node" / "lib" / "node", environment)
    print("\n".join(faults) or f"{REGISTRY.package} builds, and does what Python does")
    return 1 if faults else 0


def _missing() -> list[str]:
    """The tools that are not installed."""
    missing = [tool for tool in ("colcon", "cmake", "c++", "protoc") if not shutil.which(tool, path="/usr/bin")]
    for module in ("rosidl_adapter", "rosidl_generator_cpp", "ament_package", "colcon_ros"):
        if subprocess.run([_SYSTEM_PYTHON, "-c", f"import {module}"], capture_output=True).returncode:
            missing.append(module)
    return missing


# --- the workspace ----------------------------------------------------------------------------------------------


def _interfaces(package: Path) -> list[str]:
    """The interface packages that ours depends on, and those that they depend on."""
    manifest = ElementTree.parse(package / "package.xml").getroot()  # noqa: S314  # our own
    named = {str(node.text) for node in manifest if node.tag in ("depend", "build_depend", "build_export_depend")}
    return sorted(_closure(named - _WITHOUT_ROS))


def _closure(names: set[str]) -> set[str]:
    from rosbags.interfaces import Nodetype

    found, store = set(names), _store()
    waiting = list(names)
    while waiting:
        name = waiting.pop()
        for type_name in (known for known in store.fielddefs if known.startswith(f"{name}/msg/")):
            for _, (kind, detail) in store.fielddefs[type_name][1]:
                kind, detail = detail[0] if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE) else (kind, detail)
                other = detail.partition("/")[0] if kind is Nodetype.NAME else name
                if other not in found:
                    found.add(other)
                    waiting.append(other)
    return found


def _store():  # type: ignore[no-untyped-def]  # rosbags is there where the tests are
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_HUMBLE)


def _write_defaults(sources: Path) -> None:
    """ROS 2's packages with what turns .msg files into headers and libraries; of the type supports, those of Debian."""
    languages = {
        "generators": ["cmake", "adapter", "generator_c", "generator_cpp"],
        "runtime": ["runtime_c", "runtime_cpp"],
    }
    for what, parts in languages.items():
        folder = sources / f"rosidl_default_{what}"
        _write_package(folder, [], interface=False)
        exported = [*parts, "typesupport_introspection_c", "typesupport_introspection_cpp"]
        found = "find_package(ament_cmake REQUIRED)\n"
        _write_cmake(
            folder,
            f"{found}ament_export_dependencies({' '.join(f'rosidl_{one}' for one in exported)})\n",
            languages="NONE",
        )


def _write_standards(sources: Path, whole: list[str]) -> list[str]:
    """Packages of standard interfaces, which Debian does not have for ROS 2: some as a whole, and what handlers need.

    Returns the names of all of them.
    """
    needed = {interface.name for interface in compile_table(ROOT / "mapping.yaml").bridge.interfaces}
    needed |= {known for known in _store().fielddefs if known.partition("/")[0] in whole and "/msg/" in known}
    packages = sorted({name.partition("/")[0] for name in needed})
    for package in packages:
        types = sorted(name for name in needed if name.startswith(f"{package}/"))
        _write_standard(sources / package, types, sorted((_closure({package}) - {package}) & {*packages}))
    return packages


def _write_standard(folder: Path, types: list[str], depends: list[str]) -> None:
    """A package of standard interfaces, from the texts in rosbags."""
    _write_package(folder, depends, interface=True)
    (folder / "msg").mkdir()
    for type_name in types:
        (folder / "msg" / f"{type_name.rpartition('/')[2]}.msg").write_text(standard_text(type_name))
    found = "\n".join(f"find_package({one} REQUIRED)" for one in ("ament_cmake", "rosidl_default_generators", *depends))
    files = "\n".join(f'  "msg/{type_name.rpartition("/")[2]}.msg"' for type_name in types)
    needs = f"\n  DEPENDENCIES {' '.join(depends)}" if depends else ""
    _write_cmake(
        folder,
        f"{found}\nrosidl_generate_interfaces(${{PROJECT_NAME}}\n{files}{needs}\n)\n"
        "ament_export_dependencies(rosidl_default_runtime)\n",
    )


def _write_node(sources: Path, standards: list[str]) -> None:
    """A package that uses the C++ handlers."""
    library = _WORKSPACE / "cpp"
    shutil.rmtree(library, ignore_errors=True)
    bridge = workspace.write_library(library)
    _write_package(sources / "node", [REGISTRY.package, *standards], interface=False)
    _write_cmake(sources / "node", workspace.cmake(library, bridge))
    workspace.write_programs(sources / "node")


def _write_package(folder: Path, depends: list[str], *, interface: bool) -> None:
    folder.mkdir(parents=True)
    parts = ["<buildtool_depend>ament_cmake</buildtool_depend>", *(f"<depend>{one}</depend>" for one in depends)]
    if interface:
        parts += ["<buildtool_depend>rosidl_default_generators</buildtool_depend>"]
        parts += ["<depend>rosidl_default_runtime</depend>"]
        parts += ["<member_of_group>rosidl_interface_packages</member_of_group>"]
    (folder / "package.xml").write_text(
        f'<?xml version="1.0"?>\n<package format="3"><name>{folder.name}</name><version>0.0.0</version>'
        '<description>For the test.</description><maintainer email="unnamed@example.com">unnamed</maintainer>'
        f"<license>Apache-2.0</license>{''.join(parts)}"
        "<export><build_type>ament_cmake</build_type></export></package>\n"
    )


def _write_cmake(folder: Path, body: str, languages: str = "") -> None:
    head = f"cmake_minimum_required(VERSION 3.8)\nproject({folder.name} {languages})\n"
    (folder / "CMakeLists.txt").write_text(f"{head}{body}ament_package()\n")


# --- building and using -----------------------------------------------------------------------------------------


def _colcon(folder: Path, environment: Mapping[str, str], *options: str) -> bool:
    """Build the packages in a folder; whether that worked. Without our Python, which has none of rosidl's modules."""
    kept = {name: environment[name] for name in ("HOME", "LANG", "TERM", *_OF_ROS) if name in environment}
    command = ["/usr/bin/colcon", "--log-base", "log", "build", "--base-paths", str(folder), *options]
    command += ["--cmake-args", f"-DPython3_EXECUTABLE={_SYSTEM_PYTHON}", "--no-warn-unused-cli"]
    command += [f"-DAMENT_CMAKE_SYMLINK_INSTALL={int('--symlink-install' in options)}"]  # colcon leaves an old one on
    # Otherwise colcon lets make wait while the machine is busy.
    kept |= {"PATH": _path(), "MAKEFLAGS": f"-j{os.cpu_count()}"}
    return subprocess.run(command, cwd=_WORKSPACE, env=kept).returncode == 0


def _path() -> str:
    """Where the programs are: those of the system, and of a ROS 2 that is sourced; not our environment's Python."""
    ours = str(Path(sys.executable).parent)
    return ":".join(part for part in os.environ["PATH"].split(":") if part != ours) if _SOURCED else "/usr/bin:/bin"


def _sourced(install: Path) -> dict[str, str]:
    """The environment of a shell that has sourced what was installed."""
    command = ["/bin/bash", "-c", "source ./setup.bash && env -0"]
    done = subprocess.run(command, cwd=install, capture_output=True, text=True, check=True)
    return dict(line.split("=", 1) for line in done.stdout.split("\0") if line)


def _other_packages() -> Iterator[str]:
    """Packages that colcon finds in a clone, apart from the two that are meant: they would hide ROS 2's own."""
    found = subprocess.run(
        [_SYSTEM_PYTHON, "-c", _LIST, ROOT], capture_output=True, text=True, check=True
    ).stdout.split()
    if sorted(found) != sorted([REGISTRY.package, _NAVIGATION]):
        yield f"colcon finds the packages {', '.join(sorted(found))} in a clone"


def _other_hashes() -> Iterator[str]:
    """Where rosidl, from Iron on, computed another type hash than the generator."""
    folder = _WORKSPACE / "install" / REGISTRY.package / "share" / REGISTRY.package / "msg"
    computed = [json.loads(path.read_text())["type_hashes"][0] for path in sorted(folder.glob("*.json"))]
    print(f"rosidl computed {len(computed)} type hashes" if computed else "this rosidl computes no type hashes")
    known = {one.__msgtype__: one.__typehash__ for one in vars(generated.messages).values() if _is_message(one)}
    for one in computed:
        if known.get(one["type_name"]) != one["hash_string"]:
            yield f"{one['type_name']} has the hash {one['hash_string']}, and Python has {known.get(one['type_name'])}"


def _is_message(one: object) -> bool:
    return isinstance(one, type) and issubclass(one, Message)


def _does_not_stand_alone(folder: Path, package: Path) -> Iterator[str]:
    """Build the package with a vendored runtime in the place of the other one, move it, and start its bridge."""
    folder.unlink()
    shutil.copytree(package, folder)  # with the times of the files, so that no message is compiled again
    prefix = f"generated/ros/{REGISTRY.package}/"
    for path, text in compile_table(ROOT / "mapping.yaml", vendor_runtime=True).files.items():
        if (name := path.removeprefix(prefix)) != path and name.startswith("vendor/"):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8")
    built, moved = _WORKSPACE / "alone", _WORKSPACE / "elsewhere"
    for stale in (built, moved):
        shutil.rmtree(stale, ignore_errors=True)
    if not _colcon(folder, _sourced(_WORKSPACE / "install"), "--install-base", built.name):
        yield "the package with a vendored runtime does not build"
        return
    built.rename(moved)
    place = moved / REGISTRY.package
    for path in (*place.glob("lib/*/**/*"), *place.glob("share/*/launch/*"), *place.glob("share/*/config/*")):
        if path.is_symlink() or (path.is_file() and os.fsencode(ROOT) in path.read_bytes()):
            yield f"{path} contains the path of the project, or leads to it"
    # Nothing of this environment: neither its Python nor its variables.
    yield from _does_not_run({**_sourced(moved), "PATH": _path(), "HOME": str(moved)}, native=True)


def _does_not_run(environment: dict[str, str], *, native: bool = False) -> Iterator[str]:
    """Look for the launch files, and start the bridge as `ros2 run` does: by the package's name in the index."""
    package = REGISTRY.package
    prefixes = [Path(prefix) for prefix in environment["AMENT_PREFIX_PATH"].split(":")]
    marker = Path("share", "ament_index", "resource_index", "packages", package)
    found = [prefix / "lib" / package / f"{package}_node" for prefix in prefixes if (prefix / marker).is_file()]
    if not found or not os.access(found[0], os.X_OK):
        yield f"ros2 run {package} {package}_node would find no program"
        return
    shared = found[0].parents[2] / "share" / package
    for file in (f"launch/{package}.launch.py", f"launch/{package}_launch.yaml", "config/udp.yaml"):
        if not (shared / file).is_file():
            yield f"ros2 launch would not find {shared / file}"
    command = [found[0], "--json", "--middleware", "memory", "--ros-args", "-p", "listen_port:=0"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with contextlib.ExitStack() as stack:
        bridge = stack.enter_context(subprocess.Popen(command, env=environment, cwd="/", **pipes))  # type: ignore[call-overload]
        stack.callback(bridge.kill)
        ready = bridge.stdout.readline()
        if not ready or json.loads(ready)["fingerprint"] != REGISTRY.fingerprint:
            yield f"{found[0]} did not start this project's bridge: {ready}{bridge.stderr.read()}"
            return
        bridge.send_signal(signal.SIGINT)
        log = bridge.communicate(timeout=PATIENCE_S)[1]
        if bridge.returncode:
            yield f"{found[0]} ended with {bridge.returncode}: {log}"
        if native and REINSTALL in log:
            yield f"{found[0]} has no native core: {log}"


def _is_not_navigation(environment: dict[str, str]) -> Iterator[str]:
    """Look for the files of the package in navigation/, and start its programs, which are commands of roverlink."""
    prefix = _WORKSPACE / "install" / _NAVIGATION
    shared = prefix / "share" / _NAVIGATION
    for path in (ROOT / "rover" / "navigation").glob("*/*"):
        name = path.relative_to(ROOT / "rover" / "navigation")
        if name.parts[0] != "scripts" and not (shared / name).is_file():
            yield f"ros2 launch would not find {shared / name}"
    programs = sorted((prefix / "lib" / _NAVIGATION).iterdir())
    if not programs:
        yield f"{_NAVIGATION} has no programs"
    ours = {**environment, "PATH": f"{Path(sys.executable).parent}:{environment['PATH']}"}
    for program in programs:
        done = subprocess.run([program, "--help"], env=ours, cwd="/", capture_output=True, text=True)
        if done.returncode or f"usage: roverlink {program.name.replace('_', ' ')} " not in done.stdout:
            yield f"{program} is not that command of roverlink: {done.stdout[:80]}{done.stderr}"
        if os.fsencode(ROOT) in program.read_bytes():
            yield f"{program} contains the path of the project"


if __name__ == "__main__":
    sys.exit(main())

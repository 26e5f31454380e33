"""Test the bridge against a real ROS 2, whose wheels come from PyPI (`make test-ros2`), or which is sourced.

Each distribution gets an environment in `.ros2/`, with the wheels and with roverlink. CMake and rosidl build the
interface package in `generated/ros` against it, and what the tests need of `nav2_msgs`, `tf2_msgs` and `vision_msgs`,
of which PyPI has no wheels. Then pytest runs in this environment: rclpy nodes with the classes that rosidl generated
judge what `roverlink run` and the other programs do.

    python tests/ros2/run.py                    both distributions
    python tests/ros2/run.py jazzy -k graph     one of them, with arguments for pytest
    python3 tests/ros2/run.py --sourced         the ROS 2 of this shell, such as Humble on Ubuntu 22.04 or on a Jetson

Exit code 0: all tests passed; 1: a test failed; 2: a tool is missing, or the wheels cannot be installed.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import platform
import shutil
import subprocess
import sys
import sysconfig
import venv
from collections.abc import Callable, Iterable
from itertools import takewhile
from pathlib import Path

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).parent
ENVIRONMENTS = ROOT / ".ros2"
COMMS = ROOT / "generated" / "ros" / "comms"
INTERFACES, TEMPLATE = HERE / "interfaces", HERE / "template"
DISTRIBUTIONS = ("jazzy", "kilted")
SOURCED = "sourced"
"""Name of the environment with the ROS 2 of the shell."""
TESTS = [str(ROOT / folder / "tests" / "ros2") for folder in ("", "rover", "check_launch")]
_ALL = ["-n", "auto", "-m", "not exhaustive"]
# An installed ROS 2 brings plug-ins (launch_testing) that this pytest refuses.
_NO_PLUGINS = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTEST_ADDOPTS": "-p xdist.plugin"}


def main() -> int:
    """Prepare the distributions and run the tests in each."""
    parser = argparse.ArgumentParser(
        usage="run.py [-h] [--sourced | DISTRIBUTION ...] [option of pytest ...]",
        description="Test the bridge against a real ROS 2 from PyPI.",
    )
    parser.add_argument("--sourced", action="store_true", help="the ROS 2 that is sourced in this shell")
    arguments, words = parser.parse_known_args()
    distributions = [*takewhile(lambda word: not word.startswith("-"), words)]
    for_pytest = words[len(distributions) :]
    wanted = [SOURCED] if arguments.sourced else distributions or DISTRIBUTIONS
    if arguments.sourced and (distributions or not os.environ.get("AMENT_PREFIX_PATH")):
        parser.error("--sourced is for the one ROS 2 of this shell; run `source /opt/ros/humble/setup.bash` first")
    if not arguments.sourced and (unknown := set(wanted) - set(DISTRIBUTIONS)):
        parser.error(f"unknown: {', '.join(unknown)} (known: {', '.join(DISTRIBUTIONS)})")
    if missing := _missing(of_pypi=not arguments.sourced):
        print(missing, file=sys.stderr)
        return 2
    failed = False
    for distribution in wanted:
        try:
            prepare(distribution)
        except subprocess.CalledProcessError as error:
            print(f"ROS 2 {distribution} was not prepared: {error}", file=sys.stderr)
            return 2
        print(f"== ROS 2 {distribution}", flush=True)
        failed |= run(distribution, "-m", "pytest", *TESTS, *_ALL, *for_pytest) != 0
    return int(failed)


def _missing(*, of_pypi: bool) -> str:
    """Say what this machine lacks; empty if nothing."""
    if of_pypi and platform.machine() != "x86_64":
        return f"PyPI has the wheels of ROS 2 for x86_64 only, and this machine is {platform.machine()}"
    if of_pypi and not (3, 10) <= sys.version_info[:2] <= (3, 13):
        return f"PyPI has the wheels of ROS 2 for Python 3.10 to 3.13, and this is {platform.python_version()}"
    packages = [] if shutil.which("g++") and shutil.which("make") else ["g++", "make"]
    if not Path(sysconfig.get_path("include"), "Python.h").is_file():
        packages.append(f"python3.{sys.version_info.minor}-dev")
    return f"to build the interface packages, install: apt-get install {' '.join(packages)}" if packages else ""


# --- what is made once ------------------------------------------------------------------------------------------------


def prepare(distribution: str) -> None:
    """Make a distribution's environment and interface packages, unless they are there."""
    folder = ENVIRONMENTS / distribution
    products = [ROOT / folder / "pyproject.toml" for folder in ("", "rover", "check_launch")]
    pins = [*products, HERE / "tools.txt", HERE / _requirements(distribution)]
    shell = os.environ.get("AMENT_PREFIX_PATH", "") if distribution == SOURCED else ""
    _once(folder / "installed", f"{sys.version} {shell} {_checksum(pins)}", lambda: _install(distribution, folder))
    folders = (COMMS, INTERFACES, TEMPLATE)
    made = [ROOT / "tests" / "asking.py", *(ROOT / "templates").glob("*.j2")]  # the package of the table with requests
    sources = _checksum([*made, *(path for one in folders for path in one.rglob("*") if path.is_file())])
    _once(folder / "overlay" / "built", sources, lambda: _build(distribution, folder))


def _once(stamp: Path, key: str, make: Callable[[], None]) -> None:
    """Make something, unless the stamp says that it was made from the same inputs."""
    if not stamp.is_file() or stamp.read_text() != key:
        make()
        stamp.write_text(key)


def _checksum(files: Iterable[Path]) -> str:
    """Return a checksum of files: of their names and contents."""
    whole = hashlib.sha256()
    for path in sorted(files):
        whole.update(f"{path.relative_to(ROOT)}\0{path.stat().st_size}\0".encode() + path.read_bytes())
    return whole.hexdigest()


def _requirements(distribution: str) -> str:
    return "tools.txt" if distribution == SOURCED else f"{distribution}.txt"


def _install(distribution: str, folder: Path) -> None:
    where = folder.relative_to(ROOT)
    print(f"installing what ROS 2 {distribution} needs in {where}; the first time, this can take minutes", flush=True)
    venv.create(folder, clear=True, with_pip=True, system_site_packages=distribution == SOURCED)
    pip = [folder / "bin" / "python", "-m", "pip", "install", "--disable-pip-version-check", "--no-compile"]
    ros = "" if distribution == SOURCED else f"ros-{distribution},"
    products = (f".[{ros}standard,record]", "./rover[detect,fusion,video]", "./check_launch")
    editable = [word for product in products for word in ("--editable", product)]
    subprocess.run([*pip, "--requirement", HERE / _requirements(distribution), *editable], cwd=ROOT, check=True)


def _build(distribution: str, folder: Path) -> None:
    """Build the interface packages and install them into the overlay."""
    for stale in ("build", "overlay"):
        shutil.rmtree(folder / stale, ignore_errors=True)
    _build_package(COMMS, distribution, folder)
    code = f"import asking, pathlib; asking.write_asking_project(pathlib.Path({str(folder / 'build' / 'asking')!r}))"
    subprocess.run([folder / "bin" / "python", "-c", code], cwd=ROOT / "tests", check=True)
    _build_package(folder / "build" / "asking" / "asking_rover" / "ros" / "asking_msgs", distribution, folder)
    for interfaces in sorted(INTERFACES.iterdir()):
        package = folder / "build" / "sources" / interfaces.name
        shutil.copytree(interfaces, package)
        for template in TEMPLATE.iterdir():
            (package / template.name).write_text(template.read_text().replace("@NAME@", package.name))
        _build_package(package, distribution, folder)


def _build_package(package: Path, distribution: str, folder: Path) -> None:
    print(f"building {package.name} for ROS 2 {distribution}", flush=True)
    build, overlay, python = folder / "build" / package.name, folder / "overlay", folder / "bin" / "python"
    build.mkdir(parents=True)
    settings = {
        "CMAKE_PREFIX_PATH": environment(distribution)["AMENT_PREFIX_PATH"].replace(":", ";"),
        "CMAKE_INSTALL_PREFIX": overlay,
        "BUILD_TESTING": "OFF",
        "CMAKE_PROJECT_INCLUDE": HERE / "one_source.cmake",
        "Python3_EXECUTABLE": python,
        "PYTHON_EXECUTABLE": python,  # what the older of ROS 2's CMake files read
    }
    options = [f"-D{name}={value}" for name, value in settings.items()]
    with (folder / "build.log").open("w") as log:
        for arguments in (
            ["-S", package, "-B", build, *options],
            ["--build", build, "--parallel", str(os.cpu_count() or 1)],
            ["--install", build],
        ):
            command = ["cmake", *arguments]
            if subprocess.run(command, env=environment(distribution), stdout=log, stderr=log).returncode:
                print("".join((folder / "build.log").read_text().splitlines(keepends=True)[-40:]), file=sys.stderr)
                raise subprocess.CalledProcessError(1, "cmake")


# --- what runs in it --------------------------------------------------------------------------------------------------


def environment(distribution: str) -> dict[str, str]:
    """Return the environment of a shell in which the distribution and the interface packages are sourced."""
    folder = ENVIRONMENTS / distribution
    overlay = folder / "overlay"
    modules = next(folder.glob("lib/python3.*")).name
    own = {
        "AMENT_PREFIX_PATH": f"{overlay}",
        "LD_LIBRARY_PATH": f"{overlay}/lib",
        "PYTHONPATH": f"{overlay}/lib/{modules}/site-packages",
        "PATH": f"{folder}/bin:{os.environ['PATH']}",
    }
    if distribution == SOURCED:
        before = {name: f"{value}:{os.environ[name]}" for name, value in own.items() if os.environ.get(name)}
        return {**os.environ, **own, **before, "PATH": own["PATH"], **_NO_PLUGINS}
    own["AMENT_PREFIX_PATH"] += f":{folder}"
    own["LD_LIBRARY_PATH"] += f":{folder}/lib"
    return {**os.environ, **own, "ROS_DISTRO": distribution}


def run(distribution: str, *arguments: str) -> int:
    """Run Python in a distribution's environment; return the exit code."""
    python = ENVIRONMENTS / distribution / "bin" / "python"
    return subprocess.run([python, *arguments], cwd=ROOT, env=environment(distribution)).returncode


if __name__ == "__main__":
    sys.exit(main())

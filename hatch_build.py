"""Compiles the native core (native/) into the wheel and into editable installs. Hatchling calls it.

The compiler alone builds the library: it is one command, which CMake would only wrap. CXX, CXXFLAGS and LDFLAGS mean
what they usually do. For another platform, CXX is its cross compiler, and _PYTHON_HOST_PLATFORM its name, such as
linux-aarch64, which Python then returns as its own. Without a compiler, and if it fails, the wheel is a pure one, and
the bridge translates in Python.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from packaging.tags import platform_tags

_LIBRARY = "runtime/native/libroverlink_native.so"
FLAGS = "roverlink/native/flags"
"""File with the compiler's options, for the ROS 2 package, too. With -ffp-contract=off, C++ rounds as Python does."""
INCLUDES = ("roverlink/native/include", "roverlink/cpp/c")
"""Folders with headers. The second one has the C code of boards, by which the library signs, too."""
_OLDEST_GLIBC = 17
"""Minor version of the oldest glibc 2 for which wheels have a tag of this form (PEP 600)."""


class NativeCore(BuildHookInterface):  # type: ignore[type-arg]  # hatchling's own configuration is no matter here
    """Build hook of hatchling."""

    _folder: tempfile.TemporaryDirectory[str] | None = None

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile the library: into the tree for an editable install, else only into the wheel."""
        if version == "editable":
            self._compile(Path(self.root, _LIBRARY))
            return
        self._folder = tempfile.TemporaryDirectory()
        library = Path(self._folder.name, "library")
        if self._compile(library):
            build_data["force_include"][str(library)] = f"roverlink/{_LIBRARY}"
            build_data["pure_python"] = False
            build_data["tag"] = f"py3-none-{_platform(library)}"

    def finalize(self, *_: object) -> None:
        """Remove what was compiled."""
        if self._folder is not None:
            self._folder.cleanup()

    def _compile(self, library: Path) -> bool:
        """Compile the library. If that is impossible, say why in one line, remove an older one, and return false."""
        if sys.platform != "linux":
            return self._without(library, "it reads many datagrams with one system call, which only Linux has")
        compiler = (
            shlex.split(os.environ.get("CXX", ""))
            or [name for name in ("c++", "g++", "clang++") if shutil.which(name)][:1]
        )
        if not compiler:
            return self._without(library, "no C++ compiler was found")
        native, made = Path(self.root, "roverlink/native"), library.with_name(f"{library.name}.{os.getpid()}")
        flags = [f"@{Path(self.root, FLAGS)}", *shlex.split(os.environ.get("CXXFLAGS", ""))]
        # What the library needs of a C++ library is in it, so that it runs beside any.
        flags += ["-static-libstdc++", "-static-libgcc", "-Wl,--no-undefined"]
        linked = ["-o", str(made), *shlex.split(os.environ.get("LDFLAGS", ""))]
        include = [f"-I{Path(self.root, folder)}" for folder in INCLUDES]
        command = [*compiler, *flags, *include, *map(str, sorted(native.glob("src/*.cpp"))), *linked]
        try:
            code = subprocess.run(command, check=False).returncode  # noqa: S603  # the compiler of who installs it
        except OSError as error:
            return self._without(library, str(error))
        if code != 0:
            return self._without(library, f"{compiler[0]} failed")
        # At once: other environments of this tree use the library, and a running bridge keeps the one it opened.
        made.replace(library)
        return True

    def _without(self, library: Path, reason: str) -> bool:
        library.unlink(missing_ok=True)  # it may not fit the tree
        self.app.display_warning(
            f"roverlink is installed without its native core, which only makes it faster: {reason}"
        )
        return False


def _platform(library: Path) -> str:
    """Return the platform of a wheel with the library: that of the oldest glibc that has all that the library needs."""
    plain = next(tag for tag in platform_tags() if not tag.startswith(("manylinux", "musllinux")))
    needed = [int(minor) for minor in re.findall(rb"\0GLIBC_2\.(\d+)", library.read_bytes())]
    return plain.replace("linux_", f"manylinux_2_{max(_OLDEST_GLIBC, *needed)}_", 1) if needed else plain

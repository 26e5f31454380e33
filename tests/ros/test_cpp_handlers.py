"""The C++ handlers do what the Python handlers do: compiled against libprotobuf and rosidl's structs, and asked.

Those of this project's own table are built by `make ros-package`, with CMake.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

_HERE = Path(__file__).parent / "cpp"
sys.path.insert(0, str(_HERE))

from building import missing  # noqa: E402
from golden import case  # noqa: E402
from needs import NO_ROS  # noqa: E402

_PROJECTS = (
    *("any_of", "awkward_names", "cpp_handlers", "enums", "maps", "nested", "oneofs", "presence", "scalars"),
    *("standard_absences", "standard_axes", "standard_enums", "standard_euler", "standard_own_messages"),
    *("standard_times", "standard_units"),
)
"""What has a conversion of its own, and compiles with the protoc of Debian 12, which knows no editions."""


@pytest.mark.exhaustive
@pytest.mark.parametrize("name", _PROJECTS)
def test_cpp_handlers_give_what_python_handlers_give(name: str, tmp_path: Path) -> None:
    """Any payload becomes the same serialized message, any message the same payload; both refuse the same."""
    if missing():  # here: it starts a program, which nobody needs to wait for where the test is left out
        pytest.skip(NO_ROS)
    project = case(name).write_inputs(tmp_path)
    command = [sys.executable, _HERE / "crosscheck.py", "mapping.yaml"]
    done = subprocess.run(command, cwd=project, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr

"""No page, message or workflow tells a reader to install a package whose name somebody else could register."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest
from page import ROOT

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

_HINT = re.compile(r"pip[ ]install ((?:--?[a-z-]+ +)*)['\"]?([^\s`'\")\\]+)")
_FILES = ("*.md", "*.py", "*.j2", "*.yml", "*.yaml", "*.toml", "Makefile")


def _requirements() -> set[str]:
    found = set()
    for product in ("", "rover", "check_launch"):
        project = tomllib.loads((ROOT / product / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        extras = project.get("optional-dependencies", {}).values()
        found |= {*project["dependencies"], *(one for extra in extras for one in extra)}
    return {one.partition(";")[0].strip() for one in found}


@pytest.mark.slow
def test_every_hint_names_a_package_that_is_required_or_a_place() -> None:
    """Behind `pip install` stands a path, an address or a requirement of pyproject.toml, and never roverlink's name."""
    known = {one for one in _requirements() if not one.startswith(("roverlink", "roverkit"))}
    known.add("build")  # the PyPA's tool, for `make dist`
    known.add("onnxruntime-gpu")  # onnxruntime's, with CUDA
    known.add("numpy<2")  # a requirement, too, for OpenCV before 4.10
    known |= {re.split(r"[<>=\[]", one)[0] for one in known}
    listed = subprocess.run(["git", "ls-files", "--", *_FILES], cwd=ROOT, capture_output=True, text=True, check=True)
    wrong = []
    for path in listed.stdout.splitlines():
        for number, line in enumerate((ROOT / path).read_text(encoding="utf-8").splitlines(), 1):
            for hint in _HINT.finditer(line):
                named = hint[2]
                is_place = named.startswith((".", "/", "$", "{", "git+", "SOURCE")) or f"{named} @ git+" in line
                if not is_place and named not in known:
                    wrong.append(f"{path}:{number}: {hint[0]}")
    assert wrong == []

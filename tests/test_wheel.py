"""Each wheel installs one package; that of roverlink works in a project whose folders have the names of our own."""

from __future__ import annotations

import re
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from polling import PATIENCE_S

ROOT = Path(__file__).parents[1]
Run = Callable[..., "subprocess.CompletedProcess[str]"]


def _unpacked_wheel(product: Path, folder: Path) -> Path:
    """Build the wheel of a product, and return a folder with its content."""
    build = [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", folder]
    subprocess.run(build, cwd=product, check=True, capture_output=True)
    (wheel,) = folder.glob("*.whl")
    zipfile.ZipFile(wheel).extractall(folder / "site")
    return folder / "site"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the content of roverlink's wheel and nothing else of ours."""
    return _unpacked_wheel(ROOT, tmp_path_factory.mktemp("wheel"))


@pytest.fixture
def roverlink(site: Path, tmp_path: Path) -> Run:
    """Run the wheel's command line in an empty folder of a user."""

    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        environment = {"PYTHONPATH": str(site), "PATH": "/usr/bin:/bin", "HOME": str(tmp_path)}
        command = [sys.executable, "-m", "roverlink", *arguments]
        return subprocess.run(
            command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=PATIENCE_S
        )

    return run


@pytest.mark.slow
def test_the_wheel_has_one_top_level_module(site: Path) -> None:
    """Beside the metadata there is `roverlink` alone, with its parts and their data; the sample rover is not in it."""
    assert sorted(path.name for path in site.iterdir() if path.suffix != ".dist-info") == ["roverlink"]
    parameters = "runtime/ros_arguments/node_parameters.yaml"
    for file in ("py.typed", "templates/handler.py.j2", "cpp/CMakeLists.txt", parameters):
        assert (site / "roverlink" / file).is_file()
    assert not list(site.rglob("imu_*"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("product", "package", "file"),
    [("rover", "roverkit", "objects/rocks_and_panels.onnx"), ("check_launch", "check_launch", "catalogue/humble.json")],
)
def test_wheels_of_the_other_products_have_theirs(product: str, package: str, file: str, tmp_path: Path) -> None:
    """Each has one package with its data, and needs the roverlink of its own version."""
    site = _unpacked_wheel(ROOT / product, tmp_path)
    assert [path.name for path in site.iterdir() if path.suffix != ".dist-info"] == [package]
    assert (site / package / file).is_file()
    (metadata,) = (path.read_text(encoding="utf-8") for path in site.glob("*.dist-info/METADATA"))
    version = re.search(r"^Version: (.*)$", metadata, re.MULTILINE)
    assert version is not None
    assert f"Requires-Dist: roverlink=={version[1]}\n" in metadata


@pytest.mark.slow
def test_folders_of_a_user_disturb_nothing(site: Path, roverlink: Run, tmp_path: Path) -> None:
    """A project with its own packages `generator`, `runtime`, `vision` and `templates` can be compiled and linted."""
    for name in ("generator", "runtime", "vision", "templates"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("raise RuntimeError('a module of the user was imported')\n")
    for command in (["init"], ["generate", "--check"], ["lint"], ["explain", "board_status"]):
        done = roverlink(*command)
        assert (done.returncode, done.stderr) == (0, ""), done.stdout
    where = [sys.executable, "-c", "import generated, roverlink.runtime as r; print(r.__file__, generated.__file__)"]
    told = subprocess.run(where, cwd=tmp_path, env={"PYTHONPATH": str(site)}, capture_output=True, text=True)
    assert told.stdout.split() == [str(site / "roverlink/runtime/__init__.py"), str(tmp_path / "generated/__init__.py")]

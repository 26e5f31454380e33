"""Who may import whom."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
OURS = {"generator", "generated", "runtime", "vision", "roverlink", "bench", "tests"}
MAY_IMPORT = {
    "generator": set[str](),
    "runtime": set[str](),
    "generated": {"runtime"},
    "vision": {"runtime", "generated"},
    "roverlink": {"generator", "runtime", "vision"},
}


def _imports(path: Path) -> Iterator[str]:
    """The modules that a file imports, by their full names."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _imports_below(folder: str) -> set[tuple[str, str]]:
    # The ROS 2 package among the generated is run by ROS 2, and its program is the command line.
    files = [path for path in sorted((ROOT / folder).rglob("*.py")) if "ros" not in path.relative_to(ROOT).parts]
    assert files
    return {(path.relative_to(ROOT).as_posix(), module) for path in files for module in _imports(path)}


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_packages_import_only_what_they_may(package: str) -> None:
    """The command line puts the parts together; generator and runtime know nobody; generated code knows the runtime."""
    forbidden = OURS - MAY_IMPORT[package] - {package}
    assert {(file, module) for file, module in _imports_below(package) if module.split(".")[0] in forbidden} == set()


@pytest.mark.parametrize(("folder", "other"), [("rules", "targets"), ("targets", "rules")])
def test_rules_and_targets_do_not_know_each_other(folder: str, other: str) -> None:
    """What is wrong and what is written are decided apart."""
    found = _imports_below(f"generator/{folder}")
    assert {pair for pair in found if f"{pair[1]}.".startswith(f"generator.{other}.")} == set()


_LINT = ("rules", "context", "history", "changes")
"""Parts of the lint: each may import those that follow it, and none before it."""


@pytest.mark.parametrize("part", _LINT)
def test_parts_of_the_lint_know_only_what_they_rest_on(part: str) -> None:
    """Comparing two schemas takes no history, history takes no context, and the context takes no rule."""
    folder = ROOT / "generator" / part
    files = sorted(folder.rglob("*.py")) if folder.is_dir() else [folder.with_suffix(".py")]
    imported = {module for file in files for module in _imports(file)}
    above = tuple(f"generator.{other}." for other in _LINT[: _LINT.index(part)])
    assert {module for module in imported if f"{module}.".startswith(above)} == set()


def test_no_rule_knows_another() -> None:
    """Each rule is a file that could be taken out; only the list of all knows them."""
    found = {pair for pair in _imports_below("generator/rules") if not pair[0].endswith("/__init__.py")}
    assert {pair for pair in found if pair[1].startswith("generator.rules")} == set()


def test_the_ir_knows_no_format() -> None:
    """What stands between table and files depends on neither's library."""
    allowed = {"__future__", "collections", "dataclasses", "enum", "fractions", "typing"}
    own = {f"generator.{name}" for name in ("ir.Qos", "ir_standard.Feed", "ir_standard.Interface")}
    for file in ("ir.py", "ir_standard.py"):
        imported = set(_imports(ROOT / "generator" / file)) - own
        assert {module.split(".")[0] for module in imported} <= allowed


def test_the_renderer_knows_nothing_of_what_it_judges() -> None:
    """Frames of known truth do not come from the code that is to find the truth in them."""
    imported = _imports(ROOT / "vision" / "rendering.py")
    assert {module for module in imported if module.startswith("vision.")} == {"vision._opencv.cv2"}

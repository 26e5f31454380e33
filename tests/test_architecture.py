"""Holds the imports to docs/architecture.md: who may import whom, no cycles, one package, telling names."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from textwrap import dedent

import pytest

ROOT = Path(__file__).parents[1]
_SHARED_NAMES = {
    *("conversions", "handlers", "interfaces", "messages", "registry"),  # of each target
    *("extra_topics", "reader", "__main__", "board"),  # of target and bridge, table and recording, command and output
    *("track", "send", "measure", "run", "render", "command"),  # commands of several parts
}
_IMPORT = re.compile(
    r"^ *(?:from [\w.]+ import (?:\([^)]*\)|[\w*, ]+)|import [\w.]+(?: as \w+)?)(?:  #.*)?\n", re.MULTILINE
)
"""An import statement, as black writes it; to parse whole modules takes six times as long."""
LINKED = ("generator", "runtime")
"""Folders of the repository that are imported as `roverlink.<folder>`."""
_ALONE = (
    *("suggestions", "datagram_size", "transport_addresses", "bounded_files", "bounded_yaml", "numerals", "user_cache"),
    "type_descriptions",
)
_FOR_ALL = tuple(f"roverlink/{name}" for name in _ALONE)
PRODUCTS = ("rover/roverkit", "check_launch/check_launch")
"""Packages of the other products of the repository."""


@cache
def _modules() -> dict[str, Path]:
    """Every module of ours by its import name."""
    files = {path for folder in (*LINKED, "generated", *PRODUCTS) for path in (ROOT / folder).rglob("*.py")}
    files = {path for path in files if path.relative_to(ROOT).parts[1] != "ros"}  # generated/ros is run by ROS 2
    own = [path for path in (ROOT / "roverlink").iterdir() if not path.is_symlink()]
    files |= {path for entry in own for path in ([entry] if entry.suffix == ".py" else entry.rglob("*.py"))}
    return {_import_name(path): path for path in sorted(files)}


def _import_name(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    name = ".".join(parts[1:] if "/".join(parts[:2]) in PRODUCTS else parts).removesuffix(".__init__")
    return f"roverlink.{name}" if parts[0] in LINKED else name


@cache
def _imports(module: str) -> frozenset[str]:
    """The modules of ours that a module imports; imports under TYPE_CHECKING and in functions count."""
    found: set[str] = set()
    statements = map(dedent, _IMPORT.findall(_modules()[module].read_text(encoding="utf-8")))
    for node in ast.parse("".join(statements)).body:
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {name if name in _modules() else str(node.module) for name in names}
    return frozenset(name for name in found & _modules().keys() if name != module)


def _loads(module: str) -> set[str]:
    """The modules that importing a module executes directly: what it imports, and the packages around that."""
    parts = [name.split(".") for name in _imports(module)]
    loaded = {".".join(name[:end]) for name in parts for end in range(1, len(name) + 1)}
    return {name for name in loaded & _modules().keys() if not f"{module}.".startswith(f"{name}.")}


@cache
def _table() -> dict[str, tuple[str, ...]]:
    """The table of docs/architecture.md: a part, and the parts that it may import."""
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    section = page.partition("## Who may import whom")[2]
    rows = re.findall(r"^\| `([a-z_/]+)` \| (.*) \|$", section, re.MULTILINE)
    return {part: tuple(re.findall(r"`([a-z_/]+)`", allowed)) for part, allowed in rows}


def _part(module: str) -> str:
    """The row of the table that a module belongs to: the most special one."""
    path = _modules()[module].relative_to(ROOT)
    candidates = [path.with_suffix("").as_posix(), *(folder.as_posix() for folder in path.parents)]
    return next((one for one in candidates if one in _table()), "")


def _is_below(part: str, other: str) -> bool:
    return f"{part}/".startswith(f"{other}/")


def test_every_module_belongs_to_a_part() -> None:
    """The table of docs/architecture.md names all there is, and nothing that is not there."""
    assert [module for module in _modules() if not _part(module)] == []
    assert set(_table()) == {_part(module) for module in _modules()}


def test_parts_import_only_what_the_table_allows() -> None:
    """A module imports its own part, and the parts that the table allows."""
    crossings = [
        f"{module} imports {other}"
        for module in _modules()
        for other in sorted(_imports(module))
        if _part(module) not in PRODUCTS
        and not _is_below(_part(other), _part(module))
        and not any(_is_below(_part(other), allowed) for allowed in (*_table()[_part(module)], *_FOR_ALL))
    ]
    assert crossings == []


@pytest.mark.parametrize("product", PRODUCTS)
def test_other_products_import_what_is_public(product: str) -> None:
    """The packages roverkit and check-launch stand on the modules of docs/public-api.md, and on no other of ours."""
    page = (ROOT / "docs" / "public-api.md").read_text(encoding="utf-8")
    public = set(re.findall(r"^\| `([\w.*]+)` \|", page, re.MULTILINE))
    crossings = {
        f"{module} imports {other}"
        for module in _modules()
        for other in _imports(module)
        if _part(module) == product != _part(other)
        if other not in public and not any(f"{other}.".startswith(name[:-1]) for name in public if name.endswith(".*"))
    }
    assert crossings == set()


def test_no_module_is_part_of_an_import_cycle() -> None:
    """Modules can be read from the bottom up: none imports itself by way of others."""
    assert list(_cycles()) == []


def _cycles() -> Iterator[list[str]]:
    """Each import cycle, as the modules on it (depth-first search; a module is done once everything below it is)."""
    done: set[str] = set()

    def visit(module: str, above: list[str]) -> Iterator[list[str]]:
        if module in above:
            yield above[above.index(module) :]
        elif module not in done:
            for other in sorted(_loads(module)):
                yield from visit(other, [*above, module])
            done.add(module)

    for module in _modules():
        yield from visit(module, [])


def test_no_rule_imports_another() -> None:
    """Each rule of the lint can be taken out; only the list of all knows them."""
    rules = {name for name in _modules() if name.startswith("roverlink.generator.lint.rules.")}
    assert {(rule, other) for rule in rules for other in _imports(rule) & rules} == set()


def test_the_ir_depends_on_no_format() -> None:
    """The IR imports neither YAML, protobuf nor Jinja: the standard library's data types suffice."""
    allowed = {"__future__", "collections", "dataclasses", "enum", "fractions", "keyword", "re", "typing", "roverlink"}
    for path in (ROOT / "generator" / "ir").glob("*.py"):
        nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
        names = {str(node.module) for node in nodes if isinstance(node, ast.ImportFrom)}
        names |= {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
        assert {name.split(".")[0] for name in names} <= allowed, path


def test_the_renderer_does_not_use_what_it_judges() -> None:
    """Frames of known truth come from code that the tracker does not share."""
    assert _imports("roverkit.vision.images.rendering") == {"roverkit.vision.opencv"}


def test_the_vision_library_does_not_know_its_command() -> None:
    """roverkit.aruco imports roverkit.vision, and not the other way round."""
    known = {other for module in _modules() if module.startswith("roverkit.vision") for other in _imports(module)}
    assert not any(name.startswith("roverkit.aruco") for name in known)


@pytest.mark.parametrize("folder", LINKED)
def test_a_folder_does_not_import_under_its_bare_name(folder: str) -> None:
    """`import runtime` in a checkout is an error that names the right import, never a second copy of the modules."""
    said = f"'{folder}' is a folder of this repository, not a package; import roverlink.{folder}"
    spec = spec_from_file_location(folder, ROOT / folder / "__init__.py")
    with pytest.raises(ImportError, match=re.escape(said)):
        spec.loader.exec_module(module_from_spec(spec))


def test_a_name_that_two_folders_share_means_the_same_in_both() -> None:
    """A module's name tells what is inside: the few that stand in several folders are known to mean the same there."""
    by_name = defaultdict(list)
    for module, path in _modules().items():
        if path.name != "__init__.py" and not module.startswith("generated."):
            by_name[path.stem].append(module)
    shared = {name for name, modules in by_name.items() if len(modules) > 1}
    assert shared == _SHARED_NAMES

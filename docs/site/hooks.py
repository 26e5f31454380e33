"""Hooks for MkDocs: add the pages of all products and the reference to the site, link to the reference, draw diagrams.

The home page is README.md. The reference is read from the code, so that no fact is written down twice. Links between
pages are those of the repository, so that they also work there; the site has them as they are on the site.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator
from pathlib import Path

import bridge_classes
import command_pages
import mermaidx
import rule_pages
import runtime_api
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

_ROOT = Path(__file__).parents[2]
_DOCS = "docs"
_PRODUCTS = ("rover", "check_launch")
_CODE_OR_RULE_OR_LINK = re.compile(
    r"^```.*?^```|(?P<id>`?\b[A-Z]{3}[0-9]{3}\b`?)|`[^`\n]+`|\[[^\]\n]*\]\([^)\n]*\)", re.DOTALL | re.MULTILINE
)
_BLOCK_OR_PATH = re.compile(
    r"^```.*?^```$|(?:(?<=\]\()|(?<=src=\"))(?P<path>[^)#:\"\s]+)(?=[)#\"\s])", re.DOTALL | re.MULTILINE
)
_MERMAID = re.compile(r"^```mermaid\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_COMMAND_CELL = re.compile(r"^\| (`roverlink ([\w-]+)[^`]*`) \|", re.MULTILINE)
_REFERENCE = """\
# Reference

| what | where |
|---|---|
| commands and their options | [Commands](commands/index.md) |
| rules: every diagnostic with a bad and a good example | [Rules](rules/index.md) |
| keys of `mapping.yaml` | [mapping.yaml](../mapping.md#keys) |
| parameters of the node | [Operations](../operations-reference.md#parameters-of-the-node) |
| counters of the bridge | [Operations](../operations-reference.md#counters) |
| messages of the sample rover | [Messages](../messages.md) |
| Python: registry, handlers, translator, bridge, errors | [roverlink.runtime](runtime.md) |
| Python: a basestation or a board | [roverlink.runtime.client](client.md) |
| classes for templates and targets | [Classes](bridge.md) |
| what may change from version to version | [Public API](../public-api.md) |
"""


def _reference() -> dict[str, str]:
    """Return the text of every page of the reference by its path."""
    pages = {"reference/index.md": _REFERENCE, "reference/bridge.md": bridge_classes.page()}
    return pages | runtime_api.pages() | command_pages.pages() | rule_pages.pages()


def _added_files() -> Iterator[tuple[str, str]]:
    """Return the files that the site has besides those in docs/: path in the repository, path on the site."""
    yield from (("README.md", "index.md"), ("CHANGELOG.md", "changelog.md"), ("CONTRIBUTING.md", "contributing.md"))
    yield ("LICENSE", "LICENSE")
    for product in _PRODUCTS:
        yield (f"{product}/README.md", f"{product}/index.md")
        folder = _ROOT / product / _DOCS
        for path in sorted(path for path in folder.rglob("*") if path.is_file()):
            yield (path.relative_to(_ROOT).as_posix(), f"{product}/{path.relative_to(folder).as_posix()}")


_SITE_PATHS = dict(_added_files())
_REPOSITORY_PATHS = {site: repository for repository, site in _SITE_PATHS.items()}


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Add the generated pages to the navigation."""
    config.nav = [
        {"roverlink": "index.md"},
        *(config.nav or []),
        {
            "Reference": [
                "reference/index.md",
                {"Commands": [command_pages.INDEX, *command_pages.paths()]},
                {"Rules": [rule_pages.INDEX, *rule_pages.paths()]},
                {"Python": [*runtime_api.MODULES, {"Public API": "public-api.md"}]},
                {"Classes for templates": "reference/bridge.md"},
                {"Changelog": "changelog.md"},
            ]
        },
    ]
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add README.md as the home page, the pages of the other products, the changelog and the reference."""
    for repository, site in _SITE_PATHS.items():
        files.append(File.generated(config, site, abs_src_path=str(_ROOT / repository)))
    for path, text in _reference().items():
        files.append(File.generated(config, path, content=text))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Adapt links; draw Mermaid diagrams; link the ids of rules, and the commands in the first column of tables."""
    here = page.file.src_uri
    markdown = _BLOCK_OR_PATH.sub(lambda found: _site_link(found, here), markdown)
    for number, source in enumerate(_MERMAID.findall(markdown), 1):
        picture = f"{here.removesuffix('.md')}-{number}.svg"
        files.append(File.generated(config, picture, content=mermaidx.render(source).svg()))
        markdown = _MERMAID.sub(f"![diagram]({posixpath.basename(picture)}){{: .diagram }}", markdown, count=1)
    if here.startswith("reference/rules"):
        return markdown
    markdown = _CODE_OR_RULE_OR_LINK.sub(lambda found: _linked_rule(found, here), markdown)
    return _COMMAND_CELL.sub(
        lambda found: f"| [{found[1]}]({_relative(command_pages.path(found[2]), here)}) |", markdown
    )


def _site_link(found: re.Match[str], here: str) -> str:
    """Return the link to a file of the repository as the page ``here`` of the site has it."""
    if found["path"] is None:  # a block of code
        return found[0]
    page = _REPOSITORY_PATHS.get(here, f"{_DOCS}/{here}")
    path = posixpath.normpath(posixpath.join(posixpath.dirname(page), found["path"]))
    return _relative(_SITE_PATHS.get(path, path.removeprefix(f"{_DOCS}/")), here)


def _linked_rule(found: re.Match[str], here: str) -> str:
    id = (found["id"] or "").strip("`")
    if id not in rule_pages.IDS:
        return found[0]
    return f"[{found['id']}]({_relative(rule_pages.path(id), here)}#{id.lower()})"


def _relative(path: str, here: str) -> str:
    return posixpath.relpath(path, posixpath.dirname(here))

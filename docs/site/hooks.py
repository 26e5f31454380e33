"""Hooks for MkDocs: add the home page and the reference to the site, link to the reference, and draw diagrams.

The home page is README.md. The reference is read from the code, so that no fact is written down twice.
"""

from __future__ import annotations

import posixpath
import re
from pathlib import Path

import bridge_classes
import command_pages
import mermaidx
import rule_pages
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

_ROOT = Path(__file__).parents[2]
_CODE_OR_RULE_OR_LINK = re.compile(
    r"^```.*?^```|(?P<id>`?\b[A-Z]{3}[0-9]{3}\b`?)|`[^`\n]+`|\[[^\]\n]*\]\([^)\n]*\)", re.DOTALL | re.MULTILINE
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
| parameters of the node | [Operations](../operations.md#parameters) |
| counters of the bridge | [Operations](../operations.md#the-account) |
| messages of the sample rover | [Messages](../messages.md) |
| classes for templates and targets | [Classes](bridge.md) |
"""


def _reference() -> dict[str, str]:
    """Return the text of every page of the reference by its path."""
    pages = {"reference/index.md": _REFERENCE, "reference/bridge.md": bridge_classes.page()}
    return pages | command_pages.pages() | rule_pages.pages()


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
                {"Classes for templates": "reference/bridge.md"},
                {"Changelog": "changelog.md"},
            ]
        },
    ]
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add README.md as the home page, the changelog, the license and the reference."""
    texts = {
        "index.md": _seen_from_docs((_ROOT / "README.md").read_text(encoding="utf-8")),
        "changelog.md": _seen_from_docs((_ROOT / "CHANGELOG.md").read_text(encoding="utf-8")),
        "LICENSE": (_ROOT / "LICENSE").read_text(encoding="utf-8"),
        **_reference(),
    }
    for path, text in texts.items():
        files.append(File.generated(config, path, content=text))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Draw Mermaid diagrams; link the ids of rules, and the commands in the first column of tables."""
    here = page.file.src_uri
    for number, source in enumerate(_MERMAID.findall(markdown), 1):
        picture = f"{here.removesuffix('.md')}-{number}.svg"
        files.append(File.generated(config, picture, content=mermaidx.render(source).svg()))
        markdown = _MERMAID.sub(f"![diagram]({posixpath.basename(picture)}){{: .diagram }}", markdown, count=1)
    markdown = markdown.replace("](../README.md", f"]({_relative('index.md', here)}")
    if here.startswith("reference/rules"):
        return markdown
    markdown = _CODE_OR_RULE_OR_LINK.sub(lambda found: _linked_rule(found, here), markdown)
    return _COMMAND_CELL.sub(
        lambda found: f"| [{found[1]}]({_relative(command_pages.path(found[2]), here)}) |", markdown
    )


def _linked_rule(found: re.Match[str], here: str) -> str:
    id = (found["id"] or "").strip("`")
    if id not in rule_pages.IDS:
        return found[0]
    return f"[{found['id']}]({_relative(rule_pages.path(id), here)}#{id.lower()})"


def _seen_from_docs(text: str) -> str:
    """Return a page of the repository's top folder with its links as a page in docs/ has them."""
    return re.sub(r'(\]\(|src=")docs/', r"\1", text).replace("](CHANGELOG.md", "](changelog.md")


def _relative(path: str, here: str) -> str:
    return posixpath.relpath(path, posixpath.dirname(here))

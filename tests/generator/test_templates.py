"""Holds the comment at the top of each template to the code: who renders it, and the classes that it receives."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
_TEMPLATES = sorted((ROOT / "templates").rglob("*.j2"))


@pytest.mark.parametrize("template", _TEMPLATES, ids=lambda path: path.name)
def test_a_template_tells_its_reader_where_its_variables_come_from(template: Path) -> None:
    """The comment names files that exist, and classes that these files declare."""
    comment = re.match(r"\{#(.*?)#\}\n", template.read_text(), re.DOTALL)
    assert comment
    assert all((ROOT / path).is_file() for path in re.findall(r"\b[\w/]+\.(?:py|yaml)\b(?!\.j2)", comment[1]))
    declared = re.findall(r"(\w+)(?:, and \w+: (?:list of )?(\w+))? in ([\w/]+\.py)\b(?!\.j2)", comment[1])
    for *classes, path in declared:
        text = (ROOT / path).read_text()
        assert all(f"class {name}" in text for name in classes if name), comment[1]


@pytest.mark.parametrize("template", _TEMPLATES, ids=lambda path: path.name)
def test_the_file_that_renders_a_template_names_it(template: Path) -> None:
    """The Python file, or the template, that the comment names uses the template."""
    if named := re.match(r"\{# Rendered by ([\w/]+\.py)", template.read_text()):
        stem = template.name.removesuffix(".j2").removesuffix(".cpp").removesuffix(".hpp")
        text = (ROOT / named[1]).read_text()
        assert f'{template.name}"' in text or f'"{stem}"' in text

"""Plugins of a package, from the XML files that pluginlib reads."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

from check_launch.catalogue.facts import Plugin


def plugins_of_package(folder: Path) -> Iterator[tuple[str, Plugin]]:
    """Yield the name and the facts of each plugin that the package in a folder describes."""
    for path in sorted(folder.rglob("*.xml")):
        if path.name == "package.xml" or "test" in path.relative_to(folder).parts:
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        if "base_class_type" not in text:
            continue
        try:
            root = ElementTree.fromstring(text)  # noqa: S314  # of a checkout that the maintainer has chosen
        except ElementTree.ParseError:
            continue
        for element in root.iter("class"):
            type_, base = element.get("type", ""), element.get("base_class_type", "")
            if type_ and base:
                yield element.get("name") or type_, _plugin(element, type_, base, folder.name)


def _plugin(element: ElementTree.Element, type_: str, base: str, package: str) -> Plugin:
    written = (child.text.strip() for child in element.iter("message_type") if child.text)
    # Some name their own package instead of the package of the message, as rtabmap_rviz_plugins does.
    messages = tuple(name for name in written if not name.startswith(f"{package}/"))
    return Plugin(re.sub(r"<.*>", "", type_), base, package, messages)

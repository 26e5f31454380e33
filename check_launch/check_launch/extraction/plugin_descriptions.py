"""Plugins of a package, from the XML files that pluginlib reads."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

from check_launch.catalogue.facts import Plugin

_DECLARATION = re.compile(r"<\?xml[^>]*\?>")


def plugins_of_package(folder: Path) -> Iterator[tuple[str, Plugin]]:
    """Yield the name and the facts of each plugin that the package in a folder describes."""
    for path in sorted(folder.rglob("*.xml")):
        if path.name == "package.xml" or "test" in path.relative_to(folder).parts:
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        if "base_class_type" not in text:
            continue
        try:
            # tinyxml2, with which pluginlib reads the file, accepts several elements at the top.
            inside = _DECLARATION.sub("", text)
            root = ElementTree.fromstring(f"<all>{inside}</all>")  # noqa: S314  # nothing is expanded or fetched
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

"""Parameters that generate_parameter_library declares, from its YAML files.

The class that includes the generated header and has a `ParamListener` declares them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from check_launch.catalogue.facts import Parameter

_CALL = re.compile(r"generate_parameter_library\s*\(\s*([\w${}-]+)\s+([\w./${}-]+\.ya?ml)")
_TYPE = re.compile(r"^(bool|int|double|string)(_array)?(?:_fixed_\d+)?$")
_ROS_TYPES = {"int": "integer"}


def parameter_libraries(folder: Path) -> dict[str, dict[str, Parameter]]:
    """Return the parameters of each library in the CMakeLists.txt of a package, by the name of the library.

    The name is that of the generated header without its ending.
    """
    listing = folder / "CMakeLists.txt"
    if not listing.is_file():
        return {}
    text = listing.read_text(encoding="utf-8", errors="replace").replace("${PROJECT_NAME}", folder.name)
    found: dict[str, dict[str, Parameter]] = {}
    for name, path in _CALL.findall(text):
        file = folder / path.removeprefix("${CMAKE_CURRENT_SOURCE_DIR}/")
        if file.is_file():
            try:
                data = yaml.safe_load(file.read_text(encoding="utf-8", errors="replace"))
            except yaml.YAMLError:
                continue
            for inner in data.values() if isinstance(data, dict) else ():
                found[name] = dict(_parameters(inner, ""))
    return found


def _parameters(data: Any, prefix: str) -> Iterator[tuple[str, Parameter]]:
    for name, inner in data.items() if isinstance(data, Mapping) else ():
        # `__map_joints` stands for each name in the value of the parameter joints
        spelled = f"{prefix}{{{name.removeprefix('__map_')}}}" if name.startswith("__map_") else f"{prefix}{name}"
        if isinstance(inner, Mapping) and isinstance(inner.get("type"), str):
            yield spelled, _parameter(inner)
        else:
            yield from _parameters(inner, f"{spelled}.")


def _parameter(stated: Mapping[str, Any]) -> Parameter:
    kind = _TYPE.match(stated["type"])
    minimum, maximum, choices = None, None, ()
    validation = stated.get("validation")
    for rule, given in validation.items() if isinstance(validation, Mapping) else ():
        function, values = str(rule).partition("<")[0], given if isinstance(given, list) else [given]
        if function == "bounds" and len(values) == 2:
            minimum, maximum = values
        elif function in ("gt_eq", "lower_bounds") and values:
            minimum = values[0]
        elif function == "gt" and values and stated["type"] == "int":
            minimum = values[0] + 1
        elif function in ("lt_eq", "upper_bounds") and values:
            maximum = values[0]
        elif function == "one_of" and values and isinstance(values[0], list):
            choices = tuple(values[0])
    is_number = kind is not None and kind[1] in ("int", "double") and not kind[2]
    return Parameter(
        f"{_ROS_TYPES.get(kind[1], kind[1])}{kind[2] or ''}" if kind else "",
        stated.get("default_value"),
        minimum if is_number else None,
        maximum if is_number else None,
        choices,
    )

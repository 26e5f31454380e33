"""Core parameters of RTAB-Map, from the macros RTABMAP_PARAM in its Parameters.h.

The nodes of rtabmap_ros declare each of them as a text, whatever the type of its value is.
"""

from __future__ import annotations

import re
from pathlib import Path

from check_launch.catalogue.facts import Parameter, ParameterSet
from check_launch.extraction.cpp_source import CppSource

_REMOVED = re.compile(
    r"removedParameters_\.insert\(std::make_pair\(\"([^\"]+)\",\s*std::make_pair\(\w+,\s*(?:Parameters::k(\w+)\(\)|\"\")\)\)\)"
)


def core_parameters(checkout: Path) -> ParameterSet:
    """Read the parameters from a checkout of RTAB-Map's library."""
    header = CppSource((checkout / "corelib/include/rtabmap/core/Parameters.h").read_text(encoding="utf-8"))
    found, constants = dict[str, Parameter](), dict[str, str]()
    macros = frozenset({"RTABMAP_PARAM", "RTABMAP_PARAM_STR", "RTABMAP_PARAM_COND"})
    for call in header.calls(macros):
        if len(call.arguments) < 4 or call.arguments[0] == "PREFIX":
            continue
        name = f"{call.arguments[0]}/{call.arguments[1]}"
        default = call.arguments[2] if call.function == "RTABMAP_PARAM_STR" else call.arguments[3]
        is_known = call.function != "RTABMAP_PARAM_COND"
        found[name] = Parameter("string", default.strip('"') if is_known else None)
        constants[call.arguments[0] + call.arguments[1]] = name
    text = (checkout / "corelib/src/Parameters.cpp").read_text(encoding="utf-8")
    renamed = {old: constants.get(new, "") for old, new in _REMOVED.findall(text)}
    return ParameterSet(dict(sorted(found.items())), dict(sorted(renamed.items())))

"""The Python modules of the .proto files: protoc's own, moved into ``pb2`` of the generated package.

protoc imports by the path below the proto root, as if that were the import path; two projects in one environment would
then take each other's modules. Its stubs leave out that an enum field takes a number, and the type of fields that are
named by keywords.
"""

from __future__ import annotations

import re

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header

_IMPORT = re.compile(r"^(from (?!google\.protobuf)(?P<package>[\w.]+) import|import) (?=\w+_pb2\b)", re.MULTILINE)
_STAR_IMPORT = re.compile(r"^from (?!google\.protobuf)(?P<module>[\w.]+_pb2) import", re.MULTILINE)
_MODULE_NAME = re.compile(r"(?<=BuildTopDescriptorsAndMessages\(DESCRIPTOR, ')")
_ENUM_ARGUMENT = re.compile(r"_Union\[(?P<enum>[\w.]+), str\]")
_ENUM_MAP = re.compile(r"_Mapping\[(?P<key>int|bool|str), (?P<enum>[\w.]+)\]")
_MAP_OF_SCALARS = re.compile(r"_containers\.ScalarMap\[(?:int|bool|str), (?P<value>[\w.]+)\]")


def emit(bridge: ir.Bridge) -> Files:
    """Every module of the closure with its stub, and the packages that hold them."""
    packages = {"generated/pb2"}
    for path, text in bridge.modules.items():
        source = path.rpartition("_pb2")[0] + ".proto"
        yield f"generated/pb2/{path}", f"{header(source)}\n{_moved(text, f'{bridge.python_package}.pb2')}"
        parts = path.split("/")[:-1]
        packages |= {"/".join(["generated/pb2", *parts[: depth + 1]]) for depth in range(len(parts))}
    for package in sorted(packages):
        yield f"{package}/__init__.py", header(bridge.table) + "\n"


def _moved(text: str, pb2: str) -> str:
    text = _STAR_IMPORT.sub(lambda match: f"from {pb2}.{match['module']} import", text)
    text = _IMPORT.sub(lambda match: f"from {'.'.join(filter(None, [pb2, match['package']]))} import ", text)
    text = _MODULE_NAME.sub(f"{pb2}.", text)
    text = text.replace("**kwargs) -> None", "**kwargs: object) -> None")
    text = text.replace("_struct_pb2.NullValue", "int")  # protobuf's own stubs have it for no number
    enums = {match["value"] for match in _MAP_OF_SCALARS.finditer(text)} - {"int", "float", "bool", "str", "bytes"}
    text = _ENUM_MAP.sub(lambda match: _open_map(match) if match["enum"] in enums else match[0], text)
    return _ENUM_ARGUMENT.sub(lambda match: f"_Union[{match['enum']}, int, str]", text)


def _open_map(match: re.Match[str]) -> str:
    return f"_Mapping[{match['key']}, _Union[{match['enum']}, int]]"

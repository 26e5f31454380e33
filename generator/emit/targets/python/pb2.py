"""Python modules of the .proto files: protoc's own modules, moved into ``pb2`` of the generated package.

The moved text differs from protoc's output in these points:

- protoc writes absolute imports from the proto root (``from components.common import x_pb2``). Two projects in one
  environment would import each other's modules, so the imports get the generated package as a prefix.
- The module name that protoc passes to ``BuildTopDescriptorsAndMessages`` gets the same prefix; it becomes the
  ``__module__`` of the classes.
- protoc's stubs (.pyi) do not allow a number for an enum field, although protobuf accepts it; `int` is added.
- protoc's modules refuse a protobuf that is older than protoc. They only hand a serialized descriptor to a function
  that protobuf has since 3.20, so the check is left out; another package may then choose an older protobuf.
- If a message has a field whose name is a Python keyword, protoc's stubs declare ``**kwargs`` without a type; the type
  `object` is added.
"""

from __future__ import annotations

import re

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header

# In modules and stubs: `from a.b import x_pb2 as ...`, and `import x_pb2 as ...` for a file in the proto root.
_IMPORT = re.compile(r"^(from (?!google\.protobuf)(?P<package>[\w.]+) import|import) (?=\w+_pb2\b)", re.MULTILINE)
_VERSION_CHECK = re.compile(
    r"^from google\.protobuf import runtime_version as _runtime_version\n"
    r"|^_runtime_version\.ValidateProtobufRuntimeVersion\(.*?^\)\n",
    re.MULTILINE | re.DOTALL,
)
# protoc writes an `import public` as `from a.x_pb2 import *`.
_STAR_IMPORT = re.compile(r"^from (?!google\.protobuf)(?P<module>[\w.]+_pb2) import", re.MULTILINE)
_MODULE_NAME = re.compile(r"(?<=BuildTopDescriptorsAndMessages\(DESCRIPTOR, ')")
# Type of an enum argument in a stub. At run time, protobuf takes the number, too.
_ENUM_ARGUMENT = re.compile(r"_Union\[(?P<enum>[\w.]+), str\]")
_ENUM_MAP = re.compile(r"_Mapping\[(?P<key>int|bool|str), (?P<enum>[\w.]+)\]")
_MAP_OF_SCALARS = re.compile(r"_containers\.ScalarMap\[(?:int|bool|str), (?P<value>[\w.]+)\]")


def emit(bridge: ir.Bridge) -> Files:
    """Yield the module and the stub (.pyi) of each .proto file, and the ``__init__.py`` files of their packages."""
    packages = {"generated/pb2"}
    for source, modules in bridge.modules.items():
        for path, text in modules.items():
            yield f"generated/pb2/{path}", f"{header(source)}\n{_moved(text, f'{bridge.python_package}.pb2')}"
            parts = path.split("/")[:-1]
            packages |= {"/".join(["generated/pb2", *parts[: depth + 1]]) for depth in range(len(parts))}
    for package in sorted(packages):
        yield f"{package}/__init__.py", header(bridge.table) + "\n"


def _moved(text: str, pb2: str) -> str:
    text = _VERSION_CHECK.sub("", text)
    text = _STAR_IMPORT.sub(lambda match: f"from {pb2}.{match['module']} import", text)
    text = _IMPORT.sub(lambda match: f"from {'.'.join(filter(None, [pb2, match['package']]))} import ", text)
    text = _MODULE_NAME.sub(f"{pb2}.", text)
    text = text.replace("**kwargs) -> None", "**kwargs: object) -> None")
    text = text.replace("_struct_pb2.NullValue", "int")  # the stubs of protobuf's library do not accept a number for it
    enums = {match["value"] for match in _MAP_OF_SCALARS.finditer(text)} - {"int", "float", "bool", "str", "bytes"}
    text = _ENUM_MAP.sub(lambda match: _open_map(match) if match["enum"] in enums else match[0], text)
    return _ENUM_ARGUMENT.sub(lambda match: f"_Union[{match['enum']}, int, str]", text)


def _open_map(match: re.Match[str]) -> str:
    return f"_Mapping[{match['key']}, _Union[{match['enum']}, int]]"

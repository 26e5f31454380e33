"""What rosidl reads in .msg texts, for a Python that has its modules: JSON in, JSON out.

On standard input, ``{project: {"package/Name": text}}``; on the last line of standard output, what rosidl's parser of
.idl files has of each, after its adapter made an .idl file of the text.
"""

import json
import sys
import tempfile
from pathlib import Path

from rosidl_adapter.msg import convert_msg_to_idl
from rosidl_parser.definition import AbstractNestedType, IdlLocator, Message, NamespacedType
from rosidl_parser.parser import parse_idl_file


def spelled(type):
    """A type, as this project spells it."""
    if isinstance(type, AbstractNestedType):
        return f"{spelled(type.value_type)}[]"
    if isinstance(type, NamespacedType):
        return "/".join(type.namespaced_name())
    return {"float": "float32", "double": "float64", "boolean": "bool"}.get(
        getattr(type, "typename", "string"), getattr(type, "typename", "string")
    )


def comment(member):
    """The comment of a field, where it has one."""
    said = [one for one in member.get_annotation_values("verbatim") if one.get("language") == "comment"]
    return said[0]["text"] if said else ""


def read(texts):
    """What rosidl reads in the texts of a project."""
    said = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, text in texts.items():
            package, _, message = name.partition("/")
            base = Path(folder, package)
            (base / "msg").mkdir(parents=True, exist_ok=True)
            file = base / "msg" / f"{message}.msg"
            file.write_text(text, encoding="utf-8")
            convert_msg_to_idl(base, package, Path("msg", file.name), base / "msg")
            content = parse_idl_file(IdlLocator(base, Path("msg", f"{message}.idl"))).content
            (found,) = content.get_elements_of_type(Message)
            said[name] = {
                "fields": [[member.name, spelled(member.type)] for member in found.structure.members],
                "comments": {member.name: comment(member) for member in found.structure.members},
                "constants": [[constant.name, constant.value] for constant in found.constants],
            }
    return said


said = {project: read(texts) for project, texts in json.load(sys.stdin).items()}
print(json.dumps(said))

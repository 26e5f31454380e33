"""rosidl's C++ for .msg texts, for a Python that has its modules.

On standard input, ``{"package/Name": text}``; below the folder that is the only argument, the headers of the structs
and the sources of their introspection.
"""

import json
import sys
from pathlib import Path

import rosidl_generator_cpp
import rosidl_typesupport_introspection_cpp
from rosidl_adapter.msg import convert_msg_to_idl

_SHARE = Path("/usr/share")


def main():
    """Generate all of them, a package at a time."""
    folder = Path(sys.argv[1])
    packages = {}
    for name, text in json.load(sys.stdin).items():
        package, _, message = name.partition("/")
        base = folder / "idl" / package
        (base / "msg").mkdir(parents=True, exist_ok=True)
        file = base / "msg" / f"{message}.msg"
        file.write_text(text, encoding="utf-8")
        convert_msg_to_idl(base, package, Path("msg", file.name), base / "msg")
        packages.setdefault(package, []).append(f"{base}:msg/{message}.idl")
    for package, idls in packages.items():
        for generator in (rosidl_generator_cpp, rosidl_typesupport_introspection_cpp):
            arguments = {
                "package_name": package,
                "idl_tuples": idls,
                "ros_interface_dependencies": [],
                "target_dependencies": [],
                "output_dir": str(folder / "include" / package),
                "template_dir": str(_SHARE / generator.__name__ / "resource"),
            }
            file = folder / "arguments.json"
            file.write_text(json.dumps(arguments), encoding="utf-8")
            generator.generate_cpp(str(file))


main()

"""ROS 2 naming rules, and the default names of messages, fields and constants.

The rules are those of rosidl_adapter's parser and, for topics, of rcl:

- A message is in CamelCase, without underscores.
- A field is in lower case with single underscores, and ends in a letter or digit.
- A constant is in upper case, with the same rule for underscores.
- A topic has parts separated by slashes; no part is empty or starts with a digit.

rosidl accepts some names that its generators then cannot compile: keywords of C++ and Python. `unusable` refuses them.
"""

from __future__ import annotations

import keyword
import re

# Patterns of rosidl_adapter (VALID_FIELD_NAME_PATTERN, ...) and of rcl's rules for topics.
_MESSAGE = re.compile(r"[A-Z][A-Za-z0-9]*")
_PACKAGE = re.compile(r"(?!.*__)(?!.*_$)[a-z][a-z0-9_]*")
_FIELD = _PACKAGE
_CONSTANT = re.compile(r"(?!.*__)(?!.*_$)[A-Z][A-Z0-9_]*")
_TOPIC = re.compile(r"(/|~/)?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*")

# The body of a generated dataclass uses these names; a field of the same name would hide them.
_NEEDED_IN_CLASSES = frozenset({"bytes", "dataclasses", "list", "str"})
# rosidl generates a struct member for each field, so a keyword of C++ breaks the build of the interface package.
_CPP_KEYWORDS = frozenset(
    {
        *("alignas", "alignof", "and", "and_eq", "asm", "auto", "bitand", "bitor", "bool", "break", "case"),
        *("catch", "char", "char8_t", "char16_t", "char32_t", "class", "co_await", "co_return", "co_yield"),
        *("compl", "concept", "const", "const_cast", "consteval", "constexpr", "constinit", "continue"),
        *("decltype", "default", "delete", "do", "double", "dynamic_cast", "else", "enum", "explicit", "export"),
        *("extern", "false", "float", "for", "friend", "goto", "if", "inline", "int", "long", "mutable"),
        *("namespace", "new", "noexcept", "not", "not_eq", "nullptr", "operator", "or", "or_eq", "private"),
        *("protected", "public", "register", "reinterpret_cast", "requires", "return", "short", "signed"),
        *("sizeof", "static", "static_assert", "static_cast", "struct", "switch", "template", "this"),
        *("thread_local", "throw", "true", "try", "typedef", "typeid", "typename", "union", "unsigned", "using"),
        *("virtual", "void", "volatile", "wchar_t", "while", "xor", "xor_eq"),
    }
)


def is_message_name(name: str) -> bool:
    """Return True if ROS allows the name for a message."""
    return _MESSAGE.fullmatch(name) is not None


def is_package_name(name: str) -> bool:
    """Return True if ROS allows the name for a package."""
    return _PACKAGE.fullmatch(name) is not None


def is_field_name(name: str) -> bool:
    """Return True if ROS allows the name for a field."""
    return _FIELD.fullmatch(name) is not None


def is_cpp_keyword(name: str) -> bool:
    """Return True if the name is a keyword of C++, in any version up to C++20."""
    return name in _CPP_KEYWORDS


def unusable(name: str) -> str:
    """Return the reason why ``name`` cannot be the name of a ROS field; an empty text if it can.

    >>> unusable("class")
    'it is a Python keyword'
    """
    if keyword.iskeyword(name):
        return "it is a Python keyword"
    if is_cpp_keyword(name):
        return "it is a C++ keyword"
    if name in _NEEDED_IN_CLASSES:
        return "the generated class needs Python's built-in of that name"
    return "" if is_field_name(name) else "a field name has lower-case letters, digits and single underscores"


def is_constant_name(name: str) -> bool:
    """Return True if ROS allows the name for a constant."""
    return _CONSTANT.fullmatch(name) is not None


def is_topic_name(name: str) -> bool:
    """Return True if ROS allows the name for a topic."""
    return _TOPIC.fullmatch(name) is not None


def snake_case(name: str) -> str:
    """Convert a CamelCase name to lower case with underscores, by the rule of rosidl.

    rosidl names the header of a message by this rule, so generated C++ must include the same name.

    >>> snake_case("SensorBoardPHInfo")
    'sensor_board_ph_info'
    """
    # The same two expressions as rosidl's convert_camel_case_to_lower_case_underscore (rosidl_cmake,
    # later rosidl_pycommon).
    name = re.sub(r"(.)([A-Z][a-z]+)", r"\1_\2", name)
    return re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name).lower()


def field_name(proto: str) -> str:
    """Return the default ROS name of a proto field: in lower case, and changed if ROS does not allow it.

    >>> field_name("wheelSpeed"), field_name("two__underscores_"), field_name("class"), field_name("_1st")
    ('wheel_speed', 'two_underscores', 'class_field', 'field_1st')
    """
    name = lowered(proto)
    if not name[:1].isalpha():
        name = f"field_{name}".rstrip("_")
    return f"{name}_field" if unusable(name) else name


def lowered(proto: str) -> str:
    """Convert a name to lower case with single underscores between the words.

    >>> lowered("wheelSpeed__"), lowered("two__underscores")
    ('wheel_speed', 'two_underscores')
    """
    return _single_underscores(snake_case(proto))


def constant_name(proto: str) -> str:
    """Return the default ROS name of an enum value; ROS does not allow the result if it has no letter.

    >>> constant_name("kIdle"), constant_name("MODE__OFF_"), constant_name("IDLE")
    ('K_IDLE', 'MODE_OFF', 'IDLE')
    """
    return _single_underscores(proto if proto.isupper() else snake_case(proto)).upper()


def _single_underscores(name: str) -> str:
    return re.sub("_+", "_", name).strip("_")


def camel_case(name: str) -> str:
    """Convert a name with underscores to CamelCase.

    >>> camel_case("imu_info")
    'ImuInfo'
    """
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


def distinct(name: str) -> str:
    """Return a comparison key for a field name. Two names with the same key would collide in generated code.

    Generated class names and protobuf's JSON names drop underscores and change capitals.

    >>> distinct("imu_info") == distinct("ImuInfo")
    True
    """
    return camel_case(name).lower()


def message_name(proto: str, package: str) -> str:
    """Return the default ROS name of a proto message: its enclosing messages and its name, without the proto package.

    >>> message_name("rover.Arm.Joint", "rover")
    'ArmJoint'
    """
    return camel_case((proto.removeprefix(f"{package}.") if package else proto).replace(".", "_"))

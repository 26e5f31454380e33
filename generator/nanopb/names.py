"""The names that patterns in .options files are matched with."""

from __future__ import annotations

from collections.abc import Iterator

from generator.protos import ProtoMessage


class PatternNames:
    """Names in one file: full ones, unless the file has options by which nanopb shortens those."""

    def __init__(self, declared_package: str, package: str, mangling: str) -> None:
        """``package`` is another name that nanopb shall use for it; empty for none."""
        self._declared = f"{declared_package}." if declared_package else ""
        self._mangling = mangling
        used = package or declared_package
        self._used = f"{_initials(used) if mangling == 'M_PACKAGE_INITIALS' else used}." if used else ""

    def of(self, full_name: str) -> str:
        """The name of something that stands in the file, in a message or not."""
        inner = full_name.removeprefix(self._declared)
        if self._mangling == "M_FLATTEN":
            return inner.rpartition(".")[2]
        return inner if self._mangling == "M_STRIP_PACKAGE" else self._used + inner


def _initials(package: str) -> str:
    return "".join(part[0] for part in package.split(".") if part)


def further_names(message: ProtoMessage) -> Iterator[str]:
    """What else nanopb takes for a part of a message, besides its fields and oneofs."""
    if message.extendable:
        yield "extensions"  # the place in C for what other files add
    for field in message.fields:
        if field.declared_optional:
            yield f"_{field.name}"  # the oneof that protoc makes for `optional` in proto3

"""The functions that say what each value of an enum becomes in a standard message, and the other way round."""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.emit.targets.cpp import cpp_names, layout
from roverlink.generator.emit.targets.cpp.layout import literal
from roverlink.generator.ir.interfaces import Case, Chosen, InterfaceType, Path


class Counterparts:
    """Collects the functions of one feed."""

    def __init__(self) -> None:
        self._functions: dict[str, str] = {}
        self.headers: set[str] = set()
        """What has the constants that they name."""

    def functions(self) -> Iterator[str]:
        """Their texts."""
        yield from self._functions.values()

    def there(self, value: Chosen, path: Path, type: InterfaceType) -> str:
        """The name of the function from an enum's number to what the field at a path of the message has."""
        cases = {case.number: case for case in value.cases}
        lines = ["switch (number) {"]
        for case in cases.values():
            lines += [f"  case {case.number}:  // {case.name}", f"    return {self._case(case, value.holder)};"]
        otherwise = (
            f"return {self._case(value.default, value.holder)};"
            if value.default
            else f"throw roverlink::no_counterpart({layout.text_literal(value.source.dotted)}, number);"
        )
        lines += ["  default:", f"    {otherwise}", "}"]
        about = f"{'.'.join(path)} for a value of {value.source.dotted}."
        return self._add(f"{'_'.join(path)}_of", about, cpp_names.primitive(type.name), "int number", lines)

    def back(self, value: Chosen, path: Path, type: InterfaceType) -> str:
        """The name of the function from what the field has to the enum's number."""
        cases = {case.value: case for case in value.cases}
        lines: list[str] = []
        for case in cases.values():
            lines += layout.block(f"if (value == {self._case(case, value.holder)})", [f"return {case.number};"])
        lines += [f"throw roverlink::no_counterpart({layout.text_literal('.'.join(path))}, value);"]
        about = f"The value of {value.source.dotted} for one of {'.'.join(path)}."
        taken = "const std::string & value" if type.name == "string" else f"{cpp_names.primitive(type.name)} value"
        return self._add(f"{'_'.join(value.source.path)}_from_{'_'.join(path)}", about, "int", taken, lines)

    def _add(self, name: str, about: str, returns: str, parameter: str, lines: list[str]) -> str:
        def text(name: str) -> str:
            return f"{layout.comment(about)}\n{returns} {name}({parameter})\n{{\n{layout.body(lines)}\n}}"

        while self._functions.setdefault(name, text(name)) != text(name):
            name += "_"
        return name

    def _case(self, case: Case, holder: str) -> str:
        if not case.constant:
            return literal(case.value)
        self.headers.add(cpp_names.interface_header(holder))
        return f"{cpp_names.interface_struct(holder)}::{case.constant}"

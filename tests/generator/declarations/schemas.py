"""Random .proto files that compile, laid out as nobody would: any gap of the grammar may hold comments and lines."""

from __future__ import annotations

from random import Random

_SCALARS = ["int32", "uint64", "sint32", "fixed64", "bool", "string", "bytes", "float", "double"]
_WORDS = ["message", "enum", "oneof", "reserved", "option", "optional", "to", "max", "map", "import", "rpc", "stream"]
_GAPS = [
    *("  ", "\t", "\n", " \t ", "\r\n", "\n\n", "\n  "),
    *(" // c{}\n", "\n// c{}\n", "\n// c{}\n// d\n", "\n// c{}\n\n", "\n\n// c{}\n\n// d\n", "//c{}  \n//\n\n"),
    *("/* c{} */", " /* c{} */\n", "\n/* c{}\n * d\n ** e\n */\n", "\n/**\n\t* ä{}\n\n*/ ", "/* c{}\n */ // d\n"),
    *("/**/", "\n// c{}\n/* d */\n", "\n/* c{} */ /* d */\n// int32 x = 4;\n", "/*/ c{} */\t", "\n//\tc{}\n \n"),
]


def proto_text(random: Random) -> str:
    """The text of a file."""
    schema = _Schema(random)
    return _laid_out(random, schema.file())


def _laid_out(random: Random, words: list[str]) -> str:
    """Words with gaps between them: mostly a space, sometimes something worse."""
    plain = random.random() * 0.95
    parts = ["\ufeff"] if random.random() < 0.1 else []
    for number, word in enumerate(words):
        parts += [" " if random.random() < plain else random.choice(_GAPS).format(number), word]
    return "".join(parts) + random.choice(["", "\n", "\n// end\n", " /* end */", "//"])


class _Schema:
    """Makes up declarations as lists of words."""

    def __init__(self, random: Random) -> None:
        self._random = random
        self._syntax = random.choice(["proto2", "proto3", "2023", "2024"])
        self._package = random.choice([[], ["pkg"], ["pkg", ".", "sub"]])
        self._names = 0
        self._types: list[str] = []

    def file(self) -> list[str]:
        keyword = "edition" if self._syntax.startswith("2") else "syntax"
        words = [keyword, "=", f"'{self._syntax}'", ";"]
        words += ["package", *self._package, ";"] if self._package else []
        words += ["import", "'google/protobuf/duration.proto'", ";"] if self._one_in(3) else []
        words += ["option", "java_package", "=", '"a\\"}"', "'{//'", ";"] if self._one_in(3) else []
        for _ in range(self._random.randint(0, 4)):
            words += self._random.choice([self._message, self._message, self._enum, self._empty, self._service])()
        return words

    def _one_in(self, count: int) -> bool:
        return self._random.randrange(count) == 0

    def _name(self, prefix: str) -> str:
        self._names += 1
        return f"{prefix}{self._names}"

    def _visibility(self) -> list[str]:
        return [self._random.choice(["export", "local"])] if self._syntax == "2024" and self._one_in(2) else []

    def _empty(self) -> list[str]:
        return [";"]

    def _service(self) -> list[str]:
        if not self._types:
            return []
        rpc = ["rpc", self._name("Call"), "(", self._types[0], ")", "returns", "(", "stream", self._types[0], ")"]
        return ["service", self._name("S"), "{", *rpc, "{", "option", "deprecated", "=", "true", ";", "}", "}"]

    def _number(self, number: int) -> str:
        return self._random.choice([str(number), hex(number), f"0{number:o}", hex(number).upper().replace("X", "x")])

    # --- messages -----------------------------------------------------------------------------------------------

    def _message(self, depth: int = 0) -> list[str]:
        name = self._name("M")
        numbers = self._random.sample(range(1, 400), 12)
        words = [*self._visibility(), "message", name, "{"]
        for _ in range(self._random.randint(0, 6)):
            kind = self._random.choice(["field"] * 4 + ["oneof", "map", "nested", "reserved", "extensions", "group"])
            if kind == "nested" and depth < 3:
                words += self._random.choice([self._message(depth + 1), self._enum()])
            elif kind == "oneof":
                members = [self._field(numbers.pop(), label=False) for _ in range(2)] if len(numbers) > 2 else []
                fields = [word for member in members for word in member]
                words += ["oneof", self._name("o"), "{", *fields, "}"] if fields else [";"]
            elif kind == "reserved":
                words += self._reserved()
            elif numbers:
                words += self._member(kind, numbers.pop())
        if depth == 0:
            self._types.append("." + ".".join(["".join(self._package), name] if self._package else [name]))
        return [*words, "}"]

    def _member(self, kind: str, number: int) -> list[str]:
        if kind == "extensions" and self._syntax != "proto3":
            return ["extensions", str(50_000 + 4 * number), "to", str(50_003 + 4 * number), ";"]
        if kind == "group" and self._syntax == "proto2":
            return ["repeated", "group", self._name("G"), "=", self._number(number), "{", "}"]
        if kind == "map":
            value = self._random.choice([*_SCALARS, *self._types])
            return ["map", "<", "string", ",", value, ">", self._name("f"), "=", self._number(number), ";"]
        return self._field(number)

    def _field(self, number: int, label: bool = True) -> list[str]:
        labels = {"proto2": ["optional", "required", "repeated"], "proto3": ["", "optional", "repeated"]}
        chosen = self._random.choice(labels.get(self._syntax, ["", "repeated"])) if label else ""
        name = self._random.choice(_WORDS) if self._one_in(6) else "f"
        type = self._random.choice([*_SCALARS, *self._types])
        value = ["[", "deprecated", "=", "false", ",", "json_name", "=", f"'j{number}'", '"];"', "]"]
        words = [chosen] if chosen else []
        return [*words, type, self._name(name), "=", self._number(number), *(value if self._one_in(3) else []), ";"]

    def _reserved(self) -> list[str]:
        start = 1000 + 10 * self._names
        self._names += 1
        name = self._name("r")
        quoted = name if self._syntax.startswith("2") else f'"{name}"'
        return self._random.choice(
            [["reserved", quoted, ";"], ["reserved", str(start), ",", str(start + 2), "to", hex(start + 8), ";"]]
        )

    def _enum(self) -> list[str]:
        words = [*self._visibility(), "enum", self._name("E"), "{"]
        words += ["option", "allow_alias", "=", "true", ";"] if self._one_in(3) else []
        alias = [self._name("V"), "=", "0", ";"] if "allow_alias" in words else []
        words += [self._name("V"), "=", "0", ";", *alias, self._name("V"), "=", "-", "0x7f", "[", "deprecated", "="]
        words += ["true", "]", ";", *self._random.choice([[], [";"], ["reserved", "-", "5", "to", "-", "2", ";"]])]
        return [*words, *(["reserved", "1", "to", "max", ";"] if self._one_in(2) else []), "}"]

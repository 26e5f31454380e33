"""Files laid out as nobody would: any gap of the grammar may hold comments and lines, numbers have other bases."""

from __future__ import annotations

import re
from random import Random

_GAPS = [
    *("  ", "\t", "\n", " \t ", "\r\n", "\n\n", "\n  "),
    *(" // c{}\n", "\n// c{}\n", "\n// c{}\n// d\n", "\n// c{}\n\n", "\n\n// c{}\n\n// d\n", "//c{}  \n//\n\n"),
    *("/* c{} */", " /* c{} */\n", "\n/* c{}\n * d\n ** e\n */\n", "\n/**\n\t* ä{}\n\n*/ ", "/* c{}\n */ // d\n"),
    *("/**/", "\n// c{}\n/* d */\n", "\n/* c{} */ /* d */\n// int32 x = 4;\n", "/*/ c{} */\t", "\n//\tc{}\n \n"),
]
_WORD = re.compile(r"""//[^\n]*|/\*.*?\*/|(?P<word>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|[\w.]+|\S)""", re.DOTALL)
UNUSUAL = [
    """\
syntax = 'proto2'; package pkg . sub; option java_package = "a\\"}" '{//';
message M {
  required group G = 1 { extensions 50000 to 50003, 60000 to max; } ;
  optional string message = 2 [deprecated = false, json_name = "j" '"];']; repeated M enum = 0x3;
  optional int32 to = 017; oneof oneof { M option = 5; bytes reserved = 6; }
  map<string, M> map = 7; reserved 1000, 1002 to 0x3F0; reserved "r";
  extend M.G { optional fixed64 import = 50001; } enum E { option allow_alias = true; A = 0; B = 0; C = -0x7f; }
}
service S { rpc Call(.pkg.sub.M) returns (stream M) { option deprecated = true; } } ;
enum F { F1 = 1 [deprecated = true]; ; reserved -5 to -2; reserved 9 to max, 4; reserved "GONE"; }
""",
    """\
edition = '2024'; import "google/protobuf/duration.proto"; export message M { local enum E { Z = 0; } E optional = 1;
  reserved gone, max; repeated sint32 stream = 2; google.protobuf.Duration rpc = 3; message N { .M.E e = 0X1f; } }
""",
    'edition = "2023"; message M { reserved name; M m = 1; float x = 2; } enum E { A = 0; reserved 1 to max; }',
]
"""Texts with what the other files do not have."""


def laid_out(random: Random, text: str) -> str:
    """The words of a text with gaps between them: mostly a space, sometimes something worse."""
    plain = random.random() * 0.95
    parts = ["\ufeff"] if random.random() < 0.1 else []
    for place, match in enumerate(_WORD.finditer(text)):
        if word := match["word"]:
            gap = " " if random.random() < plain else random.choice(_GAPS).format(place)
            parts += [gap, _number(random, word) if re.fullmatch("[1-9][0-9]*", word) else word]
    return "".join(parts) + random.choice(["", "\n", "\n// end\n", " /* end */", "//"])


def _number(random: Random, word: str) -> str:
    number = int(word)
    return random.choice([word, hex(number), f"0{number:o}", hex(number).upper().replace("X", "x")])

"""Groups of words in names: short forms, synonyms, opposites, and words that change which quantity a name means.

The words of all groups are the vocabulary by which compound words are split.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping

# Short forms of one word; the last word of a group stands for all of them.
_SHORT_FORMS = """
acc accel acceleration; addr address; alt altitude; ang angle; avg mean average; axes axis; bat batt battery; bot
robot; btn button; cal calib calibration; ccw counterclockwise; cfg config configuration; cmd command; cnt count; ctrl
control; cur curr current; cw clockwise; diag diagnostic; dir direction; dist distance; dst dest destination; err
error; freq frequency; fw firmware; gyro gyroscope; hum humidity; hw hardware; id identity identifier; idx index; img
image; l left; lat latitude; len length; lon lng long longitude; max maximum; mid medium; min minimum; msg message;
num number; orient orientation; param parameter; pct percent percentage; pos position; prev previous; pwr power; r
right; ref reference; req request; resp response; rot rotation; rx received receive; sec second; seq sequence; spd
speed; src source; sw software; temp temperature; ts timestamp; tx transmitted transmit; val value; vel velocity; ver
version; volt voltage
"""
# Words for the same thing. Each has a narrower meaning, too: a velocity has a direction, and a speed has none.
_SYNONYMS = """
acknowledge ack confirm; add create; amount count number quantity; argument parameter; attitude orientation rotation;
back rear reverse; begin start; blink flash; course direction heading; delay latency; delete remove; distance range;
duration interval period; end finish stop; engine motor; error failure fault; frequency rate; goal setpoint target;
identifier index sid uid uuid; image picture; kind type category; label name title; lamp light; length size; location
position place; mass weight; none no nothing null nil unknown unspecified undefined unset unused default zero; origin
source; speed velocity; state status; transaction tx; validate valid verify check
"""
# Words that stand beside each other in one message, for values that nobody may mix up. `|` separates the sides.
_OPPOSITES = """
left | right | center centre middle; front forward fore | rear back backward reverse aft; min | max; up | down;
low lower bottom | high upper top; request ask | response reply answer; on | off; read | write; in input incoming
inbound inner inside | out output outgoing outbound outer outside; begin start started | end stop stopped finish halt;
open opened | close closed; enable enabled | disable disabled; first | last; lat | lon | alt; transmit send sent |
receive; primary main master | secondary backup slave; source | destination; roll | pitch | yaw; horizontal | vertical;
north | south | east | west; positive plus | negative minus; internal | external; before | after; old previous | new
next; local | remote; push | pull; clockwise | counterclockwise; from | to; red | green | blue; true | false;
target goal setpoint desired commanded | actual measured; increase | decrease; load | unload; success | failure
"""
NEGATIONS = frozenset({"no", "not", "non", "without"})
_CHANGE_THE_QUANTITY = """
ack average enabled error flag identifier index limit mode offset rate sum threshold timeout total type valid
"""
_FILLERS = "a an and the of to in on is has value data info new old"
PLACEHOLDERS = frozenset({"reserved", "unused", "placeholder", "dummy"})
"""Words that say that a number has no meaning yet."""
# The other words of which the compound words of public .proto trees are made, and of which a robot is.
_PARTS = """
account action app arm auto base bit block board body box byte camera card chain change channel check class client cloud
code color connect country create custom date day description descriptor device display download drop email entity entry
event extra fail field file filter fix flow force format frame free full geo gripper group hash head header health
height hit home host id item json key level limited line link list load log loop map mask match mesh message meta
metadata method model move name net network node non not order page password path play point pool port post power
process proto protocol ready reason remove result row run save scale score screen sensor serial server session set show
sign snapshot space step store stream string system table tag task test text time touch track transaction type update
user view watch web wheel width work world zone
"""
DIRECTED = frozenset({"to", "from", "over", "minus"})
"""Words that give the order of the other words a meaning: `ros_to_board` is not `board_to_ros`."""


_NEGATING_PREFIXES = ("un", "in", "im", "dis", "non")
_SHORTEST_PART = 3


def _groups(table: str) -> list[str]:
    return table.split(";")


_BASES: Mapping[str, str] = {word: group.split()[-1] for group in _groups(_SHORT_FORMS) for word in group.split()}
_ESSES = ("sses", "xes", "ches", "shes")
_NO_PLURAL = ("ss", "us", "is")


def base(word: str) -> str:
    """Return the word that stands for all forms of a word: ``temperature`` for ``temp``, ``label`` for ``labels``.

    Leading zeros of a number are dropped.
    """
    if word.isdigit():
        return str(int(word))
    return _BASES.get(word) or _BASES.get(_singular(word), _singular(word))


def _singular(word: str) -> str:
    if len(word) < 3 or not word.endswith("s") or word.endswith(_NO_PLURAL):
        return word
    if len(word) == 3:
        return word[:-1] if word[:-1] in _BASES else word  # `ids`, but not `gas`
    if word.endswith("ies"):
        return f"{word[:-3]}y"
    return word[:-2] if word.endswith(_ESSES) else word[:-1]


_SYNONYMS_OF: Mapping[str, frozenset[str]] = {
    base(word): frozenset(map(base, group.split())) for group in _groups(_SYNONYMS) for word in group.split()
}


FILLERS = frozenset(map(base, _FILLERS.split()))
CHANGE_THE_QUANTITY = frozenset(map(base, _CHANGE_THE_QUANTITY.split()))
"""Words that make another quantity of a name: the limit of a speed is no speed."""


def _find_sides() -> dict[str, dict[str, int]]:
    found: dict[str, dict[str, int]] = {}
    for group in _groups(_OPPOSITES):
        for side, words in enumerate(group.split("|")):
            for word in words.split():
                found.setdefault(base(word), {})[group] = side
    return found


_SIDES = _find_sides()


def are_synonyms(one: str, other: str) -> bool:
    """Return True if two base forms of words often, but not always, mean the same."""
    return other in _SYNONYMS_OF.get(one, ())


def sides(word: str) -> Mapping[str, int | str]:
    """Return the side of a base form in each group of opposites that contains it; empty if it has no opposite.

    Numbers are a group, and so are single letters: each of them is a side of its own.
    """
    if word.isdigit():
        return {"numbers": word}
    if len(word) == 1:
        return {"letters": word}
    return _SIDES.get(word, {})


def negates(word: str, other: str) -> bool:
    """Return True if a word is another one with a prefix for `not`: ``unset`` for ``set``."""
    return any(word == prefix + other for prefix in _NEGATING_PREFIXES)


_VOCABULARY = frozenset(
    word
    for table in (_SHORT_FORMS, _SYNONYMS, _OPPOSITES, _CHANGE_THE_QUANTITY, _PARTS)
    for word in re.findall("[a-z]+", table)
)


def is_known(word: str) -> bool:
    """Return True if a word stands in a group."""
    return word in _VOCABULARY


def split(word: str, beside: Collection[str]) -> list[str]:
    """Split a compound word into the fewest words of the vocabulary: ``filepath`` -> ``["file", "path"]``.

    ``beside`` are more words that the compound may contain. A word that is no such compound is returned as it is.
    """
    parts: dict[int, list[str]] = {0: []}
    for end in range(0 if is_known(word) else len(word) + 1):
        starts = [start for start in parts if word[start:end] != word and _is_part(word[start:end], beside)]
        if starts:
            parts[end] = min(([*parts[start], word[start:end]] for start in starts), key=len)
    return parts.get(len(word), [word])


def _is_part(word: str, beside: Collection[str]) -> bool:
    return (word in _VOCABULARY or word in beside) and (len(word) >= _SHORTEST_PART or word == "id")

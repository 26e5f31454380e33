"""Names of made-up fields, enum values and messages, chosen so that nobody can dispute which ones mean the same.

Two names mean the same if they differ by spelling, by the order of the words, by an added qualifier or by a usual
abbreviation. They mean different things if they name two quantities, or if one is the opposite of the other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from random import Random

SUBJECTS = ("motor", "battery", "gripper", "boom", "tank", "mast", "wheel", "hull", "drill", "antenna")
QUANTITIES = (
    "voltage",
    "temperature",
    "humidity",
    "pressure",
    "brightness",
    "torque",
    "mass",
    "position",
    "resistance",
)
_ABBREVIATED = {"temperature": "temp", "position": "pos"}
_OPPOSITES = (
    ("left", "right"),
    ("front", "rear"),
    ("min", "max"),
    ("start", "stop"),
    ("x", "y"),
    ("request", "response"),
    ("read", "write"),
)
_OPPOSITE = {**dict(_OPPOSITES), **{second: first for first, second in _OPPOSITES}}
_DOUBTFUL = ("speed", "velocity")
_ACTIVITIES = ("DRIVING", "CHARGING", "HOMING", "SLEEPING", "LIFTING", "TURNING", "DIGGING", "SCANNING", "FLYING")

_BOARDS = ("Arm", "Camera", "Sonar", "Lidar", "Pump", "Winch", "Valve", "Heater", "Beacon", "Radio", "Rover", "Crane")
_ROLES = ("Info", "Report", "Setup", "Sample", "Order", "Limits", "Frame", "Summary")


@dataclass(frozen=True)
class Meaning:
    """A quantity of a subject, or an activity; `side` is a word that has an opposite, or empty."""

    subject: str
    quantity: str
    side: str = ""

    @property
    def doubtful(self) -> bool:
        """True for quantities that some readers take for another one."""
        return self.quantity in _DOUBTFUL

    def field_names(self) -> list[str]:
        """Return names of a field with this meaning."""
        words = [word for word in (self.side, self.subject, self.quantity) if word]
        snake = "_".join(words)
        return [
            snake,
            words[0] + "".join(word.title() for word in words[1:]),
            "_".join([self.quantity, *words[:-1]]),
            f"measured_{snake}",
            "_".join([*words[:-1], _ABBREVIATED.get(self.quantity, self.quantity)]),
        ]

    def value_names(self, prefix: str) -> list[str]:
        """Return names of an enum value with this meaning."""
        words = "_".join(word for word in (self.side.upper(), self.subject) if word)
        return [f"{prefix}_{words}", f"{prefix}_MODE_{words}"]

    def opposite(self) -> Meaning | None:
        """Return the opposite; None if there is none."""
        return replace(self, side=_OPPOSITE[self.side]) if self.side else None

    def in_doubt(self) -> Meaning:
        """Return a meaning that some readers take for this one."""
        return replace(self, quantity=_DOUBTFUL[self.quantity == _DOUBTFUL[0]])


def quantity(random: Random) -> Meaning:
    """Draw the meaning of a field."""
    side = random.choice(sorted(_OPPOSITE)) if random.random() < 0.35 else ""
    word = random.choice(_DOUBTFUL) if random.random() < 0.05 else random.choice(QUANTITIES)
    return Meaning(random.choice(SUBJECTS), word, side)


def another_quantity(random: Random, meaning: Meaning) -> Meaning:
    """Draw another quantity of the same subject."""
    return replace(meaning, quantity=random.choice([word for word in QUANTITIES if word != meaning.quantity]))


def activity(random: Random) -> Meaning:
    """Draw the meaning of an enum value."""
    side = random.choice(sorted(_OPPOSITE)) if random.random() < 0.35 else ""
    return Meaning(random.choice(_ACTIVITIES), "", side)


def another_activity(random: Random, meaning: Meaning) -> Meaning:
    """Draw another activity."""
    return replace(meaning, subject=random.choice([word for word in _ACTIVITIES if word != meaning.subject]))


def type_names(random: Random) -> list[str]:
    """Return names for messages and enums at the top level, each once."""
    names = [board + role for board in _BOARDS for role in _ROLES]
    random.shuffle(names)
    return names

"""Rules about the file of the ledger, mapping.lock."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity


class UnreadableLedger(Rule, id="LED101", severity=Severity.FATAL):
    """The ledger, mapping.lock or accepted-numbers.lock, cannot be read.

    The ledger lists every number that was ever published. Without it, a number could be used again for another payload.

    Bad::

        mapping.lock: fatal[LED101] the ledger cannot be read: Is a directory

    Good::

        $ git checkout mapping.lock
    """


class BrokenLedger(Rule, id="LED102"):
    """A line of the ledger, mapping.lock or accepted-numbers.lock, does not have the form that roverlink writes.

    The file was edited by hand, or merged wrongly. Only roverlink may change it.

    Bad::

        mapping.lock:8:3: error[LED102] this line does not belong to a ledger: 'two: b B'

    Good::

        $ git checkout mapping.lock
    """


class EditedLedger(Rule, id="LED103"):
    """The content of the ledger, mapping.lock or accepted-numbers.lock, does not match its checksum.

    The file was edited, or a part of it is missing. A number that is removed from the ledger looks free, although
    boards still send it.

    Bad::

        mapping.lock: error[LED103] the checksum is wrong: the file was edited, or a part of it is missing

    Good::

        $ git checkout mapping.lock
    """


class DeletedLedger(Rule, id="LED104"):
    """The ledger, mapping.lock or accepted-numbers.lock, is missing, but git's last commit contains it.

    A new ledger would only know the numbers of today. Older numbers would look free.

    Bad::

        mapping.lock: error[LED104] the ledger was deleted; without it, the numbers in it look free

    Good::

        $ git checkout mapping.lock
    """


LEDGER_RULES = (UnreadableLedger, BrokenLedger, EditedLedger, DeletedLedger)
"""All rules about the file of the ledger."""

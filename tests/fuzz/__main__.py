"""Fuzz a parser with atheris, which looks for inputs that reach new code.

``python tests/fuzz datagram -max_total_time=60``; what follows the target goes to libFuzzer. Needs the extra ``fuzz``.
"""

from __future__ import annotations

import sys

try:
    import atheris
except ImportError:
    sys.exit("atheris is not installed; it has wheels for Python 3.11 and newer: pip install '.[fuzz]'")

with atheris.instrument_imports():
    from targets import TARGETS


def main() -> None:
    """Fuzz until a fault is found, or as long as libFuzzer was told."""
    if len(sys.argv) < 2 or sys.argv[1] not in TARGETS:
        sys.exit(f"say which target: {', '.join(TARGETS)}")
    target = TARGETS[sys.argv.pop(1)]
    atheris.Setup(sys.argv, target)
    atheris.Fuzz()


if __name__ == "__main__":
    main()

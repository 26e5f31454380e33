"""Times every conversion of a project on a ready payload, in turn, and prints microseconds by topic as JSON.

python -m bench.conversion_calls PROJECT ROUNDS
"""

import json
import sys
import timeit
from collections.abc import Callable
from functools import partial

from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import load_registry
from roverlink.runtime.interfaces import Time

CALLS = 1_000


def main(project: str, rounds: str) -> None:
    """Print the best round of each."""
    registry = load_registry(project)
    calls: dict[str, Callable[[], object]] = {}
    for handler in (*registry.handlers, *registry.extra_topics):
        calls[handler.route.topic] = partial(handler.to_cdr, payload_at(handler.payload_type, 1.0), Time(1, 2))
    found = dict.fromkeys(calls, float("inf"))
    for _ in range(int(rounds)):  # each in turn, so that a busy moment of the machine meets them all
        for topic, call in calls.items():
            found[topic] = min(found[topic], timeit.timeit(call, number=CALLS) / CALLS * 1e6)
    print(json.dumps(found))


if __name__ == "__main__":
    main(*sys.argv[1:])

"""The order in which a middleware serves its topics."""

from __future__ import annotations

from roverlink.runtime.middleware.serving import ServedTopic, serve


class _Topics:
    """Topics with queues, and a record of what was handled."""

    def __init__(self, **queues: int) -> None:
        self.queues = dict(queues)
        self.handled: list[tuple[str, int]] = []

    def topic(self, name: str, priority: int) -> ServedTopic:
        """A topic whose reader takes from the queue of this name."""
        topics = self

        class Reader:
            def take(self, most: int) -> list[bytes]:
                taken = min(most, topics.queues[name])
                topics.queues[name] -= taken
                return [b""] * taken

        return ServedTopic(Reader(), lambda messages: self._handle(name, len(messages)), priority)

    def _handle(self, name: str, count: int) -> None:
        self.handled.append((name, count))
        if name != "urgent":
            self.queues["urgent"] += 1


def test_an_urgent_topic_waits_for_one_small_batch_only() -> None:
    """An urgent message that arrives while others are handled comes before the next topic; these have small batches."""
    topics = _Topics(urgent=0, first=100, second=100)
    served = [topics.topic("urgent", 9), topics.topic("first", 0), topics.topic("second", 0)]
    serve(served, served[1:])
    assert topics.handled == [("first", 8), ("urgent", 1), ("second", 8)]


def test_topics_of_one_priority_have_large_batches() -> None:
    """Without an urgent topic, a batch is large, but not endless: the other topics get their turn."""
    topics = _Topics(urgent=0, first=100, second=5)
    served = [topics.topic("first", 0), topics.topic("second", 0)]
    serve(served, served)
    assert topics.handled == [("first", 64), ("second", 5)]

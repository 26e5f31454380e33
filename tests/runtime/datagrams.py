"""Datagrams that go wrong: random bytes, and valid envelopes that were damaged on the way."""

from __future__ import annotations

import random
from collections.abc import Iterator

from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import Registry


def valid(registry: Registry, generator: random.Random) -> bytes:
    """The envelope of any payload, empty or filled; a few have an enum value that does not fit the ROS message."""
    handler = generator.choice(registry.handlers)
    payload = handler.payload_type()
    if generator.random() < 0.9:
        payload = payload_at(handler.payload_type, generator.uniform(0, 100))
    for field in payload.DESCRIPTOR.fields:
        if field.enum_type is not None and generator.random() < 0.05:
            setattr(payload, field.name, 300)
    envelope = registry.envelope(**{handler.route.name: payload})
    return envelope.SerializeToString()


def hostile(registry: Registry, count: int, seed: int) -> Iterator[bytes]:
    """Random datagrams, and valid ones that were changed in up to four places; the same ones for the same seed."""
    generator = random.Random(seed)  # noqa: S311  # a failing run must be repeatable
    stock = [valid(registry, generator) for _ in range(500)]
    for _ in range(count):
        if generator.random() < 0.15:
            yield generator.randbytes(generator.randrange(80))
            continue
        data = bytearray(generator.choice(stock))
        for _ in range(generator.randrange(5)):
            _damage(data, stock, generator)
        yield bytes(data)


def _damage(data: bytearray, stock: list[bytes], generator: random.Random) -> None:
    place = generator.randrange(len(data) + 1)
    kind = generator.randrange(8)
    if kind == 0 and data:
        data[place - 1] ^= 1 << generator.randrange(8)
    elif kind == 1 and data:
        data[place - 1] = generator.choice((0, 1, 0x7F, 0x80, 0xFF, generator.randrange(256)))
    elif kind == 2:
        del data[place:]
    elif kind == 3:
        del data[place : place + generator.randrange(5)]
    elif kind == 4:
        data[place:place] = generator.randbytes(generator.randrange(6))
    elif kind == 5:
        data += bytes(generator.randrange(20))
    elif kind == 6:
        data += generator.choice(stock)
    else:
        data[place:] = generator.choice(stock)[place:]

"""ROS 2 graph over zenoh: the entities that the tokens of all nodes announce."""

from __future__ import annotations

import logging
import threading
from collections import defaultdict
from collections.abc import Callable
from functools import partial
from typing import Any

import zenoh

from roverlink.runtime.core.handler import Qos
from roverlink.runtime.middleware.dds_names import ros_type_name
from roverlink.runtime.middleware.protocol import Endpoint
from roverlink.runtime.middleware.zenoh_keys import (
    ADMIN_SPACE,
    CLIENT,
    PUBLISHER,
    SERVICE,
    SUBSCRIPTION,
    Entity,
    entity_of,
)

_PARTNERS = {PUBLISHER: SUBSCRIPTION, SUBSCRIPTION: PUBLISHER, SERVICE: CLIENT, CLIENT: SERVICE}


class ZenohGraph:
    """Entities of a domain that exist now. Several threads may ask."""

    def __init__(self, session: Any, domain: int, later: Callable[[Callable[[], None]], None]) -> None:
        """Start to listen; ``later`` calls a function on another thread than that of zenoh."""
        self._session, self._later = str(session.zid()), later
        self._lock = threading.Lock()
        self._entities: dict[str, Entity] = {}
        self._by_name: dict[str, dict[str, Entity]] = defaultdict(dict)
        self._told: set[tuple[str, str]] = set()
        # Called by zenoh's own thread. With a queue in between, a token could be known after the data that follows it.
        handler = zenoh.handlers.Callback(self._take, indirect=False)
        self._subscriber = session.liveliness().declare_subscriber(f"{ADMIN_SPACE}/{domain}/**", handler, history=True)

    def has(self, kind: str, entity: Entity) -> bool:
        """Return true if an entity of a kind exists with the name, type and type hash of ``entity``."""
        with self._lock:
            return any(one.kind == kind and _same(one, entity) for one in self._by_name.get(entity.name, {}).values())

    def endpoints(self, topic: str, publishing: bool) -> list[Endpoint]:
        """Return the publishers or the subscriptions of a fully qualified topic."""
        kind = PUBLISHER if publishing else SUBSCRIPTION
        with self._lock:
            found = [one for one in self._by_name.get(topic, {}).values() if one.kind == kind]
        return [
            Endpoint(one.node.full_name, Qos(one.qos.reliability, one.qos.durability), (), ros_type_name(one.type))
            for one in found
        ]

    def topics(self) -> dict[str, str]:
        """Return the fully qualified topics that have publishers, each with the ROS name of its message type."""
        with self._lock:
            return {one.name: ros_type_name(one.type) for one in self._entities.values() if one.kind == PUBLISHER}

    def _take(self, sample: Any) -> None:
        token = str(sample.key_expr)
        entity = entity_of(token)
        if entity is None:
            return
        with self._lock:
            if sample.kind == zenoh.SampleKind.PUT:
                self._entities[token] = self._by_name[entity.name][token] = entity
                self._compare(entity)
            else:
                self._entities.pop(token, None)
                self._by_name[entity.name].pop(token, None)

    def _compare(self, entity: Entity) -> None:
        """Log a warning if an entity of another node and one of ours have one name, but different data keys."""
        for other in self._by_name[entity.name].values():
            ours, theirs = (entity, other) if entity.session == self._session else (other, entity)
            fault = entity.name, theirs.node.full_name
            if (
                ours.session == self._session != theirs.session
                and _PARTNERS.get(ours.kind) == theirs.kind
                and not _same(ours, theirs)
                and fault not in self._told
            ):
                self._told.add(fault)
                self._later(partial(_warn, ours, theirs))


def _warn(ours: Entity, theirs: Entity) -> None:
    logging.getLogger("roverlink").warning(
        "%s: nothing passes between this node and %s, whose type is %s (%s) instead of %s (%s); build both from the "
        "same definitions, and set ROS_DISTRO to the distribution of the other nodes",
        ours.name,
        theirs.node.full_name,
        ros_type_name(theirs.type),
        theirs.hash,
        ros_type_name(ours.type),
        ours.hash,
    )


def _same(one: Entity, other: Entity) -> bool:
    return (one.name, one.type, one.hash) == (other.name, other.type, other.hash)

"""The repository's registry as other tables would make it."""

from __future__ import annotations

import dataclasses
from typing import Any

from roverlink.runtime import Registry
from roverlink.runtime.core.registry import AnyHandler


def changed(registry: Registry, name: str, /, **changes: Any) -> Registry:
    """A registry whose row of a name says something else."""
    return dataclasses.replace(
        registry,
        handlers=tuple(
            _with_route(handler, **changes) if handler.route.name == name else handler for handler in registry.handlers
        ),
    )


def unguarded(registry: Registry) -> Registry:
    """A registry whose rows send nothing by themselves."""
    return dataclasses.replace(
        registry, handlers=tuple(_with_route(handler, deadman=None) for handler in registry.handlers)
    )


def of_peers(registry: Registry, **changes: dict[str, Any]) -> Registry:
    """A registry whose peers, by name, say something else."""
    return dataclasses.replace(
        registry, peers=tuple(dataclasses.replace(peer, **changes.get(peer.name, {})) for peer in registry.peers)
    )


def _with_route(handler: AnyHandler, **changes: Any) -> AnyHandler:
    route = dataclasses.replace(handler.route, **changes)
    made: AnyHandler = type(type(handler).__name__, (type(handler),), {"route": route})()
    return made

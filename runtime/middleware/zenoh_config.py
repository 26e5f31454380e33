"""Sessions of zenoh, configured as rmw_zenoh_cpp configures its own: by a file, and by single values on top of it."""

from __future__ import annotations

import json
import logging
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import zenoh

from roverlink.runtime.core.errors import MiddlewareError

SESSION_FILE, ROUTER_FILE = "ZENOH_SESSION_CONFIG_URI", "ZENOH_ROUTER_CONFIG_URI"
OVERRIDE = "ZENOH_CONFIG_OVERRIDE"
_START = "start it with `roverlink zenoh-router` or `ros2 run rmw_zenoh_cpp rmw_zenohd`"
# Reconnect within a second or two of the return of a link. rmw_zenoh waits up to 4 s, and ends a link that is silent
# for a minute; zenoh's default is 10 s. What TCP has kept for an ended link is never delivered.
_RETRY = {"period_init_ms": 500, "period_max_ms": 1000, "period_increase_factor": 2}
_COMMON: Mapping[str, object] = {
    "connect/retry": _RETRY,
    "connect/timeout_ms": {"router": -1, "peer": -1, "client": 10_000},
    "connect/exit_on_failure": {"router": False, "peer": False, "client": True},
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": True,
    "timestamping/enabled": True,  # latched topics need it
    "transport/unicast/open_timeout": 2000,
}
_SESSION: Mapping[str, object] = {
    "mode": "peer",
    "connect/endpoints": ["tcp/localhost:7447"],
    "listen/endpoints": ["tcp/localhost:0"],
    "queries_default_timeout": 600_000,
    **_COMMON,
}
_ROUTER: Mapping[str, object] = {"listen/endpoints": ["tcp/[::]:7447"], "scouting/delay": 0, **_COMMON}
_OVERRIDDEN = re.compile(r'\s*([\w/]+)=((?:"[^"]*"|[^";])*)(?:;|$)')
"""One value of ``ZENOH_CONFIG_OVERRIDE``: ``mode="client";connect/endpoints=["tcp/10.0.0.5:7447"]``."""


def open_session() -> Any:
    """Open the session of a node. Raises `MiddlewareError` if this is not possible; warns if messages may not pass."""
    config = _config(SESSION_FILE, _SESSION)
    session = _open(config)
    for text in filter(None, (_missing_router(session, config), *_doubts(config))):
        logging.getLogger("roverlink").warning("%s", text)
    return session


def examine() -> tuple[str, list[str]]:
    """Open the session of a node for a moment; return which router answers, and texts about what may not pass.

    Raises `MiddlewareError` if zenoh refuses the configuration, or no router answers.
    """
    config = _config(SESSION_FILE, _SESSION)
    with _open(config) as session:
        if missing := _missing_router(session, config):
            raise MiddlewareError(missing)
        return f"a router answers at {_named(_of_mode(config, 'connect/endpoints'))}", list(_doubts(config))


def _missing_router(session: Any, config: Any) -> str:
    """Return a text if no router answers a session; empty if one does."""
    if session.info.routers_zid():
        return ""
    return (
        f"no zenoh router answers at {_named(_of_mode(config, 'connect/endpoints'))}, and nodes cannot find each other "
        f"without one: {_START}"
    )


def _doubts(config: Any) -> Iterator[str]:
    """Yield a text for each value of a configuration with which messages may not arrive."""
    connected, listening = (_of_mode(config, f"{what}/endpoints") or () for what in ("connect", "listen"))
    if _mode(config) == "peer" and not any(map(_is_local, connected)) and all(map(_is_local, listening)):
        yield (
            f"this node is a peer of the router at {_named(connected)}, which passes nothing between peers, and nodes "
            f'on other computers cannot reach it: set mode="client" in {SESSION_FILE} or {OVERRIDE}'
        )
    if not _of_mode(config, "timestamping/enabled"):
        yield (
            "zenoh adds no timestamps, so no latched topic (transient_local) that is best effort can be published: set "
            f"timestamping/enabled=true in {SESSION_FILE} or {OVERRIDE}"
        )


def _mode(config: Any) -> str:
    return json.loads(config.get_json("mode")) or "peer"


def _of_mode(config: Any, key: str) -> Any:
    """Return a value of a configuration, which may be an object with one value for each mode."""
    value = json.loads(config.get_json(key))
    return value.get(_mode(config)) if isinstance(value, dict) else value


def _is_local(endpoint: str) -> bool:
    return re.match(r"[\w-]+/(localhost|127\.|\[::1\])", endpoint) is not None


def _named(endpoints: Sequence[str]) -> str:
    return ", ".join(endpoints) or "any address"


def open_router(endpoints: Sequence[str]) -> Any:
    """Open a session that is a router. Raises `MiddlewareError` if it cannot listen on the endpoints."""
    config = _config(ROUTER_FILE, _ROUTER)
    config.insert_json5("mode", '"router"')  # the override may be meant for the nodes in the same shell
    if endpoints:
        config.insert_json5("listen/endpoints", json.dumps([*endpoints]))
    return _open(config)


def _config(variable: str, defaults: Mapping[str, object]) -> Any:
    """Return the configuration from the file that an environment variable names, else from ``defaults``."""
    source = variable
    try:
        if path := os.environ.get(variable):
            config = zenoh.Config.from_file(path)
        else:
            config = zenoh.Config()
            for key, value in defaults.items():
                config.insert_json5(key, json.dumps(value))
        source, rest = OVERRIDE, os.environ.get(OVERRIDE, "")
        while rest.strip():
            if (one := _OVERRIDDEN.match(rest)) is None:
                raise MiddlewareError(f"{OVERRIDE}: {rest!r} is not KEY=VALUE;KEY=VALUE, with values in JSON5")
            config.insert_json5(one[1], one[2])
            rest = rest[one.end() :]
    except (zenoh.ZError, OSError) as error:
        raise MiddlewareError(f"zenoh refuses {source}={os.environ.get(source)!r}: {reason_of(error)}") from error
    return config


def _open(config: Any) -> Any:
    # RUST_LOG=info shows what zenoh refuses, and why.
    zenoh.try_init_log_from_env()  # type: ignore[no-untyped-call]  # zenoh's stub does not say that it returns nothing
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        advice = f"; if the router does not run, {_START}" if _mode(config) == "client" else ""
        raise MiddlewareError(f"zenoh cannot open a session: {reason_of(error)}{advice}") from error


def reason_of(error: Exception) -> str:
    """Return the text of an error in one line, without the places in zenoh's source code."""
    return " ".join(re.sub(r"\s+at \S+\.rs:\d+\.?", "", str(error)).split())

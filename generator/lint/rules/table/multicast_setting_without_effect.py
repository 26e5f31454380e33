"""A peer or a board has `interface` or `ttl`, but its host is not a multicast group.

Both settings are for datagrams to a multicast group, which several computers receive. A multicast group is an IP
address from 224.0.0.0 to 239.255.255.255, or one that begins with ff. For other addresses, the routes of the computer
decide.

Bad::

    peers:
      radio: {host: 10.0.0.7, interface: eth0}

Good::

    peers:
      radio: {host: 239.0.0.7, interface: eth0}
"""

from __future__ import annotations

from collections.abc import Iterator
from ipaddress import ip_address

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context

RULE = Rule("TAB117", "multicast-setting-without-effect", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each `interface` and `ttl` of a peer or board without a multicast group."""
    for peer in context.table.peers:
        for settings, end in peer.ends:
            unread = "host" in settings.spans and not settings.hosts  # a mistake that is reported on its own
            if unread or any(map(_is_group, settings.hosts)):
                continue
            for key in ("interface", "ttl"):
                if key in settings.spans:
                    message = f"`{key}` of {end.name!r} has no effect, because its host is not a multicast group"
                    help = f"remove `{key}`, or write a multicast group as `host`, such as 239.0.0.7"
                    yield RULE.at(settings.at(key), message, help)


def _is_group(host: str) -> bool:
    try:
        return ip_address(host).is_multicast
    except ValueError:
        return False

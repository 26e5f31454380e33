"""Checks of ``roverlink doctor``: Python packages, generated code, UDP port, firewall, multicast, and ROS 2.

Each check examines one thing and returns its result as a `CheckResult`. It changes nothing on the machine.
"""

from __future__ import annotations

import dataclasses
import os
import platform
import re
import shutil
import socket
import struct
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from logging import getLogger
from pathlib import Path

from roverlink import doctor_link
from roverlink.console import TABLE, project_folder
from roverlink.generated_code import load_project
from roverlink.generator.diagnostics import DiagnosticsError
from roverlink.generator.pipeline import compile_table
from roverlink.installed_packages import EXTRAS, installed_version, with_extras
from roverlink.numerals import counted
from roverlink.runtime import MiddlewareError, Registry, RoverlinkError
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces.diagnostic_msgs import DiagnosticArray
from roverlink.runtime.middleware import (
    NodeIdentity,
    can_import,
    dds_cure,
    examine_zenoh,
    open_middleware,
    selected,
)
from roverlink.runtime.middleware.interface_packages import installed_class
from roverlink.runtime.middleware.ros_domain import ros_domain
from roverlink.runtime.native.core import NoCoreError, open_core
from roverlink.runtime.net import hosts, udp
from roverlink.runtime.net.transports import transport_at
from roverlink.runtime.ros_arguments import parameters
from roverlink.runtime.ros_arguments.parameters import Parameters
from roverlink.runtime.ros_arguments.ros_args import RosArguments
from roverlink.runtime.text.host_names import LEARN

_NEEDED = ("protobuf", "pyyaml", "jinja2", "black", "rich", "grpcio-tools")
_GROUP = "239.255.0.1"  # multicast group in which DDS participants announce themselves (RTPS 2.2, 9.6.1)
_PROC = Path("/proc")
_COMMAND_S = 5.0


@dataclass(frozen=True)
class CheckResult:
    """Result of one check of ``roverlink doctor``."""

    verdict: str
    """``ok``, ``warning`` or ``error``."""
    check: str
    """Name of the thing that was checked, such as ``firewall`` or ``UDP port 5000``."""
    says: str
    """Text with the result, such as ``no active firewall found``."""
    cure: str = ""
    """Command or advice that solves the problem; empty if nothing has to be done."""

    def as_dict(self) -> dict[str, str]:
        """Return the result as a dictionary for JSON, with the keys ``verdict``, ``check``, ``says`` and ``cure``."""
        return dataclasses.asdict(self)


def examine(
    project: Path | None, ros: RosArguments, pins: Sequence[Path] = (), end: str = "", middleware: str = "auto"
) -> list[CheckResult]:
    """Run all checks and return their results. A check that fails is a result, not an exception.

    ``project`` is the folder of the project; None for the nearest one, from the current folder upwards. ``ros`` holds
    the parameters of the bridge to check, such as its UDP port. ``pins`` are files and repositories that say which
    commit of the .proto files other projects use. ``end`` is the peer or board that this computer is, if it is not the
    rover. ``middleware`` is the connection to ROS 2 that is checked. Raises `DiagnosticsError` if ``pins`` cannot be
    read.
    """
    pinned = None
    if pins:  # imported here: the lint is slow to import, and few users of doctor need it
        from roverlink.pinned_schemas import PinnedSchemas

        pinned = PinnedSchemas(project_folder(project) / TABLE, pins)
    found, registry = list(_python()), None
    examined = "generated code"
    try:
        registry = load_project(project_folder(project), end)
        messages, fingerprint = counted(len(registry.handlers), "message"), registry.fingerprint[:12]
        found.append(CheckResult("ok", examined, f"{messages}, fingerprint of the table {fingerprint}"))
        found += [*_table(project_folder(project)), *_native_core(registry)]
        examined = "parameters"
        settings = parameters.read(registry, ros.parameters_in(parameters.declarations(registry), getLogger()))
    except RoverlinkError as error:
        found.append(CheckResult("error", examined, str(error)))
        says = "UDP port, receive buffer, dst_ip and firewall were not checked, because the parameters are unknown"
        found.append(CheckResult("warning", "not checked", says, "correct the error above, and run the command again"))
    else:
        found += [*_network(registry, settings), *_firewall(settings)]
        found += [CheckResult(*verdict) for verdict in doctor_link.verdicts(registry, settings, pinned)]
    name = selected(middleware)
    return [*found, *(_multicast() if name in ("dds", "rclpy") else ()), *_ros(registry, name)]


# --- this Python ------------------------------------------------------------------------------------------------


def _python() -> Iterator[CheckResult]:
    version = platform.python_version()
    yield CheckResult("ok", "python", f"version {version} on {platform.system()} {platform.machine()}")
    for package in _NEEDED:
        if installed_version(package) is None:
            yield CheckResult(
                "error",
                package,
                "roverlink needs this Python package, but it is not installed",
                f"{sys.executable} -m pip install {package}",
            )
    if missing := {package: extra for package, extra in EXTRAS.items() if installed_version(package) is None}:
        names = ", ".join(f"{extra} ({package})" for package, extra in missing.items())
        says = f"these extras of roverlink (and their packages) are not installed: {names}"
        yield CheckResult("ok", "extras", says, f"if you need them, {with_extras(missing.values())}")


# --- the table --------------------------------------------------------------------------------------------------


def _table(project: Path) -> Iterator[CheckResult]:
    """Warn if the generated code is that of another table: the bridge does not read the table itself."""
    if not (project / TABLE).exists():  # a rover may carry the generated code alone
        return
    try:
        changes = compile_table(project / TABLE).changes(project)
    except DiagnosticsError:
        says = "the table has errors, so it was not compared with the generated code"
        yield CheckResult("warning", TABLE, says, "`roverlink generate` shows the errors")
        return
    # A file that today's table does not make may come from an option of `generate`.
    if changed := [change.path for change in changes if change.verb != "removed"]:
        where = counted(len(changed), "file")
        says = f"the generated code is not that of this table (a difference in {where}); the bridge uses the code"
        yield CheckResult("warning", TABLE, says, "roverlink generate")


def _native_core(registry: Registry) -> Iterator[CheckResult]:
    """Say which messages the native core translates. Python translates the others to the same, but more slowly."""
    try:
        core = open_core(registry)
    except NoCoreError as error:
        yield CheckResult("ok", "native core", f"Python translates all messages, because {error}")
        return
    for topic, reason in core.unsupported.items():
        yield CheckResult("ok", "native core", f"Python translates the messages on {topic}, because {reason}")
    native = len(registry.by_topic) - len(core.unsupported)
    yield CheckResult("ok", "native core", f"it translates the messages on {counted(native, 'topic')}")


# --- the network ------------------------------------------------------------------------------------------------


def _network(registry: Registry, settings: Parameters) -> Iterator[CheckResult]:
    port, address = settings.listen_port, settings.listen_address
    try:
        sock = udp.bind(address, port, settings.receive_buffer)
    except RoverlinkError as error:
        holder = _holder(port)
        used = f"it is used by {holder}" if holder else "`sudo ss -lunp` shows the programs that use UDP ports"
        cure = f"{used}; another port is set with --ros-args -p listen_port:=PORT"
        yield CheckResult("error", f"UDP port {port}", str(error), cure)
    else:
        with sock:
            yield CheckResult("ok", f"UDP port {port}", f"no other program uses it on the address {address}")
            yield _buffer(udp.receive_buffer(sock), settings.receive_buffer)
    yield from _hosts(registry, settings)


def _hosts(registry: Registry, settings: Parameters) -> Iterator[CheckResult]:
    """Check the hosts to which datagrams are sent, once for each parameter that names hosts."""
    for parameter in dict.fromkeys(end.host_parameter for end in registry.ends.values()):
        ends = [name for name, end in registry.ends.items() if end.host_parameter == parameter]
        named, what = settings.addresses[ends[0]].hosts, ", ".join(map(str, ends))
        if named == (LEARN,):
            yield CheckResult("ok", parameter, f"the address of {what} is that of its last valid datagram")
            continue
        if settings.addresses[ends[0]].is_line:
            yield _line(parameter, named[0], what)
            continue
        for host in named:
            try:
                found = hosts.look_up(host, settings.addresses[ends[0]].port)[0]
            except (OSError, UnicodeError) as error:
                says = f"{host}, the host of {what}, cannot be resolved: {hosts.reason_of(error)}"
                cure = f"switch it on, or set another host with --ros-args -p {parameter}:=ADDRESS"
                yield CheckResult("warning", parameter, says, cure)
            else:
                yield CheckResult("ok", parameter, f"datagrams for {what} go to {found[0]}")
                if len(found) != 2 and ":" not in settings.listen_address:
                    says = f"{what} has the IPv6 address {found[0]}, but listen_address receives only IPv4"
                    yield CheckResult("warning", parameter, says, "add --ros-args -p listen_address:=\"'::'\"")


def _line(parameter: str, host: str, what: str) -> CheckResult:
    """Connect once over the line of an end."""
    transport = transport_at(host)
    try:
        transport.connect().close()
    except OSError as error:
        cure = f"connect it, or set another host with --ros-args -p {parameter}:=ADDRESS"
        if isinstance(error, PermissionError):
            cure = "sudo usermod -aG dialout $USER, then log in again"
        return CheckResult("warning", parameter, f"{host}, the line of {what}: {error.strerror or error}", cure)
    finally:
        transport.close()
    return CheckResult("ok", parameter, f"the line of {what} opens: {host}")


def _buffer(got: int, wanted: int) -> CheckResult:
    if got >= wanted:
        return CheckResult("ok", "receive buffer", f"{got} bytes (the bridge requests {wanted})")
    says = f"{got} bytes instead of {wanted}, so datagrams may be lost when many arrive at once"
    setting = f"net.core.rmem_max={wanted}"
    cure = f"sudo sysctl -w {setting}; to keep this setting, write `{setting}` to /etc/sysctl.d/60-roverlink.conf"
    return CheckResult("warning", "receive buffer", says, cure)


def _holder(port: int) -> str:
    """Return the name of the program that uses a UDP port, such as ``python3 (process 4711)``.

    Return an empty text if the program is not found, for example because it belongs to another user.

    The columns of /proc/net/udp are in proc(5); the tenth is the socket's inode. A process that uses the socket has a
    link to ``socket:[inode]`` among its file descriptors.
    """
    try:
        lines = (_PROC / "net" / "udp").read_text().splitlines()[1:]
    except OSError:
        return ""
    # Ports are in hexadecimal, in host byte order.
    inodes = {fields[9] for line in lines if (fields := line.split())[1].endswith(f":{port:04X}")}
    for process in _PROC.glob("[0-9]*"):
        try:
            links = {os.readlink(descriptor) for descriptor in (process / "fd").iterdir()}
            if links & {f"socket:[{inode}]" for inode in inodes}:
                return f"{(process / 'comm').read_text().strip()} (process {process.name})"
        except OSError:
            continue  # a process of another user, or one that has ended
    return ""


# --- firewall and multicast -------------------------------------------------------------------------------------


def _firewall(settings: Parameters) -> Iterator[CheckResult]:
    port = settings.listen_port
    ufw = Path("/etc/ufw/ufw.conf")
    if ufw.is_file() and "ENABLED=yes" in ufw.read_text(errors="replace"):
        yield CheckResult(
            "warning",
            "firewall",
            "ufw is active; it may block the peers' datagrams and the DDS messages of ROS 2",
            f"sudo ufw allow {port}/udp; sudo ufw allow 7400:57400/udp",
        )
    elif _output("firewall-cmd", "--state").strip() == "running":
        ports = f"--add-port={port}/udp --add-port=7400-57400/udp"
        cure = f"sudo firewall-cmd --permanent {ports} && sudo firewall-cmd --reload"
        says = "firewalld is active; it may block the peers' datagrams and the DDS messages of ROS 2"
        yield CheckResult("warning", "firewall", says, cure)
    elif re.search(r"hook input [^}]*policy drop", _output("nft", "list", "ruleset"), re.DOTALL):
        cure = f"sudo nft add rule inet filter input udp dport '{{ {port}, 7400-57400 }}' accept"
        says = "nftables drops packets that no rule accepts, so it may drop the peers' datagrams and DDS messages"
        yield CheckResult("warning", "firewall", says, cure)
    else:
        yield CheckResult("ok", "firewall", "no active firewall found")


def _output(*command: str) -> str:
    """Return the output of a command; an empty text if the command does not exist or cannot run."""
    program = shutil.which(command[0])
    if program is None:
        return ""
    try:
        done = subprocess.run(  # noqa: S603  # one of two commands above
            [program, *command[1:]], capture_output=True, text=True, timeout=_COMMAND_S, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout


def _multicast() -> Iterator[CheckResult]:
    """Check that this host receives a datagram that it sends to DDS's multicast group.

    Nodes of ROS 2 find each other (discovery) with such datagrams.
    """
    if os.environ.get("ROS_LOCALHOST_ONLY") == "1":
        yield CheckResult("ok", "multicast", "not needed: ROS_LOCALHOST_ONLY=1 restricts ROS 2 to this host")
        return
    device = "where DEV is the network interface, such as eth0"
    cure = f"sudo ip link set DEV multicast on; sudo ip route add 224.0.0.0/4 dev DEV, {device}"
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender,
    ):
        # Another program on this host may be in the group as well.
        receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        receiver.settimeout(1.0)
        try:
            receiver.bind((_GROUP, 0))
            # struct ip_mreq (ip(7)): the group, and the interface, which the routing table chooses.
            joined = struct.pack("=4sI", socket.inet_aton(_GROUP), socket.INADDR_ANY)
            receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, joined)
            sender.sendto(b"roverlink doctor", (_GROUP, receiver.getsockname()[1]))
            receiver.recv(64)
        except OSError as error:
            says = f"does not work ({error}), so ROS 2 does not find nodes on other machines"
            yield CheckResult("warning", "multicast", says, cure)
        else:
            says = f"works: this machine receives what it sends to {_GROUP}, the group with which ROS 2 finds nodes"
            yield CheckResult("ok", "multicast", says)


# --- ROS 2 ------------------------------------------------------------------------------------------------------


def _ros(registry: Registry | None, middleware: str) -> Iterator[CheckResult]:
    distribution = os.environ.get("ROS_DISTRO", "")
    rclpy = can_import("rclpy")
    if not rclpy and (middleware == "rclpy" or (distribution and middleware == "dds")):
        sourced = f"ROS 2 {distribution} is sourced, but " if distribution else ""
        says = f"{sourced}this Python {platform.python_version()} cannot import rclpy"
        environment = "/usr/bin/python3 -m venv --system-site-packages .venv"
        cure = f"create the virtual environment with the Python of ROS 2, for example with `{environment}`"
        yield CheckResult("error" if middleware == "rclpy" else "warning", "rclpy", says, cure)
    try:
        domain = ros_domain()
    except MiddlewareError as error:
        yield CheckResult("error", "ROS 2 domain", str(error))
        return
    if middleware == "zenoh":
        yield from _zenoh(domain)
    elif middleware == "dds":
        yield _joins(domain)
    elif middleware == "rclpy" and rclpy and registry is not None:
        yield _interfaces(registry)


def _zenoh(domain: int) -> Iterator[CheckResult]:
    """Check that zenoh takes its configuration, and that a router answers."""
    try:
        answers, doubts = examine_zenoh()
    except MiddlewareError as error:
        yield CheckResult("error", "zenoh", str(error))
        return
    keys = os.environ.get("ROS_DISTRO", "humble, because ROS_DISTRO is not set")
    yield CheckResult("ok", "zenoh", f"{answers}; ROS 2 domain {domain}, with the keys of {keys}")
    for doubt in doubts:
        yield CheckResult("warning", "zenoh", doubt)


def _joins(domain: int) -> CheckResult:
    """Check that Cyclone DDS has a supported version and can join the ROS 2 domain (ROS_DOMAIN_ID)."""
    version = installed_version("cyclonedds")
    if version is None:
        cure = f"source an installed ROS 2: source /opt/ros/DISTRO/setup.bash; as for Cyclone DDS, {dds_cure()}"
        return CheckResult("error", "Cyclone DDS", "neither rclpy nor Cyclone DDS is installed", cure)
    if version.partition(".")[0] != "11":
        return CheckResult(
            "error",
            "Cyclone DDS",
            f"version {version} is installed, but roverlink needs version 11",
            "pip install 'cyclonedds>=11,<12'",
        )
    try:
        with open_middleware("dds", NodeIdentity(f"roverlink_doctor_{os.getpid()}")):
            pass
    except RoverlinkError as error:
        return CheckResult("error", "Cyclone DDS", str(error))
    says = f"version {version} can join ROS 2 domain {domain}; an installation of ROS 2 is not needed"
    return CheckResult("ok", "Cyclone DDS", says)


def _interfaces(registry: Registry) -> CheckResult:
    """Check that the ROS 2 message packages that rclpy imports have the messages of the table, with the same fields."""
    message_types: list[type[Message]] = [handler.message_type for handler in registry.by_topic.values()]
    try:
        for message_type in (*message_types, DiagnosticArray):
            installed_class(message_type)
    except MiddlewareError as error:
        return CheckResult("error", "interfaces", str(error))
    return CheckResult("ok", "interfaces", f"the installed ROS 2 package {registry.package} has the generated messages")

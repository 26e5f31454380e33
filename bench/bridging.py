"""Section `bridging`: datagrams to a DDS topic and back, by every contestant, at rising rates and at full load."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from typing import Any

from bench.contestants import Contestant, twin_without_core
from bench.lab import Lab
from bench.result import Chart, Curve, Group, SectionResult, Table
from bench.rig import Point, Rig, Setting, open_rig

ALONE = Setting("alone", "UDP -> DDS, no subscriber, no forwards")
SETTINGS = (
    Setting("full", "UDP -> DDS, a subscriber, two raw forwards", observed=True, forwards=True),
    Setting("subscriber", "UDP -> DDS, a subscriber, no forwards", observed=True),
    Setting("forwards", "UDP -> DDS, no subscriber, two raw forwards", forwards=True),
    ALONE,
    Setting("outbound", "DDS -> UDP", outbound=True, observed=True),
    Setting("rclpy", "UDP -> ROS 2 with rclpy, a subscriber, no forwards", observed=True, rclpy=True),
    Setting("rclpy out", "ROS 2 with rclpy -> UDP", outbound=True, observed=True, rclpy=True),
)
QUICK_SETTINGS = ("full", "alone", "outbound", "rclpy", "rclpy out")

RATES = (1_000, 2_000, 5_000, 10_000, 15_000, 20_000, 30_000, 40_000, 60_000, 80_000, 100_000, 150_000, 200_000)
QUICK_RATES = (1_000, 20_000, 60_000)
LATENCY_RATE = 1_000
CPU_RATES: tuple[float | None, ...] = (1_000, 20_000, None)  # measured even if much is lost
LATENCY_FACTOR = 2.0  # the latency measurement is longer by this, since a p99 needs many datagrams
LOSSES_TO_STOP = 2  # lossy rates in a row after which higher rates are skipped
REFERENCE = "cpp"

NOTES = (
    (
        "No loss up to: the highest rate tried at which everything came out in time; a rate with losses is tried twice,"
        " with --quick once."
        " floor, cpp and handwritten keep the system's default socket buffer."
    ),
    (
        "CPU: user and system time of the whole process per datagram that came out. Latency: from send() to the"
        " subscriber's callback (floor: to recv; DDS -> UDP: from write() to the hardware's recv)."
    ),
    (
        "vs: rate in a flood; CPU at 1k/20k/flood, as multiples of that contestant's in the same setting."
        " For rclpy, python is rclpy-python."
    ),
)


def measure(lab: Lab) -> SectionResult:
    """Measure every setting and collect the results."""
    settings = [setting for setting in SETTINGS if not lab.quick or setting.name in QUICK_SETTINGS]
    points = [point for setting in settings for point in _measure_setting(lab, setting)]
    groups = [Group(setting.heading, rows) for setting in settings if (rows := _rows(points, setting))]
    return SectionResult(
        tables=[Table("Bridging the IMU message (51 bytes)", _COLUMNS, groups, [_legend(lab), *NOTES])],
        charts=[chart for setting in settings for chart in _charts(points, setting)],
        data={"points": [_data(point) for point in points]},
    )


def _measure_setting(lab: Lab, setting: Setting) -> Iterator[Point]:
    # Without a subscriber, nobody on the ROS 2 side has to understand a contestant, so all take part.
    contestants = [
        contestant
        for contestant in lab.contestants
        if setting is ALONE or (contestant.bridges and contestant.rclpy is setting.rclpy)
    ]
    if not contestants:
        return
    with open_rig(lab, setting) as rig:
        losses = dict.fromkeys((contestant.name for contestant in contestants), 0)
        # Rate by rate, not contestant by contestant: other load on the machine then affects all contestants alike.
        for rate in (*(QUICK_RATES if lab.quick else RATES), None):
            for contestant in contestants:
                if losses[contestant.name] >= LOSSES_TO_STOP and rate not in CPU_RATES:
                    continue
                point = _measure_point(rig, contestant, rate)
                losses[contestant.name] = 0 if point.lossless else losses[contestant.name] + 1
                lab.say(_progress(setting, point))
                yield point


def _measure_point(rig: Rig, contestant: Contestant, rate: float | None) -> Point:
    seconds = rig.lab.seconds * (LATENCY_FACTOR if rate == LATENCY_RATE else 1)
    point = rig.measure(contestant, rate, seconds)
    if rate is None or point.lossless or rig.lab.quick:
        return point
    return min(point, rig.measure(contestant, rate, seconds), key=lambda tried: tried.lost)


def _progress(setting: Setting, point: Point) -> str:
    load = "flood" if point.rate is None else f"{point.rate:,.0f}/s"
    kept = "no loss" if point.lossless or point.rate is None else "no loss, but late"
    lost = f"{point.lost / point.sent:.1%} lost" if point.lost else kept
    done = f"{point.delivered_per_second:,.0f}/s, {lost}, {point.cpu_us:.1f} us"
    return f"{setting.name:>10} {load:>9} {point.contestant:<11} {done}"


# -- the table

_COLUMNS = (
    "",
    "no loss\nup to, 1/s",
    "flood,\nbridged/s",
    "CPU us, at\n1k / 20k / flood",
    "latency us\np50 / p99",
    f"vs {REFERENCE}:\nrate; CPU",
    "vs python:\nrate; CPU",
)


def _rows(points: Sequence[Point], setting: Setting) -> list[list[str]]:
    by_contestant = _by_contestant(points, setting)
    return [
        [
            name,
            _highest_lossless(own),
            f"{_at(own, None).delivered_per_second:,.0f}",
            " / ".join(f"{_at(own, rate).cpu_us:.3g}" for rate in CPU_RATES),
            _latency(_at(own, LATENCY_RATE)),
            *(_ratio(own, by_contestant.get(other, own)) for other in (REFERENCE, twin_without_core(name))),
        ]
        for name, own in by_contestant.items()
    ]


def _legend(lab: Lab) -> str:
    return "; ".join(f"{contestant.name}: {contestant.about}" for contestant in lab.contestants) + "."


def _by_contestant(points: Iterable[Point], setting: Setting) -> dict[str, list[Point]]:
    own: dict[str, list[Point]] = {}
    for point in points:
        if point.setting == setting.name:
            own.setdefault(point.contestant, []).append(point)
    return own


def _at(points: Iterable[Point], rate: float | None) -> Point:
    return next(point for point in points if point.rate == rate)


def _highest_lossless(points: Iterable[Point]) -> str:
    rates = [point.rate for point in points if point.lossless and point.rate is not None]
    return f"{max(rates):,.0f}" if rates else "-"


def _latency(point: Point) -> str:
    return "-" if point.p50_us is None or point.p99_us is None else f"{point.p50_us:.0f} / {point.p99_us:.0f}"


def _ratio(own: Sequence[Point], reference: Sequence[Point]) -> str:
    if reference is own or not _at(reference, None).delivered:
        return "-"
    rate = _at(own, None).delivered_per_second / _at(reference, None).delivered_per_second
    cpu = "/".join(f"{_at(own, at).cpu_us / _at(reference, at).cpu_us:.2f}" for at in CPU_RATES)
    return f"{rate:.2f}; {cpu}"


# -- the picture and the data


def _charts(points: Sequence[Point], setting: Setting) -> list[Chart]:
    by_contestant = _by_contestant(points, setting)
    x = {name: [point.offered_per_second for point in own] for name, own in by_contestant.items()}
    delivered = [
        Curve(name, x[name], [point.delivered_per_second for point in own]) for name, own in by_contestant.items()
    ]
    cpu = [Curve(name, x[name], [point.cpu_us for point in own]) for name, own in by_contestant.items()]
    return [
        Chart(setting.heading, "offered, 1/s", "bridged, 1/s", delivered, diagonal=True),
        Chart(setting.heading, "offered, 1/s", "CPU, us a datagram", cpu),
    ]


def _data(point: Point) -> dict[str, Any]:
    derived = {
        "offered_per_second": point.offered_per_second,
        "delivered_per_second": point.delivered_per_second,
        "cpu_us": point.cpu_us if point.delivered else None,
        "lost": point.lost,
    }
    return {**asdict(point), **derived}

"""Gate for the inputs of estimators, and their reasons: why an input is left out, and why a result is missing.

1. An input is compared with what the estimator expects. The innovation is the difference. Its square, over the
   covariance of the expectation plus that of the input, is distributed as chi squared if both are right (Bar-Shalom, Li
   and Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 5.4). The gate refuses an
   input whose square is exceeded with a probability below `FALSE_ALARM`.
2. A refused input is counted. It is said when chance does not explain it: one input that is very unlikely, or several
   unlikely ones in a row. Such a case is said for the first, second, fourth, eighth... time.
3. If the last innovations together are larger than their covariances say, all variances are too small by a factor.
4. An estimator that gives no result says why after `PATIENCE_NS`.
"""

from __future__ import annotations

import math
from collections import Counter, deque
from collections.abc import Callable
from functools import cache

from roverlink.numerals import counted

FALSE_ALARM = 1e-3
"""Probability with which a gate refuses a right input."""
_CHANCE = 1e-9
"""Probability of refused inputs in a row from which chance does not explain them: that of three of them."""
_RECENT = 10
"""Most innovations that are looked at together."""
PATIENCE_NS = 10_000_000_000
"""Time in nanoseconds without a result after which the reason is said."""


def chi_squared_tail(squared: float, freedom: int) -> float:
    """Return the probability that chi squared with some degrees of freedom exceeds a value.

    Source: Abramowitz and Stegun, Handbook of Mathematical Functions, 26.4.4 to 26.4.8.
    """
    half = squared / 2
    if not 0 < half < math.inf:  # also what is no number
        return float(half <= 0)
    tail, term = (math.erfc(math.sqrt(half)), 0.5) if freedom % 2 else (math.exp(-half), 1.0)
    while term < freedom / 2:
        tail += math.exp(term * math.log(half) - half - math.lgamma(term + 1))
        term += 1
    return tail


@cache
def gate_limit(freedom: int) -> float:
    """Return the squared innovation from which a gate refuses an input with some degrees of freedom."""
    low, high = 0.0, 20.0 * (freedom + 1)
    while high - low > 1e-9 * high:
        middle = (low + high) / 2
        low, high = (middle, high) if chi_squared_tail(middle, freedom) > FALSE_ALARM else (low, middle)
    return high


class RecentInnovations:
    """Last innovations of an estimator. Each counts up to the limit of the gate: one alone never tells much."""

    def __init__(self) -> None:
        """Begin without an innovation."""
        self._found = deque[tuple[float, int]](maxlen=_RECENT)
        self._passed = 0
        """Number of innovations since the last one that did not pass the gate."""

    def add(self, squared: float, freedom: int, passes: bool) -> None:
        """Add a normalized squared innovation with some degrees of freedom, and whether it passes the gate."""
        self._found.append((min(squared, gate_limit(freedom)), freedom))
        self._passed = self._passed + 1 if passes else 0

    @property
    def probability(self) -> float:
        """Least probability by chance of the last innovation, the last two, and so on.

        If one does not pass the gate, it and those before it count only if there are ten: it has a reason of its own.
        """
        squared, freedom, least = 0.0, 0, 1.0
        for number, (one, of_one) in enumerate(reversed(self._found), 1):
            squared, freedom = squared + one, freedom + of_one
            if number <= self._passed or number == _RECENT:
                least = min(least, chi_squared_tail(squared, freedom))
        return least

    @property
    def variance_factor(self) -> float:
        """Factor by which all variances are too small, at least 1: the variance of unit weight.

        The variances are believed as if one more innovation had confirmed them. Source: Koch, Parameter Estimation and
        Hypothesis Testing in Linear Models, 1999, section 3.2.
        """
        believed = max((freedom for _, freedom in self._found), default=1)
        squared, freedom = map(sum, zip(*self._found, (believed, believed)))
        return max(1.0, squared / freedom)


class Reasons:
    """Reasons of one estimator, for its log and its diagnostics."""

    def __init__(self, say: Callable[[str], None] = lambda _: None) -> None:
        """Begin without reasons; ``say`` is called with messages for the user."""
        self._say = say
        self.counts = Counter[str]()
        """Number of inputs that were left out, by the reason."""
        self.missing: dict[str, str] = {}
        """Reason by the result that is missing now."""
        self._missing_since: dict[str, int] = {}
        self._said: dict[str, str] = {}
        self._unlikely: dict[str, float] = {}
        self._told = Counter[str]()

    def tell(self, reason: str, details: str = "") -> None:
        """Count a reason, such as an input that cannot be used, and say it. ``details`` may change each time."""
        self.counts[reason] += 1
        self._tell(reason, details)

    def note(self, reason: str, details: str = "") -> None:
        """Say once that an input is used although something about it is not right."""
        if not self._told[reason]:
            self._tell(reason, details)

    def passes(self, reason: str, squared: float, freedom: int, details: str = "") -> bool:
        """Return true if an input passes the gate, else count it with a reason.

        ``squared`` is its normalized squared innovation.
        """
        probability = chi_squared_tail(squared, freedom)
        if probability >= FALSE_ALARM:
            self._unlikely.pop(reason, None)
            return True
        self.counts[reason] += 1
        before = self._unlikely.get(reason, 1.0)
        self._unlikely[reason] = before * probability
        if self._unlikely[reason] < _CHANCE <= before:
            self._tell(reason, details)
        return False

    def lack(self, result: str, why: str, now: int) -> None:
        """Note that a result is missing at a time in nanoseconds, and say why if this lasts."""
        self.missing[result] = why
        since = self._missing_since.setdefault(result, now)
        if now < since:  # the clock of a simulation may jump back
            self._missing_since[result] = now
        elif now - since >= PATIENCE_NS and self._said.get(result) != why:
            self._said[result] = why
            left_out = "".join(f"; {counted(count, 'time')}: {reason}" for reason, count in self.counts.most_common(1))
            self._say(f"no {result} for {(now - since) / 1e9:.0f} s: {why}{left_out}")

    def give(self, result: str) -> None:
        """Note that there is a result."""
        for known in (self.missing, self._missing_since, self._said):
            known.pop(result, None)

    def _tell(self, reason: str, details: str) -> None:
        """Say a reason for the first, second, fourth, eighth... time."""
        self._told[reason] += 1
        count = self._told[reason]
        if count & (count - 1) == 0:
            times = f" ({self.counts[reason]} times)" if self.counts[reason] > 1 else ""
            self._say(f"{reason}{f': {details}' if details else ''}{times}")

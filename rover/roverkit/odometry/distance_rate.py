"""Filter for a distance that is proportional to a quantity, such as the time or the revolutions of the wheels."""

from __future__ import annotations

_DELAY_DEVIATION_S = 0.005
"""Standard deviation of the delay before anything is known about it."""


class DistanceRate:
    """Extended Kalman filter of a rate and of a delay in seconds.

    The rate is the distance in metres per unit of the quantity. The delay is the time for which a command and a report
    are on their way together: for this time, the distance on a new command does not grow yet, and no report contains
    it. The delay can be told from the rate, because commands come at various times before a report.
    """

    def __init__(self, deviation: float) -> None:
        """Begin with the rate zero and its standard deviation."""
        self.rate = self.delay = 0.0
        self.variance = deviation**2
        """Variance of the rate."""
        self._covariance, self._delay_variance = 0.0, _DELAY_DEVIATION_S**2

    def drift(self, deviation: float) -> None:
        """Let the rate change by a random amount with a standard deviation."""
        self.variance += deviation**2

    def stop(self, deviation: float) -> None:
        """Set the rate to zero, with a standard deviation; the delay is kept."""
        self.rate, self.variance, self._covariance = 0.0, deviation**2, 0.0

    def measure(self, distance: float, deviation: float, amount: float, flow: float) -> None:
        """Take a distance in metres, with its standard deviation, in which the quantity has grown by an amount.

        ``flow`` is the growth of the quantity per second if the delay shortens the distance, else 0.
        """
        by_rate, by_delay = amount - flow * self.delay, -flow * self.rate
        rate_gain = self.variance * by_rate + self._covariance * by_delay
        delay_gain = self._covariance * by_rate + self._delay_variance * by_delay
        scale = by_rate * rate_gain + by_delay * delay_gain + deviation**2
        miss = distance - self.rate * by_rate
        self.rate += rate_gain / scale * miss
        self.delay += delay_gain / scale * miss
        self.variance -= rate_gain**2 / scale
        self._covariance -= rate_gain * delay_gain / scale
        self._delay_variance -= delay_gain**2 / scale

"""Limit above which a sum of squared residuals is more than chance."""

_NORMAL_QUANTILE = 3.09  # 99.9 % quantile of the normal distribution


def chi2_limit(freedom: int) -> float:
    """Return the value that chi squared exceeds once in a thousand cases (Wilson and Hilferty, 1931).

    `freedom` is the number of degrees of freedom.
    """
    part = 2 / (9 * freedom)
    return float(freedom * (1 - part + _NORMAL_QUANTILE * part**0.5) ** 3)

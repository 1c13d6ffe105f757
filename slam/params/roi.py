"""The border without key points, ``RoiRatios``."""

from __future__ import annotations


def parsed_ratios(text: str) -> tuple[float, float, float, float]:
    """Shares of the image's width (left, right) and height (top, bottom).

    Raises:
        ValueError: not four numbers from 0 to below 1 that leave something.
    """
    right = "four shares from 0 to below 1 with spaces between, left right top bottom, that leave a part of the image"
    try:
        left, right_share, top, bottom = (float(word) for word in text.split())
    except ValueError as error:
        raise ValueError(right) from error
    inside = all(0 <= share < 1 for share in (left, right_share, top, bottom))
    if not inside or left + right_share >= 1 or top + bottom >= 1:
        raise ValueError(right)
    return left, right_share, top, bottom


def checked_ratios(text: str) -> str:
    """The text itself, if it is what ``parsed_ratios`` reads."""
    parsed_ratios(text)
    return text

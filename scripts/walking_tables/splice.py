"""Puts a part of a page in the place of the part with the same heading."""

from __future__ import annotations


def replaced(page: str, heading: str, part: str) -> str:
    """Return a page with the section under a second-level heading replaced, up to the next heading of that level.

    Raises:
        ValueError: the page has no such heading.
    """
    lines = page.splitlines()
    start = lines.index(f"## {heading}")
    stop = next((i for i in range(start + 1, len(lines)) if lines[i].startswith("## ")), len(lines))
    return "\n".join([*lines[:start], *part.strip().splitlines(), "", *lines[stop:]]) + "\n"

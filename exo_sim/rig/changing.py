"""A rig's text with other values in it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError

from exo_sim.errors import RigError


def with_values(text: str, values: Mapping[str | tuple[str, ...], Any]) -> str:
    """Return the text of a rig with values put in, order and comments kept.

    Args:
        text: TOML.
        values: Dotted keys, or tuples of keys, to values; None takes a key away. Tables are made on the way.

    Raises:
        RigError: a key leads through a value, is to be taken away and not there, or a value is none that TOML has.
    """
    document = tomlkit.parse(text)
    for key, value in values.items():
        parts = tuple(key.split(".")) if isinstance(key, str) else tuple(key)
        name = ".".join(parts)
        here: Any = document
        for part in parts[:-1]:
            if part not in here:
                if value is None:
                    raise RigError(f"{name}: there is no such key to take away")
                here[part] = tomlkit.table(is_super_table=part != parts[-2])
            here = here[part]
            if not isinstance(here, Mapping):
                raise RigError(f"{name}: {part} holds a value, not a table")
        if value is None:
            if parts[-1] not in here:
                raise RigError(f"{name}: there is no such key to take away")
            del here[parts[-1]]
            continue
        try:
            here[parts[-1]] = tomlkit.item(value)
        except (TOMLKitError, ValueError, TypeError):
            raise RigError(f'{name} = {value!r}: write text with a unit, like "7 bar", or a number') from None
    return tomlkit.dumps(document)

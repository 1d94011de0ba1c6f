"""How a unit may be written: names, whole powers, products and quotients. It is parsed, never computed."""

from __future__ import annotations

import re

from exo_sim.errors import UnitError

_HIGH = "⁰¹²³⁴-⁹"
_DEGREES = r"[°º]\s?[CF](?!\w)|[°º℃]|deg\s[CF](?!\w)"
_TOKEN = re.compile(
    rf"\s*(?:(?P<name>{_DEGREES}|[^\W\d{_HIGH}][^\W{_HIGH}]*|%)"
    rf"|(?P<power>(?:\*\*|\^)\s*[-+]?\d(?!\d)|[⁻⁺]?[{_HIGH}])"
    r"|(?P<times>[*·⋅.]|(?<=[A-Za-z])-(?=[A-Za-z]))|(?P<over>/)|(?P<sign>[()1]))"
)
#: Names without a sign between them, and signs for names.
_TOGETHER: dict[str, dict[str, int]] = {
    "Nm": {"N": 1, "m": 1}, "Nmm": {"N": 1, "mm": 1}, "Ncm": {"N": 1, "cm": 1}, "kNm": {"kN": 1, "m": 1},
    "°": {"deg": 1}, "º": {"deg": 1}, "℃": {"degC": 1},
}  # fmt: skip
#: A name with its power behind it, as in "mm2" and "m/s2".
_POWERED = re.compile(r"([A-Za-zµμ]+)([234])")
_RAISED = str.maketrans("⁻⁺⁰¹²³⁴⁵⁶⁷⁸⁹", "-+0123456789")
#: Largest power that a unit may have once brackets are resolved.
_MOST = 9


def powers(unit: str) -> dict[str, int]:
    """Return the power of each name in a unit: `{"J": 1, "kg": -1, "K": -1}` for `"J/(kg K)"`.

    Products bind as tightly as quotients, from left to right: "J/kg K" is J K/kg.

    Raises:
        UnitError: it is not made of names, whole powers of one digit, products, quotients and brackets.
    """
    tokens, at = [], 0
    text = unit.rstrip()
    while at < len(text):
        found = _TOKEN.match(text, at)
        if found is None:
            raise UnitError(f'cannot read the unit "{unit}" from "{text[at:]}" on')
        tokens.append((str(found.lastgroup), found.group(str(found.lastgroup))))
        at = found.end()
    result, rest = _product(unit, tokens)
    if rest:
        raise UnitError(f'cannot read the unit "{unit}": a bracket is closed that was not opened')
    if any(abs(power) > _MOST for power in result.values()):
        raise UnitError(f'cannot read the unit "{unit}": a power of more than {_MOST}')
    return result


Tokens = list[tuple[str, str]]


def _product(unit: str, tokens: Tokens) -> tuple[dict[str, int], Tokens]:
    result: dict[str, int] = {}
    sign = 1
    while True:
        factor, tokens = _factor(unit, tokens)
        for name, power in factor.items():
            result[name] = result.get(name, 0) + sign * power
        if not tokens or tokens[0] == ("sign", ")"):
            return result, tokens
        sign = -1 if tokens[0][0] == "over" else 1
        if tokens[0][0] in ("over", "times"):
            tokens = tokens[1:]


def _factor(unit: str, tokens: Tokens) -> tuple[dict[str, int], Tokens]:
    if not tokens or tokens[0][0] not in ("name", "sign") or tokens[0][1] == ")":
        raise UnitError(f'cannot read the unit "{unit}": a name is missing')
    (kind, text), tokens = tokens[0], tokens[1:]
    if kind == "name":
        factor = _named(text)
    elif text == "1":
        factor = {}
    else:
        factor, tokens = _product(unit, tokens)
        if not tokens:
            raise UnitError(f'cannot read the unit "{unit}": a bracket is not closed')
        tokens = tokens[1:]
    if tokens and tokens[0][0] == "power":
        raised = int(tokens[0][1].translate(_RAISED).lstrip("*^ "))
        factor, tokens = {name: raised * power for name, power in factor.items()}, tokens[1:]
    return factor, tokens


def _named(text: str) -> dict[str, int]:
    if text in _TOGETHER:
        return dict(_TOGETHER[text])
    if found := _POWERED.fullmatch(text):
        return {found[1]: int(found[2])}
    return {f"deg{text[-1]}" if text[0] in "°º" or " " in text else text: 1}

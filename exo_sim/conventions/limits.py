"""Every number that decides how columns were written (zero and unit of pressures, commands, acting), with what set it."""

from __future__ import annotations

from exo_sim.deciding_number import Number

_ways = "(scripts/pressure_limits: 938 ways to write the recordings of 93 benches and legs, 20 whole machines and 12 real ones)"
_decides_nothing = f"convention; from a twentieth to twenty times it no reading changes for the worse {_ways}"


def _right(low: str, high: str) -> str:
    return f"varied: from {low} to {high} all that is read rightly stays so {_ways}"


# -- unit -----------------------------------------------------------------------------------------------------------------------
LEAST = Number(0.5, "atmospheres", "the chambers of a machine reach no less than this, else the unit is another ...", _right("0.025", "1"))
MOST = Number(5.0, "pressures of the supply", "... and no more than this", _right("1.65", "100"))
VACUUM = Number(
    1e3, "Pa", "of one column among others that are as they should be only a reading that is nearer to a vacuum than this has another unit",
    _decides_nothing,
)  # fmt: skip
NEAR_LOW = Number(
    0.4, "pressures of the supply", "in the unit that is taken the largest pressure is at least this ...", _right("0.36", "0.5")
)  # fmt: skip
NEAR_HIGH = Number(1.25, "pressures of the supply", "... and at most this, where one unit brings it there", _decides_nothing)

# -- zero -----------------------------------------------------------------------------------------------------------------------
RESTS = Number(
    0.1, "atmospheres", "a chamber that vents rests no farther from the atmosphere, or from nothing where its sensor is gauge",
    _right("0.08", "0.2"),
)  # fmt: skip
DWELLS = Number(
    0.2, "share of the time", "it must rest there for so long to outweigh a gas balance that says otherwise", _right("0.02", "1")
)  # fmt: skip
_balance = "those of 93 benches and legs with all kinds of physics left out, absolute all, want -0.5 to 0.5"
GAUGE = Number(0.65, "atmospheres", "a column is gauge whose gas balance wants more added, alone ...", _balance)
GAUGE_BESIDE = Number(0.3, "atmospheres", "... and beside a supply that is off by one", _balance)
MOST_GAUGE = Number(1.6, "atmospheres", "one that wants more added is neither", _balance)
ABSOLUTE = Number(0.35, "atmospheres", "a column is absolute whose gas balance wants less added", _balance)
OFF_BY = Number(
    0.15, "atmospheres", "a supply counts from the atmosphere that is off from one below the rig's by less", _right("0.1", "0.75")
)  # fmt: skip
FULL = Number(
    0.9, "quantile", "of a supply that is taken for what it is set to: one that sags by an atmosphere for half of the time is not gauge",
    _right("0.81", "0.99"),
)  # fmt: skip
CONTRAST = Number(1.5, "ratio of misfits", "by so much they must differ to tell the zero of one chamber ...", _right("1.2", "1.5"))
COMMON_CONTRAST = Number(1.1, "ratio of misfits", "... and of all columns together, ...", _decides_nothing)
COMMON = Number(
    0.6, "atmospheres",
    "... which from so many on is the atmosphere. Misfits as recorded must be so many times those with an atmosphere added, too",
    "of 78 absolute columns of whole machines of learn makes a parabola's least alone calls two gauge, both together none",
)  # fmt: skip
TOGETHER = Number(
    1.3, "product of ratios of misfits",
    "chambers that never vent, beside a supply that is absolute, tell together: every one holds better with an atmosphere added, and the "
    "product of the factors by which the misfits fall is more than this",
    "23 recordings of cylinders of other makers, absolute all: 0.72 at most; with the atmosphere taken off their chambers it tells four "
    "that nothing else does, 1.32 to 1.84",
)  # fmt: skip

# -- acting ---------------------------------------------------------------------------------------------------------------------
VENTED = Number(
    0.5, "atmospheres", "a chamber 2 that is open to the atmosphere, as a single-acting cylinder's, is no further above it for a quarter "
    "of the time: a silencer that throttles a quick stroke keeps up less, and not for long",
    "asserted; a bench whose chamber 2 is driven is 2.8 to 4.0 atmospheres above it",
)  # fmt: skip

# -- commands -------------------------------------------------------------------------------------------------------------------
OPENS = Number(
    0.02, "share of the full command", "a command that is never further from its middle opens no valve that leaves its edges closed there",
    "asserted",
)  # fmt: skip
CARDS_LATE = Number(
    0.6, "s", "so late pressures are tried behind the volumes of closed chambers", "asserted: three times a slow logger's card",
)  # fmt: skip
FOLLOWS = Number(
    0.7, "share of the squares of changes of ln p", "that must follow from the volumes for a command that opens nothing to be believed",
    "closed chambers whose noisy pressures are 0.18 s late at 50 Hz: 0.78; three driven benches: 0.48 at most",
)  # fmt: skip
LATE = Number(
    8e-3, "s", "a command that is recorded so long after what it does, and by three samples, stands on a clock of its own",
    "asserted: three times what cards of healthy machines differ by (2.5 ms), and lags of valves make it early, not late",
)  # fmt: skip
LATEST = Number(0.12, "s", "so far a command is tried earlier", "asserted: four times the bench that showed it")
BETTER_IN_TIME = Number(
    2.0, "ratio of misfits",
    "by so much the pressures must follow the command better where it is taken earlier than where it is not or where it is taken later",
    "a bench with its command 30 ms late: 13; the same in time, taken 8 ms earlier: 0.29. A valve in pulses of 40 ms that lags by 15 ms: "
    "4.0 taken 22 ms earlier, 0.8 against 20 ms later",
)  # fmt: skip
FOLLOWED = Number(0.6, "share of the variance of pressure changes", "that must follow from the command where it is taken earlier")

"""Bytes, numbers, units and words that have broken readers before, here or elsewhere."""

from __future__ import annotations


def _words(text: str) -> list[str]:
    return text.split()


BYTES = [
    *("", "\x00", "\n", "\r", "\r\n", ",", ";", '"', "'", "[", "]", "{", "}", "=", "#", "<", ">", "/", "&", "\x0b", "\x0c", "\x1c", "\x85"),
    *("\u2028", "\xff", "\xfe\xff", "\xef\xbb\xbf", "\xc3", "\x1b[2J", "\x1b]0;x\x07", "\u202e", "é", "µ", "\ud800", "nan", "PAR1", "RRF2"),
    *("<!DOCTYPE x [<!ENTITY a 'b'>]>", "<include file='/dev/zero'/>", "[[a]]\n", "[a.b]\n", "a = 1\n"),
]
NUMBERS = [
    *_words("0 -0.0 1 -1 0.5 1e-320 1e-300 1e-9 1e9 1e300 -1e300 1e400 nan inf -inf NaN 1,5 0x10 1_000 ٣ 1e --1 true None"),
    *("12:30:05", "2024-05-01T12:00:00Z", "2024-02-31", "9" * 50, "9" * 5000),
]
UNITS = [
    *(
        "m",
        "mm",
        "in",
        "Pa",
        "bar",
        "psi",
        "psig",
        "barg",
        "kg",
        "g",
        "lb",
        "N",
        "kN",
        "N m",
        "N*m",
        "N m/rad",
        "rad",
        "deg",
        "s",
        "ms",
        "K",
    ),
    *("degC", "m^2", "mm^2", "cm^3", "L", "kg/s", "J/(kg K)", "%", "1", "", "V", "furlong", "m**m", "10**10**10", "m^1e9", "m/0", "m^-400"),
    *("(" * 300, "__import__('os')", "bar(a)", "bar gauge", "°C", "µm"),
]
#: Units that a value may well be in: the first of `UNITS`.
SOUND_UNITS = UNITS[:24]
HEADINGS = ["time", "piston.pressure_1", "a.b", "slide.position", ""]
TOML = [
    *("", "[]", "{}", '""', "[1, 2]", '["a"]', "[[[]]]", "{a = 1}", "1979-05-27", "''", "'/dev/zero'", '"../../x"'),
    *('"' + "a" * 3000 + '"', "[" * 200 + "]" * 200),
]
KEYS = ["bore", "bor", "stroke", "valve", "model", "a.b", "supply", "cylinders.x", "effects.x.y"]
ATTRIBUTES = [*NUMBERS, "1 0 0", "-1 1", "0 0 0", "slide", "piston", "world", "RK4", "mesh", "a" * 300]
ELEMENTS = ["", "<geom type='mesh' mesh='x'/>", "<body/>", "<motor/>", "<include file='bench.xml'/>", "<plugin/>", "<freejoint/>"]
#: Of somebody's own Python: statements, and what may come back from it.
STATEMENTS = [
    *(
        "raise ValueError('no \\x1b[2J\\n gains')",
        "raise SystemExit(0)",
        "raise SystemExit('done')",
        "raise GeneratorExit",
        "raise StopIteration",
    ),
    *("raise BaseException('odd')", "raise MemoryError", "raise BrokenPipeError", "open('/nonexistent')", "1 / 0", "self.act(observation)"),
    *("observation.clear()", "self.context = None", "print('hello')", "import warnings; warnings.warn('hm')", "import nothing_there"),
    *("class Odd(Exception): __str__ = None\n        raise Odd", "return", "yield 1", "self.context.rig.cylinders.clear()", "pass"),
]
RETURNED = [
    *("None", "{}", "[]", "''", "'open'", "[0.0] * 4", "[1e300] * 4", "[float('nan')] * 4", "[[0.0] * 4]", "[1j] * 4", "(n for n in [1])"),
    *("{'knee_l': 10 ** 400}", "{'knee_l': True}", "{'knee_l': None}", "{'kne_l': 1}", "{'knee_l': 1, 'hip_l.torque': 1}", "{b'x': 1}"),
    *("{'knee_l.torque': 1e300}", "{'knee_l.torque': 1e5}", "{'knee_l': -1e300}", "{1: 2}", "object()", "self", "observation", "{'': 0}"),
    *("type('F', (), {'__float__': lambda s: 1 / 0})()", "{'knee_l': type('F', (), {'__float__': lambda s: 1 / 0})()}"),
    *(
        "{type('K', (), {'__str__': lambda s: 1 / 0})(): 1}",
        "{'a' * 5000: 1}",
        "{'\\x1b[2J': 1}",
        "dict.fromkeys(map(str, range(10000)), 0)",
    ),
]
#: What may stand in a file's place.
KINDS = ["folder", "pipe", "loop", "missing", "/dev/zero", "/dev/null", "/dev/full", "nothing"]

VERBS = ["run", "scenarios", "inspect", "compare", "diagnose", "effects", "size", "trial", "view", "inspct", ""]
OPTIONS = [
    *_words("--rig --columns --out --json -q --seed --jobs --motion --payload --speed --strides --assist --controller --demand --scenario"),
    *_words("--trials --reach --pressure-limit --quick --scheduler --cases --every --duration --key --tool --timeout --head --oracle --at"),
    *_words("--help -h --version --rgi -x --"),
]
#: Values of options and arguments; all that is written with them stays in the folder at hand.
VALUES = [
    *_words("bench.csv bench.toml bench.xml map.toml bench.rrd nothing.csv . /dev/null /dev/zero - -- -1 0 1 2 1e9 nan"),
    *_words("34 level_walk level_wak"),
    *_words("squat on vented model pi tcp://127.0.0.1:1 tcp:// coulomb_friction out out.rrd out.png no/such/folder/x.rrd make run score"),
    *("", "34 kg", "-5 kg", "1e300 kg", "32 10**10**10", "1 atm", "a" * 300, "\x1b[31m", "\udcff", "undone", "bench.csv\x00"),
]

"""What is fuzzed: strategies that draw cases, one for each kind of thing that people hand in."""

from __future__ import annotations

from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from fuzzing import fragments
from fuzzing.case import Case
from fuzzing.strategies import effects, of_bytes, of_controller, of_json, of_model, of_sizes, of_table, of_toml, some

Words = tuple[str, ...]

_RIG = ("--rig", "bench.toml")
_LOOK = [("inspect", "bench.csv", *_RIG, "--json"), ("inspect", "bench.csv", *_RIG), ("compare", "bench.csv", *_RIG)]
_WALK = ("run", "level_walk", "--rig", "exo.toml", "--strides", "1", "--demand", "inverse_dynamics", "--json", "-q", "--out", "walk.rrd")
_QUICK = ("--rig", "exo.toml", "--strides", "1", "--demand", "inverse_dynamics", "--json", "-q", "--out", "walk.rrd")
_TRIAL = [
    ("trial", "score", "trial", "--jobs", "1", "--json"),
    ("trial", "score", "trial", "--jobs", "1"),
    ("trial", "run", "trial", "--tool", "false", "--jobs", "1"),
    ("trial", "run", "undone", "--tool", "false", "--timeout", "5 s", "--jobs", "1"),
]
_TRIAL_FILES = ("trial/manifest.json", "undone/manifest.json", "trial.key", "trial/verdicts.jsonl")


def _reading(name: str, *more: str) -> SearchStrategy[Words]:
    """The verbs that read a recording; the slower a verb, the rarer."""
    quick = [("inspect", name, "--json")] * 6 + [("inspect", name, *_RIG)] * 4
    slow = [("compare", name, *_RIG, "--json")] * 2 + [("diagnose", name, *_RIG, "--jobs", "1")]
    return st.sampled_from([*quick, *slow]).map(lambda words: (*words, *more))


def tables() -> SearchStrategy[Case]:
    """Recordings as CSV."""
    edits = some(of_table("bench.csv"), of_table("bench.csv"), of_bytes("bench.csv"))
    return st.builds(Case, st.just("bench"), _reading("bench.csv"), edits)


def binaries() -> SearchStrategy[Case]:
    """Recordings as Parquet and .rrd."""
    names = st.sampled_from(["bench.parquet", "bench.rrd"])
    return names.flatmap(lambda name: st.builds(Case, st.just("bench"), _reading(name), some(of_bytes(name))))


def foreign() -> SearchStrategy[Case]:
    """Recordings as MATLAB, ROS 2, OpenSim and LeRobot write them, and their column maps."""
    held: dict[str, Words] = {
        "bench.mat": (), "bench73.mat": (), "bench.mcap": (), "bench.sto": (), "log.mcap": ("log.toml",),
        "episode.parquet": ("episode.toml",),
    }  # fmt: skip

    def drawn(name: str) -> SearchStrategy[Case]:
        mapped = held[name]
        edits = [of_bytes(name)]
        edits += [of_table(name)] if name.endswith(".sto") else []
        edits += [of_toml(*mapped), of_json("meta/info.json")] if name == "episode.parquet" else [of_toml(*mapped)] if mapped else []
        return st.builds(Case, st.just("bench"), _reading(name, *(("--columns", *mapped) if mapped else ())), some(*edits))

    return st.sampled_from(sorted(held)).flatmap(drawn)


def gaits() -> SearchStrategy[Case]:
    """Joint angles that somebody walks by, and the ground's forces beside them."""

    def drawn(words: Words) -> SearchStrategy[Case]:
        names = [name for name in words if name.startswith(("walk.", "forces."))]
        edits = [of_bytes(*names), *(of_table(name) for name in names if not name.endswith(".c3d"))]
        return st.builds(Case, st.just("walk"), st.just(("run", *words, *_QUICK)), some(*edits))

    files = [("--gait", "walk.mot"), ("--gait", "walk.csv"), ("--gait", "walk.c3d"), ("--gait", "walk.mot", "--ground", "forces.mot")]
    return st.sampled_from(files).flatmap(drawn)


def scenarios() -> SearchStrategy[Case]:
    """Scenario files."""
    return st.sampled_from(["walk.toml", "standing.toml"]).flatmap(
        lambda name: st.builds(Case, st.just("walk"), st.just(("run", name, *_QUICK)), some(of_toml(name), of_toml(name), of_bytes(name)))
    )


def controllers() -> SearchStrategy[Case]:
    """Controllers in somebody's own Python."""
    words = ("run", "level_walk", "--controller", "mine.py:Mine", *_QUICK)
    return st.builds(Case, st.just("walk"), st.just(words), some(of_controller("mine.py"), of_controller("mine.py"), of_bytes("mine.py")))


def catalogues() -> SearchStrategy[Case]:
    """Catalogues of cylinders and valves."""
    words = ("size", "--rig", "exo.toml", "--catalogue", "catalogue.toml", "--quick", "--json")
    edits = some(of_toml("catalogue.toml"), of_toml("catalogue.toml"), of_bytes("catalogue.toml"))
    return st.builds(Case, st.just("walk"), st.just(words), edits)


def maps() -> SearchStrategy[Case]:
    """Foreign tables and their column maps."""
    edits = some(of_toml("map.toml"), of_table("strange.csv"), of_bytes("map.toml", "strange.csv"))
    return st.builds(Case, st.just("bench"), _reading("strange.csv", "--columns", "map.toml"), edits)


def rigs() -> SearchStrategy[Case]:
    """Rig files."""
    edits = some(of_toml("bench.toml"), of_toml("bench.toml"), of_bytes("bench.toml"))
    return st.builds(Case, st.just("bench"), st.sampled_from(_LOOK), edits)


def models() -> SearchStrategy[Case]:
    """MJCF models."""
    edits = some(of_model("bench.xml"), of_model("bench.xml"), of_bytes("bench.xml"))
    return st.builds(Case, st.just("bench"), st.sampled_from([*_LOOK, ("machine", "bench.toml")]), edits)


def machines() -> SearchStrategy[Case]:
    """Machines that a rig file may hold: up to four numbers up to the bounds, and up to three effects at theirs."""
    found = st.lists(effects(), max_size=3, unique_by=lambda text: text.split("]")[0]).map("".join)
    at_the_end = found.map(lambda text: ["splice", "bench.toml", -1, 0, text])
    edits = st.tuples(st.lists(of_sizes("bench.toml"), max_size=4), at_the_end).map(lambda held: (*held[0], held[1]))
    return st.builds(Case, st.just("bench"), st.just(("machine", "bench.toml")), edits)


def walks() -> SearchStrategy[Case]:
    """The walking machine's rig and model, in a stride."""
    return st.builds(Case, st.just("exo"), st.just(_WALK), some(of_toml("exo.toml"), of_model("exo.xml")))


def trials() -> SearchStrategy[Case]:
    """Trials whose manifest, key or ledger was altered."""
    return st.builds(Case, st.just("trial"), st.sampled_from(_TRIAL), some(of_json(*_TRIAL_FILES), of_bytes(*_TRIAL_FILES)))


def commands() -> SearchStrategy[Case]:
    """Command lines: verbs, options and values, sound and unsound, in any order."""
    text = st.text(max_size=6).filter(lambda text: "/" not in text and ".." not in text)  # nothing is written elsewhere
    option = st.sampled_from(fragments.OPTIONS)
    rest = st.lists(st.one_of(st.sampled_from(fragments.VALUES), text, option, option.map(lambda name: f"{name}=1")), max_size=6)
    words = st.builds(lambda verb, rest: (verb, *rest), st.sampled_from(fragments.VERBS), rest)
    return st.builds(Case, st.just("bench"), words.filter(_opens_no_window).map(_kept_short), st.just(()))


def _opens_no_window(words: Words) -> bool:
    return words[0] != "view" or "--out" in words


def _kept_short(words: Words) -> Words:
    """Ask for one stride and one design where the command should be sound."""
    least = {"run": ("--strides", "1", "--demand", "inverse_dynamics"), "size": ("--trials", "1", "--jobs", "1")}
    return (*words, *least.get(words[0], ()))


#: By name: what draws the cases, and the share of the time.
TARGETS: dict[str, tuple[SearchStrategy[Case], float]] = {
    "tables": (tables(), 0.14),
    "binaries": (binaries(), 0.08),
    "foreign": (foreign(), 0.12),
    "maps": (maps(), 0.1),
    "rigs": (rigs(), 0.12),
    "models": (models(), 0.08),
    "machines": (machines(), 0.08),
    "walks": (walks(), 0.04),
    "gaits": (gaits(), 0.08),
    "scenarios": (scenarios(), 0.03),
    "controllers": (controllers(), 0.03),
    "catalogues": (catalogues(), 0.03),
    "trials": (trials(), 0.04),
    "commands": (commands(), 0.08),
}

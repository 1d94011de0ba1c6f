"""How a diagnosis puts the question of an effect to a recording: what its declaration says of that."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

Starts = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class ObservedMotion:
    """What a recording shows of a motion, for values to begin with that are in proportion to it.

    Attributes:
        force: Spread of the forces that act [N or N m].
        speed, travel: Spread of velocity and position [m/s or rad/s, m or rad].
        middle: Mean position [m or rad].
        base: Nominal size of the effect that this one comes on top of, its first parameter; 0 where it comes on top of none.
    """

    force: float
    speed: float
    travel: float
    middle: float
    base: float


@dataclass(frozen=True)
class Applicability:
    """Where the question makes sense.

    Attributes:
        commanded: True where only the gas of a valve whose command was recorded shows it.
        moving: True where only the gas of a piston that moves shows it.
        two_chambers: True where it lies between two chambers of gas: a single-acting cylinder has none.
        places: Of its places those where it is asked; all of them where empty.
        known_at_joint: Number of a cylinder's record that holds the same of its joint: where the rig has it there, it is not asked.
        bursts: False where its law passes no fast bursts: beside a pressure that rings it is not named.
        partly_open: True where only a valve that is held partly open shows it: a spool that is thrown from end to end passes there in
            milliseconds, and the times of its lag say the same.
    """

    commanded: bool = False
    moving: bool = False
    two_chambers: bool = False
    places: tuple[str, ...] = ()
    known_at_joint: str = ""
    bursts: bool = True
    partly_open: bool = False


@dataclass(frozen=True)
class Twins:
    """Effects that do the same to all that was recorded, so that nobody can tell them apart by it.

    Attributes:
        unmeasured: Those that are the same where the pressure at their place was not recorded ...
        measured: ... and where it was.
        unless: A parameter that none of `measured` has: where it was fitted, they are distinguished.
        believed: Of its numbers, whether a twin that does the same has numbers that can be believed; None where it always has.
        beside_constant: Effect that is the same as this one where a constant force, or a force sensor's bias, acts beside it.
        damping: 1 where it looks like more damping of a joint than nominal, -1 like less; 0 where neither.
        unseen: Those that are the same where added to it they would not show: of play whose load never reverses only the give of its
            contacts does ...
        unseen_from: ... and where parameters are at least this: no contact gives as a strap does.
        in_one_chamber: Those that are the same in a single-acting cylinder, whose other chamber is the atmosphere.
        as_parts: Those that do the same where each of their parameters is so many times its own one: a shifted spool opens two edges sooner
            and two later.
    """

    unmeasured: tuple[str, ...] = ()
    measured: tuple[str, ...] = ()
    unless: str = ""
    believed: Callable[[Mapping[str, float]], bool] | None = None
    beside_constant: str = ""
    damping: int = 0
    unseen: tuple[str, ...] = ()
    unseen_from: Mapping[str, float] = field(default_factory=dict)
    in_one_chamber: tuple[str, ...] = ()
    as_parts: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def like(self, numbers: Mapping[str, float], is_measured: bool) -> tuple[str, ...]:
        """Return those that are the same as an effect of these numbers, where the pressure at its place was recorded or not."""
        if is_measured and self.unless in numbers:
            return ()
        names = self.measured if is_measured else self.unmeasured
        return names if self.believed is None or self.believed(numbers) else ()


@dataclass(frozen=True)
class Identification:
    """How the question is put to a recording.

    Attributes:
        forms: Which parameters are free together; one form with all of them where empty.
        further: Forms that are asked only of an effect that was found, where something is left beside it: for each, values to begin with of
            the parameters that come on top of the form that stands.
        switched: As `further`, forms that are asked from the beginning of a valve whose commands do nothing but switch it over.
        starts: Values to begin with where the range is wide or the answer not in proportion; else a low and a high typical one.
        starts_by_valve: Initial values by parameter, as many of each, an `area` in units of the valve's.
        starts_by_reach: As `starts`, areas in units of the valve's, lengths in units of half the stroke and counted from where the
            piston comes nearest to an end.
        starts_by_motion: For an effect on motion, as `starts` from what occurred. Most fits of motion begin where a linear family ended;
            these are for one that puts the effect into a model anew.
        shapes: By form, for a dead volume [m^3] that an owner may have counted it in: values of its parameters among which a fit may begin,
            where no single start is near every machine's.
        of_dead_volume: A parameter that owners count among both dead volumes: a fit may begin where it is taken off these.
        saturates: Areas in series with the valve, which throttle nothing from their upper bound on: where one ends there, what
            `of_dead_volume` holds is a size all the same, if it is more than data sheets of dead volumes leave open.
        within_speeds: Parameters that are speeds at which the law bends where motion begins: they are sought from half of the slowest speed
            that occurred to a quarter of the fastest, for beyond that such a bend is a number of the whole law.
        within_travels: Parameters that are positions near the travel: from far outside it a law that changes along it is a constant.
        common: A parameter of the effect that this comes on top of, and own ones that are added to it: only the sums show.
        multiplies: A factor on a number of the rig, and own parameters that multiply it as 1 plus each: only the products show.
        counts_from: What its numbers count from that may be another than the rig says, a number that every fit moves or an effect, with
            what is said then; `{}` is by how much that number is off.
        scale: Typical size of its parameters where neither its ranges nor the motion say it; 0 where they do.
        logarithmic: Whether its parameters span decades and are never zero: a fit moves their logarithms.
        neutral: Values at which it does nothing, where that is not zero.
        proportional: Whether it is linear in its parameters from zero on: a signature may then be scaled until it shows.
        jerky: Whether its answer is in jerks: play, dead zones, limits.
        healthy: What a healthy machine shows of a parameter as well: one standard deviation, and the most. A fit may move it up
            to there; only what is larger is a finding.
        least: Parameters of which less than this is no finding.
        adds_up: Whether its parameters are parts of one thing: then their sum is held against `least`.
        leaks: For a leak whose size is an area [m^2] or a laminar conductance [kg/(s Pa^2)], its share of what empties a healthy
            cylinder in some minutes; 0 where it is none.
        wall_heat: For heat into the wall, its share of what a film of still gas passes in every cylinder; 0 where it is none.
        resists: For what resists a piston, its share of the dry friction and the stiffness that a healthy one has; 0 where it does not.
        every_contact: Stiffness that every dry contact has: the diagnosis gives the machine a healthy one, asks all the same, and only
            one that is softer is a finding; "" where it is none.
        every_law: True where every machine follows some form of this law: the diagnosis chooses a healthy one where the
            owner gave none, and asks all the same.
        on_top_of: Effect that must be there for it to be asked.
        excluded: True where no diagnosis puts the question; a rig may have the effect all the same.
        open_by: Factors on the ends of a parameter's interval, for what the model itself leaves open ...
        closed_by: ... unless this parameter was fitted as well, ...
        closed_beside: ... or this effect acts at the same place.
        prevalence: Share of machines that have it, before any data.
        known: What is known of parameters before any data: mean and standard deviation.
        left_open: Questions to the law of an effect that a rig has: each a function of the numbers that the rig gives (those that it leaves
            out are absent) to the parameters that say how the law may go on, with values to begin with; none where it makes no sense there.
            A number that the rig gives is asked anew with them. Whether the law goes on so is asked as a law, no finding.
        is_law: Whether it only says how a law is written, in every machine: then it is no finding, but it goes into an improved rig.
        applicability: Where the question makes sense.
        twins: What cannot be distinguished from it.
    """

    forms: tuple[tuple[str, ...], ...] = ()
    further: Mapping[tuple[str, ...], Mapping[str, tuple[float, ...]]] = field(default_factory=dict)
    switched: Mapping[tuple[str, ...], Mapping[str, tuple[float, ...]]] = field(default_factory=dict)
    starts: Starts = ()
    starts_by_valve: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    starts_by_reach: Starts = ()
    starts_by_motion: Callable[[ObservedMotion], Starts] | None = None
    shapes: Mapping[tuple[str, ...], Callable[[float], Starts]] = field(default_factory=dict)
    of_dead_volume: str = ""
    saturates: tuple[str, ...] = ()
    within_speeds: tuple[str, ...] = ()
    within_travels: tuple[str, ...] = ()
    common: tuple[str, tuple[str, ...]] = ("", ())
    multiplies: tuple[str, tuple[str, ...]] = ("", ())
    counts_from: Mapping[str, str] = field(default_factory=dict)
    scale: float = 0.0
    logarithmic: bool = False
    neutral: Mapping[str, float] = field(default_factory=dict)
    proportional: bool = False
    jerky: bool = False
    healthy: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    least: Mapping[str, float] = field(default_factory=dict)
    adds_up: bool = False
    leaks: float = 0.0
    wall_heat: float = 0.0
    resists: float = 0.0
    every_contact: str = ""
    every_law: bool = False
    on_top_of: str = ""
    excluded: bool = False
    open_by: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    closed_by: str = ""
    closed_beside: str = ""
    prevalence: float = 0.1
    known: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    left_open: tuple[Callable[[Mapping[str, float]], Mapping[str, tuple[float, ...]]], ...] = ()
    is_law: bool = False
    applicability: Applicability = Applicability()
    twins: Twins = Twins()

    @property
    def parameters(self) -> dict[str, set[str]]:
        """Names of parameters that this speaks of, by the field in which it does."""
        lists = {"forms": {name for form in self.forms for name in form}}
        lists["shapes"] = {name for form in self.shapes for name in form}
        lists |= {
            key: {name for form, starts in getattr(self, key).items() for name in (*form, *starts)} for key in ("further", "switched")
        }
        given: list[dict[str, float]] = [{}, *(dict.fromkeys(form, 1.0) for form in self.forms)]
        lists["left_open"] = {name for question in self.left_open for known in given for name in question(known)}
        lists |= {key: set(getattr(self, key)) for key in ("within_speeds", "within_travels", "saturates")}
        lists |= {"common": set(self.common[1]), "multiplies": set(self.multiplies[1])}
        named = ("neutral", "healthy", "least", "open_by", "known", "starts_by_valve")
        tables = {key: set(getattr(self, key)) for key in named}
        single = {key: {getattr(self, key)} - {""} for key in ("every_contact", "closed_by")}
        return lists | tables | single | {"twins.unless": {self.twins.unless} - {""}, "twins.unseen_from": set(self.twins.unseen_from)}

    @property
    def though_on(self) -> bool:
        """Whether it is asked though the machine has it: then it is the diagnosis that gave it what every machine has."""
        return bool(self.every_contact)

    def beside(self, parameter: str) -> float:
        """Return what a healthy machine shows of a parameter beside its nominal value: one standard deviation."""
        return self.healthy.get(parameter, (0.0, 0.0))[0]

    def smallest(self, parameter: str) -> float:
        """Return what less of a parameter is no finding."""
        return self.least.get(parameter, self.healthy.get(parameter, (0.0, 0.0))[1])

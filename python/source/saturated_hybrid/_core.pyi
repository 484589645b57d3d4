"""The compiled part. SI units, rad; world z up, body x forward, y left, z up; quaternions scalar first, body to world.

Array arguments may be of any numeric type, or sequences. An argument that cannot be used is a `ValueError` naming it.
"""

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Self, TypedDict, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Allocation",
    "Campaign",
    "Certificate",
    "Claim",
    "Flight",
    "Governor",
    "Inequality",
    "Law",
    "LawRows",
    "Loop",
    "Network",
    "RotorVehicle",
    "Scenario",
    "Shield",
    "ShieldRows",
    "Tuned",
    "Vehicle",
    "VehicleRows",
    "campaign",
    "certify",
    "fly",
    "merge",
    "picture",
    "reference",
    "replay",
    "state",
    "tune",
]

class _Rotors(TypedDict):
    """The rotors of a vehicle."""

    position: NDArray[np.float64]
    """(n, 3), m, body, from the centre of mass."""
    spin: NDArray[np.float64]
    """(n,): the sign of the drag torque about body z: +1 clockwise seen from above, -1 counter-clockwise."""
    thrust_coefficient: NDArray[np.float64]
    """(n,), N/(rad/s)^2."""
    drag_coefficient: NDArray[np.float64]
    """(n,), N m/(rad/s)^2."""
    speed: NDArray[np.float64]
    """(n, 2), least and greatest, rad/s."""
    lag: float
    """First-order lag of the speeds, s."""

@final
class RotorVehicle:
    """The vehicle that a flight of the scenario simulates, under given thrusts of its rotors: their lag and limits, and the ground
    where the scenario has any, are its own."""

    def __new__(cls, scenario: Scenario) -> Self: ...
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any, /) -> Self: ...
    def step(self, thrusts: ArrayLike) -> None:
        """Holds the rotors' commanded thrusts (n,), N, for one plant step. `RuntimeError` where the motion is no longer finite."""
    @property
    def state(self) -> NDArray[np.float64]:
        """(13,): the true one."""
    @property
    def thrusts(self) -> NDArray[np.float64]:
        """(n,): the rotors' thrusts at this moment, N, after their lag."""
    @property
    def specific_force(self) -> NDArray[np.float64]:
        """(3,): what an accelerometer in the origin feels, the mean of the last step, m/s^2, body."""
    @property
    def stands(self) -> bool:
        """Whether it stands on the ground."""

@final
class Scenario:
    """A scenario: vehicle, limits, gains, start, reference and circumstances of a flight. docs/scenario-file.md has its
    keys.

    It never changes; `edited` gives a changed one. It can be pickled.
    """

    @staticmethod
    def load(path: str | PathLike[str]) -> Scenario:
        """Reads a TOML file. `ValueError` names the file, the field and the reason."""
    @staticmethod
    def parse(text: str, file: str = "scenario") -> Scenario:
        """Reads TOML text, which errors call `file`."""
    @staticmethod
    def built_in(name: str) -> Scenario:
        """One of `names()`: the repository's scenarios and vehicles."""
    @staticmethod
    def names() -> list[str]:
        """What `built_in` knows."""
    def edited(self, changes: Mapping[str, Any]) -> Scenario:
        """The scenario with other values, by their dotted paths: `{"vehicle.mass": 0.48, "wind": {"steady": [2, 0, 0]}}`.

        Numbers, text, booleans, lists and dictionaries; `None` takes a key or a section away. Comments in the text stay.
        """
    def reference(self, times: ArrayLike) -> NDArray[np.float32]:
        """The reference at `times` (n,), s, rounded to microseconds: (n, 19)."""
    @property
    def text(self) -> str:
        """The TOML."""
    @property
    def name(self) -> str:
        """Names the flight."""
    @property
    def law(self) -> str:
        """ "paper" or "extended"."""
    @property
    def duration(self) -> float:
        """s."""
    @property
    def period(self) -> float:
        """Of the control, s."""
    @property
    def ticks(self) -> int:
        """Control periods in `duration`."""
    @property
    def mass(self) -> float:
        """kg."""
    @property
    def gravity(self) -> float:
        """m/s^2."""
    @property
    def inertia(self) -> NDArray[np.float64]:
        """(3,), diagonal, kg m^2, body."""
    @property
    def thrust_max(self) -> float:
        """N."""
    @property
    def torque_max(self) -> NDArray[np.float64]:
        """(3,), N m, body."""
    @property
    def rotors(self) -> _Rotors | None:
        """None if thrust and torque act directly."""
    @property
    def initial(self) -> NDArray[np.float64]:
        """(13,): where it starts."""
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any, /) -> Self: ...

@final
class Inequality:
    """One inequality of a certificate: `required` below `available`."""

    @property
    def name(self) -> str:
        """Where it comes from (A1: Assumption 1, T1 and T2: Theorems 1 and 2, R: a rotor) and what it is about."""
    @property
    def unit(self) -> str:
        """Of both sides."""
    @property
    def required(self) -> float:
        """The left side."""
    @property
    def available(self) -> float:
        """The right side."""
    @property
    def margin(self) -> float:
        """The part of what is available that is left over; negative where it fails."""
    @property
    def holds(self) -> bool:
        """Whether it does."""

@final
class Loop:
    """One sampled loop about hover, with rotor lag and delays: an analysis of small motions, not a proof."""

    @property
    def axis(self) -> str:
        """ "roll", "pitch", "yaw", "lateral x", "lateral y" or "vertical"."""
    @property
    def spectral_radius(self) -> float:
        """Growth of an error per sample; stable below one."""
    @property
    def stable(self) -> bool:
        """Whether it is."""
    @property
    def gain_down(self) -> float | None:
        """Greatest factor below one on the loop's gain that destabilises it; 0 if none does. None if it is unstable as it is."""
    @property
    def gain_up(self) -> float | None:
        """Least factor above one that does; infinite if none does."""
    @property
    def delay(self) -> float | None:
        """Least further delay that does, s."""
    @property
    def crossover(self) -> float | None:
        """Highest frequency at which the loop's gain is one, rad/s."""
    @property
    def lacks(self) -> str | None:
        """What it lacks of the margin that flying takes, in words."""

@final
class Certificate:
    """Whether a scenario may fly: the proof that its commands stay within the limits, and its sampled loops. True if it may."""

    @property
    def certified(self) -> bool:
        """Whether it may fly."""
    @property
    def reasons(self) -> list[str]:
        """Everything that keeps it on the ground, in words; empty if nothing does."""
    @property
    def commands_proven(self) -> bool:
        """Whether every inequality holds, whatever the sampled loops do."""
    @property
    def inequalities(self) -> list[Inequality]:
        """All that decide."""
    @property
    def loops(self) -> list[Loop]:
        """The six sampled loops."""
    @property
    def thrust(self) -> tuple[float, float]:
        """Least and greatest thrust that the law can command, N."""
    @property
    def torque(self) -> NDArray[np.float64]:
        """(3,): greatest |torque| that it can command about each body axis, N m."""
    @property
    def rotors(self) -> NDArray[np.float64]:
        """(n, 2): least and greatest thrust that it can command of each rotor, N."""
    @property
    def report(self) -> str:
        """The output of `host-sim certify`."""
    def __bool__(self) -> bool: ...

def certify(scenario: Scenario) -> Certificate:
    """The certificate and the sampled loops of a scenario."""

@final
class Law:
    """The control law of a scenario, as after a reset: the bits that boards fly.

    What nothing certifies may be simulated too; `certified` says which it is.
    """

    def __new__(cls, scenario: Scenario) -> Self: ...
    @property
    def certified(self) -> bool:
        """Whether its commands are proven to stay within the limits."""
    def copy(self) -> Law:
        """Another law that remembers the same."""
    def reset(self) -> None:
        """Everything forgotten: how a flight begins."""
    def step(
        self, state: ArrayLike, reference: ArrayLike, acceleration: ArrayLike | None = None
    ) -> NDArray[np.float32]:
        """One control tick.

        Args:
            state: (13,).
            reference: (19,).
            acceleration: (3,), since the last tick, by an accelerometer, m/s^2, world: the law's estimates then rest on
                it. NaN, or left out: no accelerometer.

        Returns:
            The wrench (4,), N and N m, not clipped to any limit. `for_rotors` says what to ask the rotors for.

        Raises:
            ValueError: names the field that cannot be used; nothing has changed then.
        """
    def for_rotors(self, asked: ArrayLike) -> NDArray[np.float32]:
        """The rotors' command for a wrench (4,): the wrench over `thrust_scale`."""
    def set_period(self, period: float) -> None:
        """The time by which the next steps advance the filters, s, from 0.00025 to 0.1. It begins as the scenario's."""
    def hold_estimates(self) -> None:
        """After a step whose wrench was clipped: nothing can be learnt from that motion."""
    @property
    def thrust_scale(self) -> float:
        """What the rotors deliver of what is commanded, as far as the law knows; 1 under the paper's."""
    @property
    def estimates(self) -> dict[str, Any] | None:
        """`force` (3,) m/s^2 world, `torque` (3,) N m body, `thrust_scale`; None under the paper's law."""
    @property
    def diagnostics(self) -> dict[str, Any] | None:
        """What the last step went through, float32: errors, filters and desired motion, each (3,), `desired_attitude` and
        `attitude_error` (4,), `lift_sign`. None after a reset."""
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any, /) -> Self: ...

@final
class LawRows:
    """The law of rows of vehicles, each with its own memory. Rows are shared out to all cores."""

    def __new__(cls, scenario: Scenario, rows: int) -> Self: ...
    def __len__(self) -> int: ...
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any, /) -> Self: ...
    def reset(self, chosen: Sequence[bool] | None = None) -> None:
        """Resets the rows that are chosen, (rows,) bool; all of them if none are given."""
    def step(
        self, states: ArrayLike, references: ArrayLike, accelerations: ArrayLike | None = None
    ) -> NDArray[np.float32]:
        """One tick of every row: states (rows, 13), references (rows, 19), and accelerations (rows, 3) as of
        `Law.step`, to wrenches (rows, 4).

        If one is refused, the error names the row and no row has changed.
        """
    def hold_estimates(self, chosen: Sequence[bool] | None = None) -> None:
        """As `Law.hold_estimates`, of the rows that are chosen."""
    def for_rotors(self, wrenches: ArrayLike) -> NDArray[np.float32]:
        """As `Law.for_rotors`, of every row: (rows, 4)."""
    @property
    def thrust_scale(self) -> NDArray[np.float32]:
        """(rows,)."""

@final
class Shield:
    """The extended law flying what a policy demands, within its limits, and taking over while it must.

    docs/shield.md has the rules. It starts as before a flight; nothing that a policy demands is an error.

    Args:
        scenario: of the extended law.
        low, high: corners (3,) of the box to stay in, m, world; or (n, 3) of up to four boxes: it stays in one or
            another of them, and goes over where they overlap.
        margin: how far inside its boxes it is kept, m: as far as an estimated place may be from the true one.
        late: how late the velocity of states is where the acceleration has just changed, s; left out: 0.012 of a
            scenario with `[estimator]`, zero of any other.
        speed: the greatest speed of the policy, m/s.
        silence: for how long the last demand is flown if none comes, s.
        patience: how long the vehicle rests at its refuge before the policy gets it back, s; twice as long each time.
        patience_greatest: the longest such time, s.
        hand_overs: after so many the law keeps the vehicle, until `ask_again` or `reset`.
    """

    def __new__(
        cls,
        scenario: Scenario,
        *,
        low: ArrayLike,
        high: ArrayLike,
        margin: float = 0.0,
        late: float | None = None,
        speed: float = 10.0,
        silence: float = 0.1,
        patience: float = 1.0,
        patience_greatest: float = 16.0,
        hand_overs: int = 10,
    ) -> Self: ...
    def copy(self) -> Shield:
        """Another shield that remembers the same."""
    def reset(self) -> None:
        """As before a flight, law included."""
    def ask_again(self) -> None:
        """Counts hand-overs anew: the policy may fly again."""
    def step(
        self,
        state: ArrayLike,
        demand: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
        *,
        rotors: ArrayLike | None = None,
    ) -> NDArray[np.float32]:
        """One control tick.

        Args:
            state: (13,).
            demand: (4,) or (5,), or None where the policy says nothing.
            acceleration: (3,), as of `Law.step`.
            rotors: (4,) in place of a demand: speeds of the rotors of an X, from -1, the least, to 1, the greatest.

        Returns:
            The wrench (4,), as of `Law.step`.

        Raises:
            ValueError: names the field of the state that cannot be used; nothing has changed then.
        """
    @property
    def by_policy(self) -> bool:
        """Whether the policy flew the last step."""
    @property
    def reason(self) -> str:
        """Why the law flew it: "silent", "demand", "stop", "speed", "tilt", "rate" or "estimate"; "" where it did not."""
    @property
    def hand_overs(self) -> int:
        """How often the law took over since the reset, or since `ask_again`."""
    @property
    def rotors(self) -> NDArray[np.float32]:
        """(4,): the speeds that the rotors were told last, whoever flew, as `step` takes them; zeros for a vehicle that
        is no X."""
    @property
    def reference(self) -> NDArray[np.float32]:
        """The reference (19,), at rest: where the law flies to, or would if it took over now."""
    def for_rotors(self, asked: ArrayLike) -> NDArray[np.float32]:
        """As `Law.for_rotors`."""
    def hold_estimates(self) -> None:
        """As `Law.hold_estimates`."""
    @property
    def thrust_scale(self) -> float:
        """As `Law.thrust_scale`."""
    @property
    def diagnostics(self) -> dict[str, Any] | None:
        """As `Law.diagnostics`, with errors from `reference`."""
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any, /) -> Self: ...
    def __getnewargs_ex__(self) -> tuple[tuple[Scenario], dict[str, Any]]: ...

@final
class ShieldRows:
    """The shields of rows of vehicles, each with its own memory. Rows are shared out to all cores.

    Arguments as of `Shield`.
    """

    def __new__(
        cls,
        scenario: Scenario,
        rows: int,
        *,
        low: ArrayLike,
        high: ArrayLike,
        margin: float = 0.0,
        late: float | None = None,
        speed: float = 10.0,
        silence: float = 0.1,
        patience: float = 1.0,
        patience_greatest: float = 16.0,
        hand_overs: int = 10,
    ) -> Self: ...
    def __len__(self) -> int: ...
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any, /) -> Self: ...
    def __getnewargs_ex__(self) -> tuple[tuple[Scenario, int], dict[str, Any]]: ...
    def reset(self, chosen: Sequence[bool] | None = None) -> None:
        """Resets the rows that are chosen, (rows,) bool; all of them if none are given."""
    def ask_again(self, chosen: Sequence[bool] | None = None) -> None:
        """As `Shield.ask_again`, of the rows that are chosen."""
    def step(
        self,
        states: ArrayLike,
        demands: ArrayLike | None = None,
        accelerations: ArrayLike | None = None,
        *,
        rotors: ArrayLike | None = None,
    ) -> NDArray[np.float32]:
        """One tick of every row: states (rows, 13), demands (rows, 4) or (rows, 5), or None where no policy says anything,
        and accelerations (rows, 3) as of `Law.step`, to wrenches (rows, 4). `rotors` (rows, 4) in place of demands are
        speeds of the rotors of an X, from -1, the least, to 1, the greatest.

        If a state is refused, the error names the row and no row has changed.
        """
    @property
    def by_policy(self) -> NDArray[np.bool_]:
        """(rows,) bool: whether the policy flew the last step."""
    @property
    def reasons(self) -> list[str]:
        """As `Shield.reason`, of every row."""
    @property
    def hand_overs(self) -> NDArray[np.uint32]:
        """(rows,): as `Shield.hand_overs`."""
    @property
    def rotors(self) -> NDArray[np.float32]:
        """(rows, 4): as `Shield.rotors`."""
    @property
    def references(self) -> NDArray[np.float32]:
        """(rows, 19): as `Shield.reference`."""
    def hold_estimates(self, chosen: Sequence[bool] | None = None) -> None:
        """As `Law.hold_estimates`, of the rows that are chosen."""
    def for_rotors(self, wrenches: ArrayLike) -> NDArray[np.float32]:
        """As `Law.for_rotors`, of every row: (rows, 4)."""
    @property
    def thrust_scale(self) -> NDArray[np.float32]:
        """(rows,)."""

@final
class Network:
    """A network that decides on an acceleration and a yaw rate, or on the speeds of an X's rotors, from a file as
    docs/shield.md has it."""

    @staticmethod
    def read(path: str | PathLike[str]) -> Network:
        """Reads a TOML file. `ValueError` names the file, the field and the reason."""
    @staticmethod
    def parse(text: str, file: str = "policy") -> Network:
        """Reads TOML text, which errors call `file`."""
    @property
    def scale(self) -> NDArray[np.float32] | None:
        """(4,): what multiplies the outputs, m/s^2 three times and rad/s; None where they are speeds of rotors."""
    @property
    def period(self) -> float | None:
        """The time between two of its steps, s; None if any will do."""
    @property
    def demanded(self) -> str:
        """What it demands: "acceleration" or "rotors"."""
    def memory(self, rows: int) -> NDArray[np.float32]:
        """(rows, m) float32: what a network of recurrent layers remembers at first; m is zero for the others."""
    def inputs(
        self, states: ArrayLike, goals: ArrayLike, headings: ArrayLike, last: ArrayLike
    ) -> NDArray[np.float32]:
        """The inputs (n, 22), float32, of this network for states (n, 13), goals (n, 3), m, world, headings (n, 2),
        unit vectors, and what came last (n, 4): its outputs, zeros at first; or, where it demands speeds of rotors,
        the ones that flew, `ShieldRows.rotors`."""
    def advance(
        self, observations: ArrayLike, memories: ArrayLike
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """The outputs (n, 4) and memories (n, m), float32, for inputs (n, 22) and memories (n, m): of a network with
        recurrent layers, or of any other with m zero. Outputs that demand speeds may be beyond -1 and 1."""
    @staticmethod
    def observe(states: ArrayLike, goals: ArrayLike, headings: ArrayLike, outputs: ArrayLike) -> NDArray[np.float32]:
        """The inputs (n, 22), float32, for states (n, 13), goals (n, 3), m, world, headings (n, 2), unit vectors, and the
        last outputs (n, 4), zeros at first, of a network that demands accelerations. `ShieldRows.references[:, 15:17]`
        are the headings of a flight."""
    def act(self, observations: ArrayLike) -> NDArray[np.float32]:
        """The outputs (n, 4), float32, for inputs (n, 22). A network with recurrent layers wants `advance`."""
    def demands(self, outputs: ArrayLike, headings: ArrayLike) -> NDArray[np.float32]:
        """The demands (n, 4), float32, for outputs (n, 4) and headings (n, 2): accelerations in the world and yaw
        rates; or speeds, for `ShieldRows.step(…, rotors=…)`."""

@final
class Allocation:
    """From a wrench to the rotors' thrusts: what cannot be had is given up, yaw first, then thrust, roll and pitch last."""

    def __new__(cls, scenario: Scenario) -> Self: ...
    def __len__(self) -> int: ...
    def thrusts(self, asked: ArrayLike) -> tuple[NDArray[np.float32], bool]:
        """Thrusts (n,), N, each within its rotor's range, for a wrench (4,); and whether anything of it was given up."""
    def speeds(self, thrusts: ArrayLike) -> NDArray[np.float32]:
        """Rotor speeds (n,), rad/s, for thrusts (n,), N."""

@final
class Governor:
    """Any stream of setpoints in, a reference within the scenario's reference bounds out, once per control period.

    Args:
        scenario: bounds and period.
        horizontal_speed, vertical_speed: greatest commanded speeds, m/s.
        snap_ramp, heading_ramp: how long snap and psi'' take from one end of their bound to the other, s.
        timeout: how long velocities and rates are valid without renewal, s.
    """

    def __new__(
        cls,
        scenario: Scenario,
        *,
        horizontal_speed: float = 5.0,
        vertical_speed: float = 2.0,
        snap_ramp: float = 0.1,
        heading_ramp: float = 0.2,
        timeout: float = 0.5,
    ) -> Self: ...
    def start(self, position: ArrayLike, velocity: ArrayLike | None = None, yaw: float = 0.0) -> None:
        """Starts anew at a steady motion: (3,) m, (3,) m/s, world, across at most the scenario's
        `reference_bounds.horizontal_speed`; rad."""
    def accept(
        self,
        position: ArrayLike | Sequence[float | None] | None = None,
        velocity: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
        *,
        yaw: float | None = None,
        yaw_rate: float | None = None,
        late: float = 0.0,
    ) -> None:
        """Replaces the setpoint, world frame.

        A position alone: go there and rest. A velocity alone: move so. Both, and an acceleration: follow that moving point. A
        position with `None` on some axes: go there on the others, and on these move at the velocity. No yaw: keep the last one.
        `late`: how long ago it was true, s, at most 0.3; a moving point has gone on since.
        """
    def stop(self) -> None:
        """Gives up the setpoint and comes to rest."""
    @property
    def at_rest(self) -> bool:
        """Whether the reference rests at its setpoint."""
    def tick(self) -> NDArray[np.float32]:
        """The reference (19,) one period later."""
    def run(self, ticks: int) -> NDArray[np.float32]:
        """The references (ticks, 19) of as many periods. Interrupted, it is where it was."""
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any, /) -> Self: ...
    def __getnewargs_ex__(self) -> tuple[tuple[Scenario], dict[str, Any]]: ...

@final
class Claim:
    """What a flight claimed, and whether it holds: texts, as `host-sim fly` prints them."""

    @property
    def claim(self) -> str:
        """What it is about."""
    @property
    def required(self) -> str:
        """What must be; empty where nothing must."""
    @property
    def flown(self) -> str:
        """What was."""
    @property
    def holds(self) -> bool | None:
        """None where nothing is required."""

@final
class Flight:
    """A flight that was flown. Its length is its number of control ticks."""

    @property
    def columns(self) -> dict[str, NDArray[np.float64]]:
        """What log.csv holds, number by number: each column (ticks,), by its name there."""
    @property
    def claims(self) -> list[Claim]:
        """All of them."""
    @property
    def table(self) -> str:
        """The claims as a table."""
    @property
    def every_claim_holds(self) -> bool:
        """Whether none fails."""
    @property
    def certified(self) -> bool:
        """Whether the scenario may fly for real."""
    @property
    def reasons(self) -> list[str]:
        """Why not."""
    def __len__(self) -> int: ...

def fly(scenario: Scenario) -> Flight:
    """Flies a scenario. `RuntimeError` with the time if the flight cannot go on."""

@final
class Campaign:
    """What a campaign showed. As text: what `host-sim campaign` prints."""

    @property
    def flights(self) -> int:
        """How many there are, of a shard its own."""
    @property
    def tracking(self) -> int:
        """Flights that recovered and tracked."""
    @property
    def beyond(self) -> int:
        """Flights with a command beyond a certified bound."""
    @property
    def clipped(self) -> int:
        """Flights with a command that a rotor could not follow."""
    @property
    def failed_rotors(self) -> int:
        """Flights in which a rotor failed."""
    @property
    def false_alarms(self) -> int:
        """Flights in which the law found a rotor to fail that had not."""
    @property
    def refusal(self) -> str | None:
        """Why the scenario may not fly, if so."""
    @property
    def holds(self) -> bool:
        """Whether every flight tracks within all bounds, and the scenario may fly."""

def campaign(
    scenario: Scenario,
    directory: str | PathLike[str],
    *,
    flights: int | None = None,
    seed: int | None = None,
    shard: tuple[int, int] = ...,
    plant_step: float | None = None,
    law: str = ...,
    gains: str | PathLike[str] | None = None,
) -> Campaign:
    """Flies a campaign of randomised flights into a directory, on all cores, as `host-sim campaign` does and to the same bytes.

    The circumstances of a flight come from the seed and its number alone: any number of cores, any split and any interruption
    give the same. What is there already is not flown again.

    Args:
        scenario: its `[campaign]` section, if it has one, says what differs from flight to flight, and in how many a rotor fails.
        directory: where `campaign.arrow` and the rest go.
        flights, seed: of the whole campaign; left out: the scenario's.
        shard: (I, N): part I of N, from 1; `merge` puts the parts together.
        plant_step: s; left out: the longest of at most 5 ms that fits.
        law: whose flights, "ours" or one of docs/rivals.md: "lee", "px4", "mellinger", "indi", "nested", "continuous", "memoryless".
        gains: a file with that law's gains; left out: those built in for the vehicles of docs/rivals.md.

    Raises:
        ValueError: names the argument, or says that the directory holds another campaign.
        OSError: it cannot be written.
    """

def merge(shards: Sequence[str | PathLike[str]], directory: str | PathLike[str]) -> Campaign:
    """Puts all shards of a campaign together, in any order: the same bytes as the campaign that was never split."""

@final
class Tuned:
    """Gains that a search found, and what they showed."""

    @property
    def scenario(self) -> Scenario:
        """The scenario with these gains."""
    @property
    def height_lost(self) -> float:
        """From upside down, m."""
    @property
    def recovered(self) -> float:
        """Time until back for good, s."""
    @property
    def gust(self) -> float:
        """Deepest excursion in a gust of 5 m/s, m."""
    @property
    def step(self) -> float:
        """Time until a step of 1 m is flown, s."""
    @property
    def noise(self) -> float:
        """RMS of the position under noise, m."""
    @property
    def cost(self) -> float:
        """What the search made small."""
    @property
    def cost_before(self) -> float:
        """The same of the constants that the search started from."""
    @property
    def judged(self) -> int:
        """Candidates."""

def tune(
    scenario: Scenario,
    *,
    name: str | None = None,
    generations: int = 60,
    population: int = 24,
    seed: int = 1,
    margin: float = 0.0,
    gain_margin: float = 1.75,
    delay_margin: float = 0.003,
    position_error: float = 0.02,
    mrp_error: float = 0.01,
    recovery: float = 20.0,
    projection: bool = True,
) -> Tuned:
    """Refines a scenario's constants: they certify, and then please a pilot most; about a minute, on all cores. As `host-sim tune`.

    Args:
        name: of the tuned scenario; left out: its own with `-tuned`.
        generations, population, seed: how hard to search, and from which seed: the same gives the same gains.
        margin: least margin of every inequality, as a fraction.
        gain_margin: least gain margin of every sampled loop, 1.5 or more.
        delay_margin: least delay margin of every sampled loop, s, 0.002 or more.
        position_error, mrp_error: greatest of the scenario's own flight in its last quarter, m and 1.
        recovery: how long a recovery from upside down may take, s, 2 or more; its last quarter must be still.
        projection: whether the paper's law may use the thrust projection.

    Raises:
        RuntimeError: no gains met the requirements; says in what the closest fail.
    """

@final
class Vehicle:
    """A vehicle's numbers from another program, as a vehicle file; what the source has not is marked in it, never guessed.

    docs/import.md has the formats.
    """

    @staticmethod
    def from_rotorpy(quad_params: dict[str, Any], name: str = "vehicle", neglect_products: bool = False) -> Vehicle:
        """The vehicle of RotorPy's dictionary, e.g. `rotorpy.vehicles.crazyflie_params.quad_params`.

        `ValueError` names the key and the reason. Products of inertia are written as they are, which no scenario takes,
        unless they are to be neglected.
        """
    @staticmethod
    def read(path: str | PathLike[str], name: str | None = None, format: str | None = None, neglect_products: bool = False) -> Vehicle:
        """The vehicle of a file: RotorPy's (Python or JSON), URDF, SDF, MuJoCo's XML, PX4's parameters.

        `format` is "rotorpy", "urdf", "sdf", "mujoco" or "px4", left out what the file looks like; `name` left out the
        file's. `ValueError` names the file, the element and the reason.
        """
    def scenario(self, changes: Mapping[str, Any] | None = None) -> Scenario:
        """The vehicle as a scenario, with numbers of your own by their dotted paths: `{"rotors.lag": 0.03}`.

        `ValueError` names the numbers that are still missing.
        """
    @property
    def name(self) -> str:
        """Names the vehicle."""
    @property
    def text(self) -> str:
        """The vehicle file, TOML: `Scenario.parse` reads it if nothing is missing."""
    @property
    def missing(self) -> list[str]:
        """Dotted paths of the numbers that the source has not."""
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any, /) -> Self: ...

@final
class VehicleRows:
    """Rows of the vehicle that a flight of the scenario simulates, under given wrenches."""

    def __new__(cls, scenario: Scenario, rows: int) -> Self: ...
    def __len__(self) -> int: ...
    def __copy__(self) -> Self: ...
    def __deepcopy__(self, _memo: Any, /) -> Self: ...
    def place(
        self, states: ArrayLike, chosen: Sequence[bool] | None = None, seeds: Sequence[int] | None = None
    ) -> None:
        """Starts the rows that are chosen anew at their rows of `states` (rows, 13); `seeds` (rows,) are their noise's and
        turbulence's. An estimator is aligned, in motion, for the three seconds before. If a row is refused, the error
        names it and no row has changed."""
    def step(self, wrenches: ArrayLike) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Holds wrenches (rows, 4), N and N m, for one control period. Returns which were clipped by limits or rotors, and which
        rows go no further, each (rows,): their motion is no longer finite, or their estimator has no state."""
    @property
    def states(self) -> NDArray[np.float64]:
        """(rows, 13): the true ones."""
    @property
    def measured(self) -> NDArray[np.float64]:
        """(rows, 13): the states that a controller gets: measured, by the scenario's `[sensors]`, or estimated, by its
        `[estimator]`; without either section the true ones."""
    @property
    def accelerations(self) -> NDArray[np.float64]:
        """(rows, 3): the acceleration since the last period by an accelerometer, m/s^2, world; NaN without one."""
    @property
    def jumped(self) -> NDArray[np.bool_]:
        """(rows,) bool: whether the estimated state has jumped since the last period, by a pose and not by motion."""
    @property
    def references(self) -> NDArray[np.float32]:
        """(rows, 19): the scenario's, each at its row's own time."""
    @property
    def ticks(self) -> NDArray[np.uint64]:
        """(rows,): periods since each was placed."""

def picture(
    states: ArrayLike,
    references: ArrayLike,
    *,
    things: Sequence[ArrayLike] = ...,
    around: ArrayLike | None = None,
) -> NDArray[np.uint8]:
    """A picture (420, 480, 3) of uint8, as a camera that stands far away: the path of `states` (n, 13) with its shadow on the
    floor, that of `references` (n, 19), and the vehicle, larger than life, at the last of them.

    Args:
        states, references: of a flight, row by row.
        things: lines that stand in the world, each (k, 3), m: a gate.
        around: points (k, 3), m, that the picture holds as well, so that it stands still while the path grows.
    """

def replay(
    scenario: Scenario,
    path: str | PathLike[str],
    states: ArrayLike,
    references: ArrayLike,
    wrenches: ArrayLike,
    *,
    things: Sequence[ArrayLike] = ...,
    by_policy: ArrayLike | None = None,
    speed: float = 1.0,
) -> None:
    """Writes a flight that something else flew into a file that any browser opens: a moving picture, `.gif`, or a page with
    a replay and plots, `.html`.

    Args:
        scenario: its vehicle and its period.
        path: what to write.
        states, references, wrenches: of a flight, row by row: (n, 13), (n, 19), (n, 4).
        things: lines that stand in the world, each (k, 3), m; a page has none.
        by_policy: (n,), whether a policy flew; the page then shows it.
        speed: seconds of flight in a second of the moving picture.
    """

def state(
    position: ArrayLike | None = None,
    velocity: ArrayLike | None = None,
    attitude: ArrayLike | None = None,
    angular_velocity: ArrayLike | None = None,
    *,
    euler: ArrayLike | None = None,
) -> NDArray[np.float64]:
    """A state (13,): (3,) m, (3,) m/s world, (4,) scalar first, (3,) rad/s body. What is left out: at rest at the origin, level,
    facing world x. `euler` (3,) instead of `attitude`: roll, pitch, yaw in rad, R = Rz(yaw) Ry(pitch) Rx(roll)."""

def reference(
    position: ArrayLike | None = None,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    jerk: ArrayLike | None = None,
    snap: ArrayLike | None = None,
    yaw: float = 0.0,
    yaw_rate: float = 0.0,
    yaw_acceleration: float = 0.0,
) -> NDArray[np.float32]:
    """A reference (19,), world: (3,) each, in m to m/s^4; rad, rad/s, rad/s^2. What is left out is zero."""

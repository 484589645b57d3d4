"""RAPTOR, a foundation policy for quadrotors, converted and flown: bare, behind the shield, and beside the law alone.

    python python/examples/raptor.py convert --out vehicles/policies/raptor.toml
    python python/examples/raptor.py fly
    python python/examples/raptor.py ways

`convert` makes a policy file of the checkpoint in the package foundation-policy. `fly` flies that file: the numbers
come from the wheel's network, to the bits that boards fly. `ways` compares ways to make a demand. The wheel and numpy
are enough for these two. docs/foundation-policy.md has the tables.
"""

import argparse
import pathlib
import sys
import textwrap

import numpy as np
import saturated_hybrid as sh
from saturated_hybrid.textbook import rotations

TOP = pathlib.Path(__file__).resolve().parents[2]
POLICY = TOP / "vehicles/policies/raptor.toml"
VEHICLES = {
    "hummingbird": "vehicles/hummingbird.toml",
    "x500": "vehicles/published/x500.toml",
    "cf2-forster": "vehicles/published/cf2-forster.toml",
    "cf2x-pybullet": "vehicles/published/cf2x-pybullet.toml",
    "racer-pybullet": "vehicles/published/racer-pybullet.toml",
    "iris": "vehicles/published/iris.toml",
}

# Columns of a policy file.
WIDTH = 100
# What it sees at most along each axis, m and m/s: as in its training.
FARTHEST, FASTEST = 1.0, 2.0
# The room, m: a vehicle that leaves it is lost. The shield's box is inside.
LOW, HIGH = np.array([-6.0, -6.0, 0.0]), np.array([6.0, 6.0, 9.0])
MARGIN = 0.3
DURATION, JUDGED = 8.0, 2.0  # s: of a flight, and of its end, in which position errors count
MIDDLE = np.array([0.0, 0.0, 4.5])

HEADER = """\
# RAPTOR, a foundation policy for quadrotor control (J. Eschmann, D. Albani, G. Loianno, arXiv 2509.11481), as the
# package foundation-policy {version} has it. MIT licence, Copyright (c) 2025 Jonas Eschmann: raptor.LICENSE beside this
# file. Converted by python/examples/raptor.py; no number is changed.
demands = "rotors"
farthest = {farthest}                       # m
fastest = {fastest}                        # m/s
period = 0.01                        # s
"""


def text_of(checkpoint, version):
    """A policy file with the numbers of a checkpoint: an open HDF5 file."""
    lines = [HEADER.format(version=version, farthest=FARTHEST, fastest=FASTEST)]
    layers = checkpoint["actor"]["layers"]
    for number in range(len(layers)):
        layer = layers[str(number)]
        kind = layer.attrs["type"]
        lines.append("[[layers]]")
        if kind == "dense":
            lines.append(f'activation = "{layer.attrs["activation_function"].lower()}"')
            names = {"weights": "weights", "biases": "biases"}
        elif kind == "gru":
            lines.append('kind = "gru"')
            names = {
                "input_weights": "weights_input",
                "input_biases": "biases_input",
                "hidden_weights": "weights_hidden",
                "hidden_biases": "biases_hidden",
                "initial": "initial_hidden_state",
            }
        else:
            sys.exit(f"error: layer {number}: there is no place for a layer of type {kind}")
        for ours, theirs in names.items():
            values = np.asarray(layer[theirs]["parameters"], np.float32)
            if ours.endswith("weights"):
                rows = ",\n".join(textwrap.indent(numbers(row), "    ") for row in values)
                lines.append(f"{ours} = [\n{rows},\n]")
            else:
                lines.append(f"{ours} = {numbers(values.ravel())}")
        lines.append("")
    return "\n".join(lines[:-1]) + "\n"


def numbers(values):
    """Single-precision numbers with the digits that reading back bit for bit takes."""
    text = "[" + ", ".join(str(value) for value in values) + "]"
    return textwrap.fill(text, WIDTH, subsequent_indent="     ")


def converted():
    """The text of the policy file, from the package foundation-policy."""
    import importlib.metadata
    import importlib.resources

    import h5py

    path = importlib.resources.files("foundation_policy").joinpath("blob", "checkpoint.h5")
    with h5py.File(path, "r") as checkpoint:
        return text_of(checkpoint, importlib.metadata.version("foundation-policy"))


class Rotors:
    """The rotors of an X in RAPTOR's order: front right, back right, back left, front left."""

    QUARTERS = ((1, -1), (-1, -1), (-1, 1), (1, 1))

    def __init__(self, scenario):
        given = scenario.rotors
        positions = np.asarray(given["position"], float)
        order = [int(np.flatnonzero((positions[:, :2] * quarter > 0.0).all(axis=1))[0]) for quarter in self.QUARTERS]
        positions = positions[order]
        per_thrust = (given["drag_coefficient"] / given["thrust_coefficient"])[order]
        self.columns = np.stack([np.ones(4), positions[:, 1], -positions[:, 0], given["spin"][order] * per_thrust])
        # The roots of the least and the greatest thrust, sqrt(N).
        self.least, self.greatest = (given["speed"][order] * np.sqrt(given["thrust_coefficient"])[order, None]).T

    def wrenches(self, speeds):
        """Wrenches (n, 4) of speeds (n, 4); what is beyond -1 and 1 is cut, and what rounding takes over the end."""
        shares = 0.5 + 0.5 * np.clip(speeds, -1.0, 1.0)
        thrusts = np.square(self.least + shares * (self.greatest - self.least))
        unused = 1e-5 * (self.greatest**2 - self.least**2)
        return np.clip(thrusts, self.least**2 + unused, self.greatest**2 - unused) @ self.columns.T


class Policy:
    """Rows of RAPTOR."""

    def __init__(self, network, rows):
        self.network, self.memory = network, network.memory(rows)

    def act(self, states, goals, headings, last):
        """Speeds (rows, 4), as the network has them: beyond -1 and 1, too."""
        speeds, self.memory = self.network.advance(self.network.inputs(states, goals, headings, last), self.memory)
        return speeds


class Bare:
    """Its speeds to the rotors as they are, cut at their ranges."""

    def __init__(self, scenario, network, states, goals, box):
        self.rotors, self.goals = Rotors(scenario), goals
        self.policy, self.last = Policy(network, len(states)), np.zeros((len(states), 4))
        self.headings = facing(states)

    def step(self, states):
        """Wrenches, which rows the policy flies, and which commands were beyond the rotors' ranges."""
        speeds = self.policy.act(states, self.goals, self.headings, self.last)
        self.last = np.clip(speeds, -1.0, 1.0)
        return self.rotors.wrenches(speeds), np.ones(len(states), bool), (np.abs(speeds) > 1.0).any(axis=1)

    def end(self, clipped):
        pass


class Shielded:
    """Its speeds behind the shield.

    `told`: what it sees as its last action: "flown", what the rotors were told, or "said", what it said.
    `current`: whether its memory goes on while the law flies; otherwise it begins anew at every hand-over to it.
    `way`: "direct" speeds, or an "attitude" some time ahead.
    """

    def __init__(self, scenario, network, states, goals, box, told="flown", current=True, way="direct", ahead=0.0):
        rows = len(states)
        self.shield = sh.ShieldRows(scenario, rows, low=box[0], high=box[1])
        self.goals, self.policy, self.rotors = goals, Policy(network, rows), Rotors(scenario)
        self.headings, self.said, self.told = facing(states), np.zeros((rows, 4)), told
        self.current, self.way, self.ahead = current, way, ahead
        self.inertia, self.flies = np.asarray(scenario.inertia, float), np.ones(rows, bool)

    def step(self, states):
        """As `Bare.step`. Nothing is beyond the rotors' ranges by the shield's doing: the simulator says what is."""
        if not self.current:
            self.policy.memory = np.where(self.flies[:, None], self.policy.memory, 0.0)
        last = self.shield.rotors if self.told == "flown" else self.said
        speeds = self.policy.act(states, self.goals, self.headings, last)
        self.said = np.clip(speeds, -1.0, 1.0)
        if self.way == "direct":
            wrenches = self.shield.step(states, rotors=speeds)
        else:
            wrenches = self.shield.step(states, self.attitudes(states, self.rotors.wrenches(speeds)))
        self.headings = self.shield.references[:, 15:17]
        self.flies = np.asarray(self.shield.by_policy)
        return self.shield.for_rotors(wrenches), self.flies, np.zeros(len(states), bool)

    def attitudes(self, states, wrenches):
        """Demands (rows, 5): where the attitude would be after `ahead` with this torque, and the thrust."""
        rates = states[:, 10:13]
        torques = wrenches[:, 1:] - np.cross(rates, self.inertia * rates)
        angles = rates * self.ahead + 0.5 * self.ahead**2 * torques / self.inertia
        return np.concatenate([turned_by(states[:, 6:10], angles), wrenches[:, :1]], axis=1)

    def end(self, clipped):
        if clipped.any():
            self.shield.hold_estimates(clipped.tolist())


class Law:
    """The law alone, to rest at the goal."""

    def __init__(self, scenario, network, states, goals, box):
        self.laws = sh.LawRows(scenario, len(states))
        self.references = np.zeros((len(states), 19), np.float32)
        self.references[:, :3], self.references[:, 15:17] = goals, facing(states)

    def step(self, states):
        """As `Bare.step`."""
        wrenches = self.laws.for_rotors(self.laws.step(states, self.references))
        return wrenches, np.zeros(len(states), bool), np.zeros(len(states), bool)

    def end(self, clipped):
        if clipped.any():
            self.laws.hold_estimates(clipped.tolist())


def facing(states):
    """Where vehicles face, level: unit vectors (n, 2)."""
    ahead = rotations(states[:, 6:10])[:, :2, 0]
    length = np.linalg.norm(ahead, axis=1, keepdims=True)
    return np.where(length > 1e-3, ahead / np.maximum(length, 1e-3), [1.0, 0.0])


def turned_by(quaternions, angles):
    """Attitudes (n, 4) turned by rotation vectors (n, 3) about their own axes."""
    size = np.linalg.norm(angles, axis=1, keepdims=True)
    vector = angles * 0.5 * np.sinc(0.5 * size / np.pi)
    scalar = np.cos(0.5 * size[:, 0])
    w, v = quaternions[:, 0], quaternions[:, 1:]
    product = w[:, None] * vector + scalar[:, None] * v + np.cross(v, vector)
    joined = np.concatenate([(w * scalar - np.sum(v * vector, axis=1))[:, None], product], axis=1)
    return joined / np.linalg.norm(joined, axis=1, keepdims=True)


def starts(random, count, away=1.5, speed=0.5, tilt=(0.0, 0.5)):
    """States about the room's middle: within `away` along each axis, in motion, tilted, facing anywhere."""
    states = []
    for _ in range(count):
        lean, direction, yaw = random.uniform(*tilt), random.uniform(-np.pi, np.pi), random.uniform(-np.pi, np.pi)
        axis = np.array([np.cos(direction), np.sin(direction), 0.0])
        # Yaw first: about the world's z.
        facing_yaw = np.array([[np.cos(0.5 * yaw), 0.0, 0.0, np.sin(0.5 * yaw)]])
        attitude = turned_by(facing_yaw, lean * axis[None])
        velocity = random.normal(size=3)
        velocity *= speed * random.uniform() / np.linalg.norm(velocity)
        states.append(sh.state(MIDDLE + random.uniform(-away, away, 3), velocity, attitude[0]))
    return np.array(states)


def at_the_middle(states, random):
    """Goals in the middle."""
    return np.tile(MIDDLE, (len(states), 1))


def far_off(states, random):
    """Goals 4 m from the start along x and y and 2 m in height."""
    steps = np.array([4.0, 4.0, 2.0]) * random.choice([-1.0, 1.0], (len(states), 3))
    return np.clip(states[:, :3] + steps, LOW + 1.5, HIGH - 1.5)


def beside_a_wall(states, random):
    """Goals 0.3 m inside the shield's box, at one of four walls."""
    goals = at_the_middle(states, random)
    side = random.choice([-1.0, 1.0], len(states)) * (HIGH[0] - MARGIN - 0.3)
    goals[np.arange(len(states)), random.integers(0, 2, len(states))] = side
    return goals


# Name, changes to the scenario, starts, goals.
CONDITIONS = (
    ("calm", {}, {}, at_the_middle),
    ("wind", {"wind": {"steady": [3.0, 0.0, 0.0], "turbulence": {"wind_at_20_feet": 5.0, "altitude": 10.0, "seed": 1}}},
     {}, at_the_middle),
    ("a rotor at 70 %", {"truth.rotor_scales": [0.7, 1.0, 1.0, 1.0]}, {}, at_the_middle),
    ("upside down", {}, {"tilt": (2.6, np.pi)}, at_the_middle),
    ("4 m away, up to 4 m/s", {}, {"speed": 4.0}, far_off),
    ("goal at the wall", {}, {}, beside_a_wall),
)  # fmt: skip

PILOTS = {"RAPTOR": Bare, "RAPTOR, shield": Shielded, "law": Law}


def scenario_of(file, changes):
    """A vehicle's scenario for these flights."""
    rest = {"reference": {"kind": "hover", "position": MIDDLE.tolist()}, "initial": {"position": MIDDLE.tolist()}}
    scenario = sh.Scenario.load(str(TOP / file)).edited(rest | {"duration": DURATION, "control.rate": 100.0})
    if "wind" in changes and not scenario_has_drag(file):
        # Wind needs something to push at: what the Hummingbird's frame has, by the square of the size of its mass.
        share = (scenario.mass / 0.5) ** (2 / 3)
        scenario = scenario.edited({"drag": {"frame": [5e-3 * share, 5e-3 * share, 1e-2 * share]}})
    return scenario.edited(changes) if changes else scenario


def scenario_has_drag(file):
    """Whether a vehicle's file says what the air does to it."""
    return "[drag]" in (TOP / file).read_text()


def fly(scenario, pilot, states, goals, seed, vehicles=None, **options):
    """Flies every row to the end, of our simulator's vehicles or of other `vehicles`: numbers by name."""
    rows, box = len(states), (LOW + MARGIN, HIGH - MARGIN)
    if vehicles is None:
        vehicles = sh.VehicleRows(scenario, rows)
        vehicles.place(states, None, list(range(seed, seed + rows)))
    else:
        vehicles.place(states)
    pilot = pilot(scenario, sh.Network.read(str(POLICY)), states, goals, box, **options)
    alive, out = np.ones(rows, bool), np.zeros(rows)
    flown, by_policy, beyond = np.zeros(rows), np.zeros(rows), np.zeros(rows)
    errors, ticks = [], round(DURATION / scenario.period)
    for tick in range(ticks):
        measured = np.where(alive[:, None], vehicles.measured, states)
        wrenches, policy, cut = pilot.step(measured)
        clipped, gone = vehicles.step(wrenches)
        pilot.end(clipped)
        flown += alive
        by_policy += alive & policy
        beyond += alive & (cut | clipped)
        places = np.nan_to_num(vehicles.states[:, :3], nan=1e6)
        out = np.where(alive, np.maximum(out, np.maximum(box[0] - places, places - box[1]).max(axis=1)), out)
        alive &= ~gone & (places > LOW).all(axis=1) & (places < HIGH).all(axis=1)
        if tick >= ticks - round(JUDGED / scenario.period):
            errors.append(np.where(alive, np.linalg.norm(places - goals, axis=1), np.nan))
    mean = np.mean(errors, axis=0)
    return {
        "lost": int((~alive).sum()),
        "out": float(max(0.0, out.max())),
        "left": int((out > 0.0).sum()),
        "beyond": beyond.sum() / flown.sum(),
        "by_policy": by_policy.sum() / flown.sum(),
        "error": float(np.nanmedian(mean)) if alive.any() else np.nan,
        "worst": float(np.nanmax(mean)) if alive.any() else np.nan,
    }


def drawn(condition, episodes, seed):
    """Starts and goals of a condition: the same for every vehicle and pilot."""
    _, _, options, goals_of = condition
    random = np.random.default_rng(seed)
    states = starts(random, episodes, **options)
    return states, goals_of(states, random)


HEAD = (
    "lost: bare, shield, law",
    "left the box at most by, shield",
    "beyond the rotors, bare, shield",
    "policy flew, shield",
    "error, bare",
    "error, shield",
)
WAYS_HEAD = ("lost", "left the box at most by", "policy flew", "error")


def error(seen):
    """Median and worst."""
    return "-" if np.isnan(seen["error"]) else f"{seen['error']:.3f}, {seen['worst']:.2f} m"


def out(seen):
    """How far a vehicle was outside of the box."""
    return f"{seen['out']:.2f} m" if seen["left"] else "0"


def cells(bare, shielded, law):
    """The cells of a row, of the three pilots' flights."""
    lost = ", ".join(str(seen["lost"]) for seen in (bare, shielded, law))
    beyond = f"{bare['beyond']:.1%}, {shielded['beyond']:.1%}".replace("%", " %")
    return lost, out(shielded), beyond, f"{shielded['by_policy']:.0%}".replace("%", " %"), error(bare), error(shielded)


def row(*columns):
    print("| " + " | ".join(map(str, columns)) + " |", flush=True)


def table(names, conditions, episodes, seed):
    """Prints the table of `fly`."""
    row("vehicle", "flight", *HEAD)
    row(*["---"] * (2 + len(HEAD)))
    for name in names:
        for condition in CONDITIONS:
            if conditions and condition[0] not in conditions:
                continue
            scenario = scenario_of(VEHICLES[name], condition[1])
            states, goals = drawn(condition, episodes, seed)
            seen = [fly(scenario, flies, states, goals, seed) for flies in PILOTS.values()]
            row(name, condition[0], *cells(*seen))


WAYS = {
    "speeds, sees what flew": {},
    "speeds, sees what it said": {"told": "said"},
    "speeds, forgets at hand-overs": {"current": False},
    "attitude now": {"way": "attitude"},
    "attitude 50 ms ahead": {"way": "attitude", "ahead": 0.05},
    "attitude 100 ms ahead": {"way": "attitude", "ahead": 0.1},
    "attitude 200 ms ahead": {"way": "attitude", "ahead": 0.2},
}


def ways(names, conditions, episodes, seed):
    """Prints the table of `ways`."""
    row("vehicle", "flight", "demand", *WAYS_HEAD)
    row(*["---"] * (3 + len(WAYS_HEAD)))
    for name in names:
        for condition in CONDITIONS:
            if condition[0] not in (conditions or ("calm", "upside down", "4 m away, up to 4 m/s")):
                continue
            scenario = scenario_of(VEHICLES[name], condition[1])
            states, goals = drawn(condition, episodes, seed)
            for way, options in WAYS.items():
                seen = fly(scenario, Shielded, states, goals, seed, **options)
                row(name, condition[0], way, seen["lost"], out(seen), f"{seen['by_policy']:.0%}", error(seen))


def main(given=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("do", choices=["convert", "fly", "ways"])
    parser.add_argument("--out", default=str(POLICY), help="the policy file that `convert` writes")
    parser.add_argument("--vehicles", nargs="*", choices=list(VEHICLES), default=None)
    parser.add_argument("--flights", nargs="*", choices=[name for name, *_ in CONDITIONS], default=None)
    parser.add_argument("--episodes", type=int, default=100, help="of each pilot")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args(given)
    if arguments.do == "convert":
        pathlib.Path(arguments.out).write_text(converted())
        return
    if arguments.do == "fly":
        table(arguments.vehicles or VEHICLES, arguments.flights, arguments.episodes, arguments.seed)
    else:
        ways(arguments.vehicles or ["hummingbird"], arguments.flights, arguments.episodes, arguments.seed)


if __name__ == "__main__":
    main()

"""Learns to hover behind the shield with three vehicles and three seeds each, in wind: is it one lucky run?

    python python/examples/learn_vehicles.py --out learnt

Nine runs, each a short form of python/examples/learn.py's, on a Hummingbird, an x500 and a Crazyflie, in 2 m/s of wind
with turbulence. It prints a row of a table for each: episodes lost while it learnt, and a hundred episodes of the
learnt policy on the true states and on those of the boards' estimator. docs/learning.md has the table.
"""

import argparse
import pathlib
import time

from judge import TASKS, Flights, Network, scenario_of
from learn import learn
from saturated_hybrid.actions import kinds

VEHICLES = {
    "Hummingbird": "vehicles/hummingbird.toml",
    "x500": "vehicles/published/x500.toml",
    "Crazyflie": "vehicles/published/cf-rotorpy.toml",
}
TOP = pathlib.Path(__file__).resolve().parent.parent.parent
WIND = 2.0  # m/s
HEAD = (
    "vehicle",
    "seed",
    "lost in learning",
    "earned at first",
    "learnt",
    "estimated",
    "lost",
    "left the box",
    "beyond the rotors",
    "policy flew",
    "took, s",
)


def run(name, seed, generations, episodes, out):
    """Learns once, and flies what was learnt: the cells of a row."""
    scenario, began = scenario_of(TOP / VEHICLES[name], WIND), time.monotonic()
    start, quiet = Network.untrained(seed), lambda line: None
    network, curve = learn("hover", True, generations, start, seed, report=quiet, scenario=scenario)
    took = time.monotonic() - began
    if out:
        scale = kinds(TASKS["hover"](scenario, 1).scenario)["forward"].high
        (out / f"hover-{name.lower()}-{seed}.toml").write_text(network.text("hover", scale))
    seen = [
        Flights("hover", episodes, TASKS["hover"].box, scenario, estimated).fly(network.act, list(range(episodes)))
        for estimated in (False, True)
    ]
    flown = sum(each["flown"].sum() for each in seen)
    total = {key: sum(each[key].sum() for each in seen) for key in ("lost", "clipped", "by_policy")}
    out_of_box = sum((each["out"] > 0.0).sum() for each in seen)
    earned = [f"{each['earned'].mean():.0f}" for each in seen]
    shares = [f"{total[key] / flown:.1%}" for key in ("clipped", "by_policy")]
    lost = (int(curve[-1, 2]), int(total["lost"]))
    return name, seed, lost[0], f"{curve[0, 1]:.0f}", *earned, lost[1], out_of_box, *shares, f"{took:.0f}"


def main(given=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, help="directory for the weights; left out: they are not kept")
    parser.add_argument("--generations", type=int, default=20)
    both = "of the learnt policy, on true states and on estimates each"
    parser.add_argument("--episodes", type=int, default=100, help=both)
    parser.add_argument("--vehicle", choices=list(VEHICLES), action="append", help="left out: all three")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    arguments = parser.parse_args(given)
    if arguments.out:
        arguments.out.mkdir(parents=True, exist_ok=True)
    table = []
    print("| " + " | ".join(HEAD) + " |")
    print("|" + "---|" * len(HEAD))
    for name in arguments.vehicle or VEHICLES:
        for seed in arguments.seeds:
            table.append(run(name, seed, arguments.generations, arguments.episodes, arguments.out))
            print("| " + " | ".join(map(str, table[-1])) + " |", flush=True)
    return table


if __name__ == "__main__":
    main()

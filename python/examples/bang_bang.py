"""All that there is, to and fro: 200 vehicles behind the shield under a policy that swings them as hard as they can.

    python python/examples/bang_bang.py                                     a Hummingbird, its state known
    python python/examples/bang_bang.py --estimated [--late 0]              on the boards' estimator
    python python/examples/bang_bang.py --scenario FILE --rough --margin 0.2

Each demands 100 m/s^2 along a direction of its own, changes sides up to eight times a second, and begins at rest a
metre or more inside a box. It prints how many left the box, how near or how far outside they came, and how long the
policy flew. docs/shield.md has the figures.
"""

import argparse

import numpy as np
import saturated_hybrid as sh
from judge import LATE

LOW, HIGH = np.array([-4.0, -4.0, 0.5]), np.array([4.0, 4.0, 5.0])
TICKS = 500
# 2 m/s of wind with turbulence, and rotors that give 5 % less than is commanded.
ROUGH = {
    "wind": {"steady": [1.6, 1.2, 0.0], "turbulence": {"wind_at_20_feet": 5.0, "altitude": 10.0}},
    "truth": {"thrust_scale": 0.95},
}


def fly(scenario, rows, seed, **options):
    """How far outside each vehicle came at most, m, and the share of the time that the policies flew."""
    random, vehicles = np.random.default_rng(seed), sh.VehicleRows(scenario, rows)
    again = {"patience": 0.2, "patience_greatest": 0.2, "hand_overs": 100}
    shields = sh.ShieldRows(scenario, rows, low=LOW, high=HIGH, **again, **options)
    places = random.uniform(LOW + 1.0, HIGH - 1.0, (rows, 3))
    directions = random.uniform(-1.0, 1.0, (rows, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    frequencies = random.uniform(0.3, 4.0, rows)
    vehicles.place([sh.state(place) for place in places], None, list(range(rows)))
    outside, flown = np.full(rows, -np.inf), 0.0
    for tick in range(TICKS):
        phase = np.sin(2.0 * np.pi * frequencies * tick * scenario.period)
        demands = np.column_stack([100.0 * directions * np.sign(phase)[:, None], 5.0 * phase])
        shields.hold_estimates(vehicles.jumped.tolist())
        wrenches = shields.step(vehicles.measured, demands, vehicles.accelerations)
        clipped, lost = vehicles.step(shields.for_rotors(wrenches))
        assert not clipped.any() and not lost.any()
        positions = vehicles.states[:, :3]
        outside = np.maximum(outside, np.maximum(LOW - positions, positions - HIGH).max(axis=1))
        flown += shields.by_policy.mean() / TICKS
    return outside, flown


def main(given=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenario", help="a vehicle's file; left out: the Hummingbird")
    parser.add_argument("--rough", action="store_true", help="wind with turbulence, and weak rotors")
    parser.add_argument("--estimated", action="store_true", help="on the boards' estimator: poses 20 ms late")
    parser.add_argument("--late-poses", action="store_true", help="poses 100 ms late and noisy, a tenth of them lost")
    parser.add_argument("--late", type=float, help="the shield's, s; left out: its usual one")
    parser.add_argument("--margin", type=float, default=0.0, help="the shield's, m")
    parser.add_argument("--rows", type=int, default=200)
    parser.add_argument("--seed", type=int, default=5)
    arguments = parser.parse_args(given)
    scenario = sh.Scenario.load(arguments.scenario) if arguments.scenario else sh.Scenario.built_in("hummingbird")
    if arguments.rough:
        scenario = scenario.edited(ROUGH)
    if arguments.estimated or arguments.late_poses:
        scenario = scenario.edited({"estimator": LATE if arguments.late_poses else {}})
    outside, flown = fly(scenario, arguments.rows, arguments.seed, margin=arguments.margin, late=arguments.late)
    worst = outside.max()
    where = f"{worst:.2f} m outside" if worst > 0.0 else f"{-worst:.2f} m inside"
    print(f"{(outside > 0.0).sum()} of {arguments.rows} left the box, the worst {where}; policies flew {flown:.0%}")
    return outside, flown


if __name__ == "__main__":
    main()

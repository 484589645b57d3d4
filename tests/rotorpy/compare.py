"""Flies RotorPy's Hummingbird under RotorPy's controller and under the project's law, side by side, and prints a table.

    compare.py                                     the law of vehicles/hummingbird.toml
    compare.py --law LABEL FILE [ARGUMENT...]      another scenario's law; repeatable, further arguments go to `host-sim law`
"""

import argparse
import concurrent.futures
import importlib.metadata
import json
import math
import pathlib
import sys
import time
import tomllib

import numpy as np

from controllers import SE3, Law, SE3TorqueFirst
from flight import fly
from rows import rows
from table import cell, markdown
from vehicle import GRAVITY, PARAMETERS

TOP = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = TOP / "target/release/host-sim"
SE3_LABEL, TORQUE_FIRST_LABEL = "SE3", "SE3, torque first"

# The attitude loop's damping halved and its stiffness quartered.
EASED = 0.5


def check_vehicle(file):
    """Refuses a scenario of another vehicle than RotorPy's: its law would fly a body it was not told of."""
    with open(file, "rb") as text:
        scenario = tomllib.load(text)
    vehicle, rotors = scenario["vehicle"], scenario.get("rotors", {})
    pairs = {
        "vehicle.mass": (vehicle["mass"], PARAMETERS["mass"]),
        "vehicle.inertia": (vehicle["inertia"], [PARAMETERS[name] for name in ("Ixx", "Iyy", "Izz")]),
        "vehicle.gravity": (vehicle["gravity"], GRAVITY),
        "rotors.position": (rotors.get("position"), list(PARAMETERS["rotor_pos"].values())),
        "rotors.spin": ([{"cw": 1, "ccw": -1}[spin] for spin in rotors.get("spin", [])], PARAMETERS["rotor_directions"]),
        "rotors.thrust_coefficient": (rotors.get("thrust_coefficient"), PARAMETERS["k_eta"]),
        "rotors.drag_coefficient": (rotors.get("drag_coefficient"), PARAMETERS["k_m"]),
        "rotors.speed": (rotors.get("speed"), [PARAMETERS["rotor_speed_min"], PARAMETERS["rotor_speed_max"]]),
        "rotors.lag": (rotors.get("lag"), PARAMETERS["tau_m"]),
    }
    for name, (ours, theirs) in pairs.items():
        ours, theirs = np.asarray(ours, float), np.asarray(theirs, float)
        if ours.shape != theirs.shape or not np.allclose(ours, theirs, rtol=1e-5, atol=0.0):
            sys.exit(f"error: {file}: {name}: {ours.tolist()}, but RotorPy's vehicle has {theirs.tolist()}")


def controller(label, laws, eased):
    if label == SE3_LABEL:
        return SE3(EASED if eased else 1.0)
    if label == TORQUE_FIRST_LABEL:
        return SE3TorqueFirst(EASED if eased else 1.0)
    file, arguments = laws[label]
    return Law(PROGRAM, file, arguments)


def flown(task):
    """One flight of one controller."""
    (flight, label, eased), laws, period, step = task
    pilot = controller(label, laws, eased)
    try:
        return fly(flight, pilot, period, step)
    finally:
        pilot.close()


def fly_all(chosen, laws, period, step, jobs):
    """The record of every flight, by (flight, controller's label, eased)."""
    records = {}

    def fly_each(keys):
        keys = list(dict.fromkeys(keys))
        with concurrent.futures.ProcessPoolExecutor(jobs) as pool:
            records.update(zip(keys, pool.map(flown, [(key, laws, period, step) for key in keys])))

    fly_each((row.flight, label, row.eased) for row in chosen for label in [SE3_LABEL, *laws]
             if label == SE3_LABEL or not row.eased)
    # Where RotorPy's controller clips nothing, torque first has nothing to decide: that flight is the same.
    again = []
    for row in chosen:
        plain, other = (row.flight, SE3_LABEL, row.eased), (row.flight, TORQUE_FIRST_LABEL, row.eased)
        if records[plain].clipped:
            again.append(other)
        else:
            records[other] = records[plain]
    fly_each(again)
    return records


def figures(row, record):
    found = {"lost": record.lost, "flown": len(record.error) * record.period, "ticks_clipped": record.clipped}
    return found if record.lost else found | row.measure(record)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--law", nargs="+", action="append", metavar=("LABEL", "FILE"), default=None)
    parser.add_argument("--se3-only", action="store_true", help="without the project's law")
    parser.add_argument("--rate", type=float, default=100.0, help="of the controllers, Hz")
    parser.add_argument("--step", type=float, default=0.005, help="the vehicle's longest step, s")
    parser.add_argument("--rows", default="", help="only rows whose name contains this")
    parser.add_argument("--jobs", type=int, default=1, help="flights at a time")
    parser.add_argument("--out", type=pathlib.Path, default=TOP / "target/rotorpy/measured.json")
    given = parser.parse_args()
    laws = {}
    for label, *rest in [] if given.se3_only else given.law or [["law", str(TOP / "vehicles/hummingbird.toml")]]:
        if not rest:
            parser.error(f"--law {label}: needs a scenario file")
        if label in (SE3_LABEL, TORQUE_FIRST_LABEL, *laws):
            parser.error(f"--law {label}: that label is taken")
        check_vehicle(rest[0])
        laws[label] = (rest[0], tuple(rest[1:]))
    given.law = laws
    return given


def main():
    given = arguments()
    started = time.monotonic()
    period = 1.0 / given.rate
    step = period / math.ceil(period / given.step - 1e-9)
    chosen = [row for row in rows() if given.rows in row.name]
    if not chosen:
        sys.exit(f"error: --rows {given.rows}: no row's name contains that")
    records = fly_all(chosen, given.law, period, step, given.jobs)
    labels = [SE3_LABEL, TORQUE_FIRST_LABEL, *given.law]
    lines, raw = [], []
    for row in chosen:
        measured = {label: figures(row, records[key]) for label in labels
                    if (key := (row.flight, label, row.eased)) in records}
        lines.append([row.name, row.figure, *(cell(measured.get(label), row.flight.limit) for label in labels)])
        raw.append({"row": row.name, "figure": row.figure, "limit": row.flight.limit, "measured": measured})
    versions = {name: importlib.metadata.version(name) for name in ("rotorpy", "numpy", "scipy")}
    settings = {"rate": given.rate, "step": step, "versions": versions, "laws": given.law}
    given.out.parent.mkdir(parents=True, exist_ok=True)
    given.out.write_text(json.dumps({"settings": settings, "rows": raw}, indent=1) + "\n")
    print(markdown(["flight", "figure", *labels], lines))
    print(f"\nRotorPy {versions['rotorpy']}; controllers at {given.rate:g} Hz, vehicle in steps of {1e3 * step:g} ms; "
          f"{time.monotonic() - started:.0f} s; every figure in {given.out}")


if __name__ == "__main__":
    main()

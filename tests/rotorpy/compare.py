"""Flies RotorPy's Hummingbird under RotorPy's controller and under the project's law, side by side, and prints a table.

    compare.py                                     the law of vehicles/hummingbird.toml
    compare.py --law LABEL "FILE [ARGUMENT...]"    another scenario's law; repeatable, further arguments go to `host-sim law`
"""

import argparse
import concurrent.futures
import importlib.metadata
import json
import math
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile
import time

from controllers import SE3, Law, SE3TorqueFirst, UnusableAnswer
from flight import fly
from rows import rows
from scenario_file import changed, check_vehicle
from table import cell, markdown

TOP = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = TOP / "target/release/host-sim"
HUMMINGBIRD = TOP / "vehicles/hummingbird.toml"
SE3_LABEL, TORQUE_FIRST_LABEL = "SE3", "SE3, torque first"

# The attitude loop's damping halved and its stiffness quartered.
EASED = 0.5


def controller(label, laws, eased, believed, folder):
    """A new one. `believed` changes a copy of the law's file, in this folder."""
    if label == SE3_LABEL:
        return SE3(EASED if eased else 1.0)
    if label == TORQUE_FIRST_LABEL:
        return SE3TorqueFirst(EASED if eased else 1.0)
    file, arguments = laws[label]
    copy = pathlib.Path(folder) / pathlib.Path(file).name
    copy.write_text(changed(pathlib.Path(file).read_text(), believed))
    return Law(PROGRAM, copy, arguments)


def flown(task):
    """One flight of one controller."""
    (flight, label, eased), laws, period, step = task
    with tempfile.TemporaryDirectory() as folder:
        pilot = controller(label, laws, eased, flight.believed, folder)
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


def verdict(file):
    """What `certify` says of a scenario, in a line."""
    said = subprocess.run([PROGRAM, "certify", file], capture_output=True, text=True)
    first = (said.stdout or said.stderr).partition("\n")[0]
    if said.returncode not in (0, 1):
        raise UnusableAnswer(f"{PROGRAM} certify {file}: {first}")
    return first


def clippings(records, chosen, label):
    """Flights of the rows in which this controller commanded a rotor beyond its limits, and in how many ticks."""
    keys = {(row.flight, label, row.eased) for row in chosen}
    clipped = [record.clipped for key, record in records.items() if key in keys]
    return f"{label} in {sum(ticks > 0 for ticks in clipped)} of {len(clipped)} flights, {sum(clipped)} ticks"


def figures(row, record):
    found = {"lost": record.lost, "flown": len(record.error) * record.period, "ticks_clipped": record.clipped}
    return found if record.lost else found | row.measure(record)


def positive(kind):
    """A type of argument: a number above zero."""

    def number(text):
        value = kind(text)
        if not 0 < value < math.inf:
            raise argparse.ArgumentTypeError(f"must be above zero, found {text}")
        return value

    return number


def arguments(words=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--law", nargs=2, action="append", metavar=("LABEL", "FILE"))
    parser.add_argument("--se3-only", action="store_true", help="without the project's law")
    parser.add_argument("--rate", type=positive(float), default=100.0, help="of the controllers, Hz")
    parser.add_argument("--step", type=positive(float), default=0.005, help="the vehicle's longest step, s")
    parser.add_argument("--rows", default="", help="only rows whose name contains this")
    parser.add_argument("--jobs", type=positive(int), default=os.cpu_count() or 1, help="flights at a time")
    parser.add_argument("--out", type=pathlib.Path, default=TOP / "target/rotorpy/measured.json")
    given = parser.parse_args(words)
    laws = {}
    for label, command in [] if given.se3_only else given.law or [["law", str(HUMMINGBIRD)]]:
        file, *further = shlex.split(command) or [""]
        if label in (SE3_LABEL, TORQUE_FIRST_LABEL, *laws):
            parser.error(f"--law {label}: that label is taken")
        try:
            check_vehicle(file)
        except ValueError as error:
            parser.error(f"--law {label}: {error}")
        laws[label] = (file, tuple(further))
    given.law = laws
    given.chosen = [row for row in rows() if given.rows in row.name]
    if not given.chosen:
        parser.error(f"--rows {given.rows}: no row's name contains that")
    return given


def main():
    given = arguments()
    started = time.monotonic()
    period = 1.0 / given.rate
    step = period / math.ceil(period / given.step - 1e-9)
    try:
        verdicts = {label: verdict(file) for label, (file, _) in given.law.items()}
        records = fly_all(given.chosen, given.law, period, step, given.jobs)
    except (UnusableAnswer, ValueError) as error:
        sys.exit(f"error: {error}")
    labels = [SE3_LABEL, TORQUE_FIRST_LABEL, *given.law]
    lines, raw = [], []
    for row in given.chosen:
        measured = {label: figures(row, records[key]) for label in labels
                    if (key := (row.flight, label, row.eased)) in records}
        lines.append([row.name, row.figure, *(cell(measured.get(label), row.flight.duration) for label in labels)])
        raw.append({"row": row.name, "figure": row.figure, "duration": row.flight.duration, "measured": measured})
    versions = {name: importlib.metadata.version(name) for name in ("rotorpy", "numpy", "scipy")}
    settings = {"rate": given.rate, "step": step, "versions": versions, "laws": given.law, "verdicts": verdicts}
    given.out.parent.mkdir(parents=True, exist_ok=True)
    given.out.write_text(json.dumps({"settings": settings, "rows": raw}, indent=1) + "\n")
    print(markdown(["flight", "figure", *labels], lines))
    print()
    for label, said in verdicts.items():
        print(f"{label}: certify says {said}")
    print(f"clipped: {'; '.join(clippings(records, given.chosen, label) for label in labels)}")
    print(f"RotorPy {versions['rotorpy']}; controllers at {given.rate:g} Hz, vehicle in steps of {1e3 * step:g} ms; "
          f"{time.monotonic() - started:.0f} s; every figure in {given.out}")


if __name__ == "__main__":
    main()

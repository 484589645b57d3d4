"""Spoils an emulated board on its way up and in a hover, one fault a run, and prints what became of each: how soon the
motors stood still, and what the board said.

Usage: spoiled.py BOARD IMAGE VEHICLE.toml [RUN or start, listening, torn, hover...]

Runs in a hover, and those on the ground after it was booted, are children of one process that flew there: each begins
from the same moment. The faults are in faults.py, those of the parameters' flash in torn.py, those of a start in
boots.py, those of lines that answer in listening.py.
"""

import json
import os
import pathlib
import sys
import time
import traceback
from collections.abc import Callable
from dataclasses import asdict, dataclass

from boots import BOOTS
from chip import POWER
from faults import FAULTS
from flight import Flight, HEIGHT
from listening import LISTENING
from outcome import Expected, Outcome
from torn import TORN
from vehicle import START


def _child(run: Callable[[], Outcome]) -> Outcome:
    """Runs in a copy of this process, which goes on from where it is; an error becomes an outcome."""
    sys.stdout.flush()
    reading, writing = os.pipe()
    process = os.fork()
    if process == 0:
        os.close(reading)
        begun = time.process_time()
        try:
            outcome = run()
        except BaseException:  # whatever it is, the parent reports it
            outcome = Outcome(error=traceback.format_exc(limit=-3))
        outcome.processor_s = time.process_time() - begun
        with os.fdopen(writing, "w") as pipe:
            json.dump(asdict(outcome), pipe)
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        said = pipe.read()
    os.waitpid(process, 0)
    return Outcome(**json.loads(said)) if said else Outcome(error="the run ended without a word")


@dataclass
class _Row:
    """A line of the table."""

    name: str
    outcome: Outcome
    problems: list[str]

    def __str__(self) -> str:
        """As it is printed."""
        outcome = self.outcome
        off = "fly on" if outcome.motors_off_ms is None else f"{outcome.motors_off_ms:7.1f} ms"
        words = "; ".join(dict.fromkeys(outcome.words)) or "-"
        verdict = "as expected" if not self.problems else "NOT: " + "; ".join(self.problems)
        return f"{self.name:34} {off:>11}  {outcome.processor_s:5.1f} s  {verdict}\n{'':49}{words}"


def _judge(name: str, outcome: Outcome, expected: Expected) -> _Row:
    return _Row(name, outcome, expected.problems(outcome))


def main() -> None:
    """Runs all, or those that are named."""
    name, image, file, *chosen = sys.argv[1:]
    vehicle = pathlib.Path(file)
    rows: list[_Row] = []

    def wanted(group: str, runs: dict) -> dict:
        whole = not chosen or group in chosen
        return {run: what for run, what in runs.items()
                if (whole or run in chosen) and (what.boards is None or name in what.boards)}

    def note(run: str, outcome: Outcome, expected: Expected) -> None:
        rows.append(_judge(run, outcome, expected))
        print(rows[-1], flush=True)

    print(f"== {name}: spoiled\n{'run':34} {'motors off':>11}  {'took':>7}", flush=True)
    for run, boot in {**wanted("start", BOOTS), **wanted("listening", LISTENING)}.items():
        note(run, _child(lambda boot=boot: boot.run(name, image, vehicle)), boot.expected)
    faults, torn = wanted("hover", FAULTS), wanted("torn", TORN)
    if faults or torn:
        flight = Flight(name, image, vehicle)
        flight.is_quiet = flight.station.is_quiet = True
        flight.boot(POWER)
        flight.make_ready()
        for run, tear in torn.items():
            note(run, _child(lambda tear=tear: tear.run(flight)), tear.expected)
        if faults:
            flight.arm()
            flight.take_off()
            flight.hover((START[0], START[1], HEIGHT), 0.5)
        for run, fault in faults.items():
            note(run, _child(lambda fault=fault: fault.run(flight)), fault.expected)
    failed = [row for row in rows if row.problems]
    took = sum(row.outcome.processor_s for row in rows)
    print(f"== {name}: {len(rows)} runs, {len(failed)} not as expected, {took:.0f} s of this processor", flush=True)
    sys.exit(1 if failed or not rows else 0)


if __name__ == "__main__":
    main()

"""Flies the whole firmware on emulated Cortex-M boards with a real MAVLink client, and holds it to the flight rules.

Usage: flight.py MACHINE RUN...   with RUN one of: as-printed, flight, vanishing-client, failing-pose, and failing-rotor in hover, -climbing,
-landing or -weak

Every time is the vehicle's. Figures that are printed were measured in that run.
"""

import math
import os
import sys

from printed import as_printed
from rig import NOISY, TICK, Rig
from station import ARM_DISARM, HOLDING, LAND, TAKE_OFF, mavlink

START = (1.0, 0.0, 0.0)
HOVER = (1.0, 0.0, 1.5)

# What the flight rules promise, s; flight/src/rules.rs, and the parameter GCS_WAIT.
COASTING_MAX = 1.0
LEVELLING_MAX = 1.0
SILENCE_MAX = 2.5
SILENCE_LANDS = 10.0

# With noise, m: how well a hover is held, and how far telemetry is from the truth. A touchdown at 0.5 m/s is beyond the accelerometer's
# range: for a moment, s, telemetry is further off. Both figures are those of tests/flights/touchdown.rs, which has touchdowns at every moment.
NOISY_HOVER = 0.01
NOISY_ERROR = 0.003
TOUCHDOWN_ERROR = 0.025
TOUCHDOWN_KNOWN = 0.2


def take_off(station, believed_within=1e-3):
    station.until("heartbeat and telemetry", lambda: station.mode and station.position, 60.0)
    assert station.distance(START) < believed_within, station.position
    assert not station.armed
    station.wait(1.0)
    station.arm()
    print(f"    taken off in {station.take_off(HOVER[2], 20.0):.2f} s")
    assert station.distance(HOVER) < 0.05, station.position
    station.wait(3.0)


def flight(machine):
    """Boot, arm, take off, hover, a step of 1 m by setpoints, land, disarmed: on sensors at 1 kHz with noise, and late poses."""
    with Rig(machine, sensors=NOISY) as rig:
        station = rig.station
        # Aligned on late poses of 1 mm of noise each: its filter is better than any of them, and has not converged.
        take_off(station, 5e-3)
        begin = station.now
        worst = station.worst_distance(HOVER, 5.0)
        end = station.now
        assert worst <= NOISY_HOVER, worst
        print(f"    hover held within {1e3 * worst:.1f} mm for 5 s, by telemetry")
        station.disarm_in_the_air()
        there = (HOVER[0], HOVER[1] + 1.0, HOVER[2])
        print(f"    1 m step within 0.1 m in {station.go(there, 0.1, 5.0):.2f} s")
        station.wait(3.0)
        assert station.worst_distance(there, 3.0) <= NOISY_HOVER
        landing = station.now
        print(f"    landed and disarmed in {station.land(15.0):.2f} s")
        station.wait(0.5)
        rig.land()
        rig.check_pace()
        rig.check_landed()
        # The simulator's own record: no telemetry in between, and no noise.
        truly = max(math.dist(place, HOVER) for _, place in rig.truth(begin, end))
        print(f"    truly within {1e3 * truly:.1f} mm meanwhile")
        assert truly <= NOISY_HOVER, truly
        touched = next(time for time, (_, _, height) in rig.truth(landing, math.inf) if height < 1e-3)
        at_touchdown = [report for report in station.track if abs(report[0] - touched) <= TOUCHDOWN_KNOWN]
        reported = rig.worst_error([report for report in station.track if report not in at_touchdown])
        shocked = rig.worst_error(at_touchdown)
        print(f"    telemetry within {1e3 * reported:.1f} mm of the truth, {1e3 * shocked:.1f} mm at the touchdown")
        # Telemetry that is exact to a tenth of a millimetre comes from sensors without noise.
        assert 1e-4 < reported <= NOISY_ERROR, reported
        assert shocked <= TOUCHDOWN_ERROR, shocked
        assert max(row["pz"] for row in rig.rows) < HOVER[2] + 0.05


def vanishing_client(machine):
    """A ground station that says nothing more, in the middle of a manoeuvre: the vehicle holds, obeys again, and lands in the end."""
    with Rig(machine) as rig:
        station = rig.station
        take_off(station)
        far = 40.0
        station.go((HOVER[0], HOVER[1] + far, HOVER[2]), far - 1.0, 10.0)
        station.alive = False
        # From here on it only listens.
        station.until("holding", lambda: station.received("Ground station lost"), SILENCE_MAX + 1.0)
        after = station.received("Ground station lost") - station.last_heartbeat
        print(f"    holding position {after:.2f} s after the last heartbeat")
        # Both times are those of the telemetry that came last: up to two intervals and this machine's delays old.
        assert abs(after - SILENCE_MAX) <= 0.2, after
        station.wait(5.0)
        assert station.armed and station.mode == HOLDING
        held = station.position
        worst = station.worst_distance(held, 1.5)
        print(f"    held within {1e3 * worst:.1f} mm for 1.5 s, {held[1]:.2f} m along a way of {far} m")
        assert worst <= 0.05 and 1.0 < held[1] < far - 1.0
        # With heartbeats again it goes on holding until setpoints are requested.
        station.target, station.alive = (held[0], held[1] - 1.0, held[2]), True
        station.wait(2.0)
        assert station.mode == HOLDING and station.distance(held) <= 0.05, station.position
        print(f"    requested again, 1 m within 0.1 m in {station.go(station.target, 0.1, 5.0):.2f} s")
        station.wait(2.0)
        station.alive, silent = False, station.now
        station.until("landing", lambda: station.received("Ground station still lost"), SILENCE_LANDS + 1.0)
        after = station.received("Ground station still lost", silent) - station.last_heartbeat
        print(f"    landing {after:.2f} s after the last heartbeat")
        assert abs(after - SILENCE_LANDS) <= 0.2, after
        station.landed(15.0)
        rig.land()
        rig.check_pace()
        rig.check_landed()


def failing_pose(machine):
    """A pose source that stops at a hover: on by IMU for a second, level for another, then down to the ground."""
    stops = 18.0
    with Rig(machine, ["--pose-until", stops]) as rig:
        station = rig.station
        take_off(station)
        station.until("given up", lambda: station.received("Pose lost"), stops)
        took = station.landed(40.0)
        print(f"    landed {took:.2f} s after the pose was given up, by telemetry")
        station.wait(0.5)
        rig.land()
        rig.check_pace()
    # By the simulator's record. The last pose answers the last command before `stops` and is true a tick later.
    last_pose = max(row["t"] for row in rig.rows if row["t"] < stops - TICK / 2) + TICK
    given_up = last_pose + COASTING_MAX
    levelling = [row for row in rig.rows if given_up <= row["t"] < given_up + LEVELLING_MAX]
    lean = max(2.0 * (row["qx"] ** 2 + row["qy"] ** 2) ** 0.5 for row in levelling)
    drop = levelling[0]["pz"] - levelling[-1]["pz"]
    print(f"    levelling: leaned {lean:.4f} rad at most, sank {1e3 * drop:.0f} mm")
    assert lean < 0.02 and abs(drop) < 0.05
    assert all(row["armed"] == 1 for row in levelling)
    down = rig.touchdowns[0][0] - given_up - LEVELLING_MAX
    last = rig.rows[-1]
    away = math.dist((last["px"], last["py"]), HOVER[:2])
    print(f"    on the ground after {down:.2f} s of going down, {1e3 * away:.0f} mm away")
    assert down > 1.0, rig.touchdowns
    rig.check_landed()


def failing_rotor(machine, fails=18.0, left=0.0, lands=None):
    """A rotor that fails at `fails` s: the vehicle says which, comes down by itself, turning, and does not arm again."""
    with Rig(machine, sensors=f"{NOISY}\n[failure]\nrotor = 1\ntime = {fails}\nthrust_left = {left}\n") as rig:
        station = rig.station
        station.until("heartbeat and telemetry", lambda: station.mode and station.position, 60.0)
        station.wait(1.0)
        station.arm()
        station.order(TAKE_OFF, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, HOVER[2])
        if lands is not None:
            station.until("time to land", lambda: station.now >= lands, 30.0)
            station.order(LAND)
        station.until("the rotor found", lambda: station.received("Rotor 1 lost"), 40.0)
        print(f"    landed {station.landed(60.0):.2f} s after that, by telemetry")
        station.wait(2.0)
        assert station.command(ARM_DISARM, 1.0) == mavlink.MAV_RESULT_DENIED
        station.until("why it does not arm", lambda: station.received("Refused: a rotor failed"), 2.0)
        rig.land()
        rig.check_pace()
    away = max(math.dist((row["px"], row["py"]), HOVER[:2]) for row in rig.rows)
    touch = max(speed for _, speed, _ in rig.touchdowns)
    print(f"    {away:.2f} m away at most, touched the ground with {touch:.2f} m/s")
    assert away < 2.0 and touch < 1.0, rig.touchdowns


MACHINES = ["mps2-an386", "mps2-an500"]
RUNS = {
    "as-printed": as_printed,
    "flight": flight,
    "vanishing-client": vanishing_client,
    "failing-pose": failing_pose,
    "failing-rotor": failing_rotor,
    "failing-rotor-climbing": lambda machine: failing_rotor(machine, fails=8.0),
    "failing-rotor-landing": lambda machine: failing_rotor(machine, fails=17.0, lands=15.0),
    "failing-rotor-weak": lambda machine: failing_rotor(machine, left=0.3),
}


def main():
    machine, *names = sys.argv[1:]
    # The board, the simulator and the client take turns, a byte at a time: on one processor that costs no waking of another.
    processors = sorted(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {processors[MACHINES.index(machine) % len(processors)]})
    for name in names:
        print(f"== {machine}: {name}", flush=True)
        RUNS[name](machine)
    print(f"== {machine}: all as the flight rules say")


if __name__ == "__main__":
    main()

"""Flies the whole firmware on emulated Cortex-M boards with a real MAVLink client, and holds it to the flight rules.

Usage: flight.py MACHINE RUN...   with RUN one of: as-printed, flight, vanishing-client, failing-pose

Every time is the vehicle's. Figures that are printed were measured in that run.
"""

import math
import os
import sys

from printed import as_printed
from rig import NOISY, TICK, Rig

START = (1.0, 0.0, 0.0)
HOVER = (1.0, 0.0, 1.5)

# What the flight rules promise, s; controller-core/src/flight/rules.rs.
COASTING_MAX = 1.0
LEVELLING_MAX = 1.0
SILENCE_MAX = 2.5

FLYING, HOLDING = 3, 4

# With noise, m: how well a hover is held, and how far telemetry is from the truth. Measured: 3.2 mm and 1.3 mm on both machines.
NOISY_HOVER = 0.01
NOISY_ERROR = 0.005


def take_off(station, believed_within=1e-3):
    station.until("heartbeat and telemetry", lambda: station.mode and station.position, 60.0)
    assert station.distance(START) < believed_within, station.position
    assert not station.armed
    station.wait(1.0)
    station.command_arm(True)
    print(f"    hover reached in {station.go(HOVER, 0.05, 20.0):.2f} s")
    station.wait(3.0)


def land(station):
    station.go((station.target[0], station.target[1], 0.0), 0.05, 20.0)
    station.wait(2.0)
    station.target = None
    station.command_arm(False)
    station.wait(0.5)


def flight(machine):
    """Boot, arm, take position, hover, a step of 1 m, land, disarm: on sensors at 1 kHz with noise, and late poses."""
    with Rig(machine, sensors=NOISY) as rig:
        station = rig.station
        # Aligned on late poses of 1 mm of noise each: its filter is better than any of them, and has not converged.
        take_off(station, 5e-3)
        begin = station.now
        worst = station.worst_distance(HOVER, 5.0)
        end = station.now
        assert worst <= NOISY_HOVER, worst
        print(f"    hover held within {1e3 * worst:.1f} mm for 5 s, by telemetry")
        there = (HOVER[0], HOVER[1] + 1.0, HOVER[2])
        print(f"    1 m step within 0.1 m in {station.go(there, 0.1, 5.0):.2f} s")
        station.wait(3.0)
        assert station.worst_distance(there, 3.0) <= NOISY_HOVER
        land(station)
        rig.land()
        rig.check_pace()
        assert rig.rows[-1]["armed"] == 0 and rig.rows[-1]["thrust"] < 0.05
        assert abs(rig.rows[-1]["pz"]) < 0.01
        # The simulator's own record: no telemetry in between, and no noise.
        truly = max(math.dist(place, HOVER) for _, place in rig.truth(begin, end))
        print(f"    truly within {1e3 * truly:.1f} mm meanwhile")
        assert truly <= NOISY_HOVER, truly
        told = rig.worst_error(station.track)
        print(f"    telemetry within {1e3 * told:.1f} mm of the truth, from boot to the end")
        # Telemetry that tells the truth to a tenth of a millimetre comes from sensors without noise.
        assert 1e-4 < told <= NOISY_ERROR, told
        assert max(row["pz"] for row in rig.rows) < HOVER[2] + 0.05


def vanishing_client(machine):
    """A ground station that says nothing more, in the middle of a manoeuvre: the vehicle holds, and obeys again."""
    with Rig(machine) as rig:
        station = rig.station
        take_off(station)
        far = 40.0
        station.go((HOVER[0], HOVER[1] + far, HOVER[2]), far - 1.0, 10.0)
        station.alive = False
        # From here on it only listens.
        station.until("holding", lambda: station.heard("Ground station lost"), SILENCE_MAX + 1.0)
        after = station.heard("Ground station lost") - station.last_heartbeat
        print(f"    holding position {after:.2f} s after the last heartbeat")
        # Both times are those of the telemetry that came last: up to two intervals and this machine's delays old.
        assert abs(after - SILENCE_MAX) <= 0.2, after
        station.wait(6.0)
        assert station.armed and station.mode == HOLDING
        held = station.position
        worst = station.worst_distance(held, 5.0)
        print(f"    held within {1e3 * worst:.1f} mm for 5 s, {held[1]:.2f} m along a way of {far} m")
        assert worst <= 0.05 and 1.0 < held[1] < far - 1.0
        station.target, station.alive = None, True
        took = station.until("the client is heard again", lambda: station.heard("Ground station regained"), 2.0)
        print(f"    heard again after {took:.2f} s, by telemetry")
        station.target = (held[0], held[1], 0.0)
        land(station)
        rig.land()
        rig.check_pace()


def failing_pose(machine):
    """A pose source that stops at a hover: on by IMU for a second, level at hover thrust for another, then stop."""
    stops = 14.0
    with Rig(machine, ["--pose-until", stops]) as rig:
        station = rig.station
        take_off(station)
        station.until("stop", lambda: station.heard("Stopped: no believable pose"), stops)
        station.until("disarmed", lambda: not station.armed, 2.0)
        lost, stopped = station.heard("Pose lost"), station.heard("Stopped: no believable pose")
        print(f"    stopped {stopped - lost:.2f} s after the pose was given up, by telemetry")
        station.wait_for_heartbeats(2)
        rig.land()
        rig.check_pace()
    # By the simulator's record. The last pose answers the last command before `stops` and is true a tick later.
    last_pose = max(row["t"] for row in rig.rows if row["t"] < stops - TICK / 2) + TICK
    off = min(row["t"] for row in rig.rows if row["t"] > stops and row["armed"] == 0)
    print(f"    motors off {off - last_pose:.3f} s after the last pose")
    assert abs(off - last_pose - (COASTING_MAX + LEVELLING_MAX)) <= 2 * TICK + 1e-9, off - last_pose
    levelling = [row for row in rig.rows if last_pose + COASTING_MAX <= row["t"] < off]
    lean = max(2.0 * (row["qx"] ** 2 + row["qy"] ** 2) ** 0.5 for row in levelling)
    drop = levelling[0]["pz"] - levelling[-1]["pz"]
    print(f"    levelling: leaned {lean:.4f} rad at most, sank {1e3 * drop:.0f} mm")
    assert lean < 0.02 and abs(drop) < 0.05
    assert all(row["armed"] == 0 for row in rig.rows if row["t"] >= off)
    assert rig.rows[-1]["pz"] < 0.01


MACHINES = ["mps2-an386", "mps2-an500"]
RUNS = {"as-printed": as_printed, "flight": flight, "vanishing-client": vanishing_client, "failing-pose": failing_pose}


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

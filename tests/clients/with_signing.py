"""Signed frames, by pymavlink's own signing: who has the key flies; forgers, strangers and replays do nothing.

Needs SIGNED=1: `.ci/clients signed signing`.
"""

import math
import os
import socket
import sys
import tempfile
import time

os.environ["MAVLINK20"] = "1"
from pymavlink import mavutil  # noqa: E402
from pymavlink.dialects.v20 import common as m  # noqa: E402

from vehicle import KEY, Desk  # noqa: E402

# No faster: a busy machine's Python falls behind what a vehicle sends.
SPEED = 2.0
SAID_WITHIN = 10.0  # s


class Station:
    """A ground station, which keeps what it sent."""

    def __init__(self, flown, key=KEY, system=255):
        self.flown = flown
        self.line = mavutil.mavlink_connection(
            f"udpout:127.0.0.1:{flown.local}", source_system=system, dialect="common"
        )
        if key is not None:
            self.line.setup_signing(key, sign_outgoing=True)
        self.sent = []
        self.armed = False
        self.beaten = 0.0
        write = self.line.write
        self.line.write = lambda frame: (self.sent.append(bytes(frame)), write(frame))

    def step(self):
        if time.monotonic() - self.beaten > 0.1:
            self.beaten = time.monotonic()
            self.line.mav.heartbeat_send(m.MAV_TYPE_GCS, m.MAV_AUTOPILOT_INVALID, 0, 0, 0)
        message = self.line.recv_match(blocking=True, timeout=0.05)
        if message is not None and message.get_type() == "HEARTBEAT" and message.get_srcSystem() == 1:
            self.armed = bool(message.base_mode & m.MAV_MODE_FLAG_SAFETY_ARMED)
        return message

    def until(self, what, patience, reason):
        end = time.monotonic() + patience
        while not what(self.step()):
            assert time.monotonic() < end, f"not within {patience} s: {reason}"

    def rest(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.step()

    def wait_for(self, text, patience):
        """Goes on, heartbeats and all, until the vehicle has said it."""
        self.until(lambda _: self.flown.said(text), patience, text)

    def wait_for_more(self, words, before):
        """Goes on until the vehicle has said the words more often than before. A busy machine takes its time."""
        self.until(lambda _: count(self.flown, words) > before, SAID_WITHIN, words)

    def ask(self, number, *parameters):
        self.line.mav.command_long_send(1, 1, number, 0, *parameters, *[0.0] * (7 - len(parameters)))

    def order(self, number, *parameters, obeyed):
        """Asks every second, as ground stations do, until obeyed(): whoever does not read for a while loses answers."""
        asked = -math.inf

        def done(_):
            nonlocal asked
            if time.monotonic() - asked > 1.0:
                asked = time.monotonic()
                self.ask(number, *parameters)
            return obeyed()

        self.until(done, 30, f"{number} is obeyed")

    def order_said(self, number, words, *parameters):
        """Asks until the vehicle says the words once more."""
        before = count(self.flown, words)
        self.order(number, *parameters, obeyed=lambda: count(self.flown, words) > before)


def count(flown, words):
    """How many lines of the vehicle's have these words."""
    return sum(words in line for line in list(flown.lines))


def refused(flown, station, words):
    """A station's request is refused, with a text."""
    before = count(flown, words)
    station.ask(m.MAV_CMD_COMPONENT_ARM_DISARM, 1)
    station.wait_for_more(words, before)
    # Whether it has armed all the same shows a heartbeat later.
    station.rest(1.0)
    assert not station.armed


def only_signed(flown, station):
    """Every frame of the vehicle is signed with the key."""
    state = station.line.mav.signing
    station.rest(2.0)
    assert state.goodsig_count > 100, state.goodsig_count
    assert (state.badsig_count, state.unsigned_count, state.reject_count) == (0, 0, 0), vars(state)


def flight(flown, station):
    """Who has the key arms, takes off, and lands."""
    station.wait_for("ready", 20)
    station.order(m.MAV_CMD_COMPONENT_ARM_DISARM, 1, obeyed=lambda: station.armed)
    station.order_said(m.MAV_CMD_NAV_TAKEOFF, "Taking off")
    station.wait_for("Take-off over", 20)
    # The order of a stranger with force, in the air: the same bytes with the key would stop the motors.
    for key in (None, bytes(32 * [7])):
        Station(flown, key).ask(m.MAV_CMD_COMPONENT_ARM_DISARM, 0, 21196)
    station.rest(1.0)
    assert station.armed
    station.order_said(m.MAV_CMD_NAV_LAND, "Landing by command")
    station.wait_for("Landed: disarmed", 20)
    station.until(lambda _: not station.armed, SAID_WITHIN, "disarmed")


def strangers(flown, station):
    """No signature, another key, a key over the air: refused in words."""
    refused(flown, Station(flown, None), "Refused: not signed")
    refused(flown, Station(flown, bytes(32 * [7])), "Refused: signed with another key")
    station.line.mav.setup_signing_send(1, 1, list(bytes(32 * [7])), 0)
    station.wait_for("Signing: a key is taken over USB only", SAID_WITHIN)


def replays(flown, station):
    """Whatever was recorded on the line does nothing when it is sent again."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as attacker:
        before = count(flown, "was used before")
        for frame in station.sent:
            attacker.sendto(frame, ("127.0.0.1", flown.local))
        station.wait_for_more("was used before", before)
        station.rest(1.0)
    assert not station.armed


def main():
    with tempfile.TemporaryDirectory() as directory:
        parameters = ["--parameters", os.path.join(directory, "parameters")]
        with Desk(SPEED, *parameters) as flown:
            station = Station(flown)
            station.until(lambda message: message is not None, 10, "the vehicle sends")
            for part in (only_signed, strangers, flight, replays):
                part(flown, station)
                print(f"  signing {part.__name__}: passed", flush=True)
            recorded = station.sent
        # Another day: the key is in the parameters' file, and no time stamp that was used before counts.
        with Desk(SPEED, *parameters) as flown:
            station = Station(flown)
            station.until(lambda message: message is not None, 10, "the vehicle sends")
            station.wait_for("ready", 20)
            station.sent = recorded
            replays(flown, station)
            station.order(m.MAV_CMD_COMPONENT_ARM_DISARM, 1, obeyed=lambda: station.armed)
            station.order(m.MAV_CMD_COMPONENT_ARM_DISARM, 0, obeyed=lambda: not station.armed)
            print("  signing after a restart: replays refused, the key's holder obeyed", flush=True)


if __name__ == "__main__":
    sys.exit(main())

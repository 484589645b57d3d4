"""A policy that is built into the firmware, let fly by a ground station: pymavlink requests PX4's mode AUTO, EXTERNAL1,
sees it fly and the law take over at the box's ceiling, and ends it by the mode for holding; MAVSDK ends it by a place
to go to.

Built without a policy, the firmware refuses the mode, and this test fails: .ci/clients builds it with one.
"""

import asyncio
import concurrent.futures
import math
import sys

from mavsdk.asyncio import ComponentType, Configuration, Mavsdk
from mavsdk.asyncio.plugins.action import ActionAsync
from mavsdk.asyncio.plugins.telemetry import TelemetryAsync
from pymavlink.dialects.v20 import common as m
from vehicle import SIGNED, accept_unsigned, vehicle
from with_pymavlink import ACCEPTED, DENIED, METRES, POSITION, Client

SPEED = 4.0

# PX4's numbers: main mode and sub-mode.
HOLD, LAND, POLICY = (4, 3), (4, 6), (4, 11)

# The fence's height above home, m, and how far below it the policy's box ends.
FENCE, BELOW_FENCE = 6.0, 0.4


def set_mode(client, mode):
    """The answer to a request for a mode."""
    return client.command(m.MAV_CMD_DO_SET_MODE, m.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, *mode)


def in_mode(client, mode, patience=3.0):
    client.until(lambda _: client.mode == mode, patience, f"in mode {mode}")


def goal(client, home, north, east, up):
    """From now on the policy's goal."""
    place = (home[0] + north, home[1] + east, home[2] - up)
    client.setpoint = (m.MAV_FRAME_LOCAL_NED, POSITION, (*place, 0, 0, 0))
    return place


def take_off(client):
    """Into the air, with a fence of its own; where it stood."""
    client.line.mav.param_set_send(1, 1, b"FENCE_HEIGHT", FENCE, m.MAV_PARAM_TYPE_REAL32)
    assert client.reply("PARAM_VALUE", param_id="FENCE_HEIGHT").param_value == FENCE
    client.wait_ready(10.0)
    home = client.position
    assert client.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1) == ACCEPTED
    assert set_mode(client, POLICY) == DENIED, "on the ground"
    assert client.command(m.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, math.nan, 0, 0, 2.0) == ACCEPTED
    client.until(lambda _: client.position[2] < home[2] - 1.9, 15.0, "2 m up")
    in_mode(client, HOLD, 10.0)
    return home


def policy_flies(client, home):
    """It flies to the setpoints that are its goals."""
    client.texts = []
    assert set_mode(client, POLICY) == ACCEPTED
    in_mode(client, POLICY)
    assert "Policy flies" in client.texts, client.texts
    place = goal(client, home, 1.5, -1.0, 2.5)
    client.until(lambda _: math.dist(client.position, place) < 0.15, 15.0, f"there: {place}")
    assert client.mode == POLICY and not any(text.startswith("Law flies") for text in client.texts), client.texts


def law_takes_over(client, home):
    """A goal above the box's ceiling: the law takes over below it and gives the vehicle back."""
    # Inside the fence, so that no setpoint is refused.
    goal(client, home, 1.5, -1.0, FENCE - 0.1)
    highest = math.inf

    def taken(_):
        nonlocal highest
        highest = min(highest, client.position[2])
        return "Law flies: too near the walls to stop" in client.texts

    client.texts = []
    client.until(taken, 15.0, f"a hand-over; it said {client.texts}")
    place = goal(client, home, 1.5, -1.0, 2.0)
    client.texts = []
    client.until(lambda one: taken(one) or "Policy flies" in client.texts, 15.0, "given back")
    assert client.mode == POLICY
    client.until(lambda _: math.dist(client.position, place) < 0.15, 15.0, f"there: {place}")
    ceiling = FENCE - BELOW_FENCE
    reached = home[2] - highest
    assert ceiling - 1.5 < reached < ceiling, (reached, ceiling)
    print(f"    highest {reached:.2f} m, ceiling of the box {ceiling:.2f} m")


def held(client):
    """The mode for holding ends it, and it stays ended."""
    client.setpoint = None
    assert set_mode(client, HOLD) == ACCEPTED
    in_mode(client, HOLD)
    client.rest(2.0)
    place = client.position
    client.texts = []
    client.rest(2.0)
    assert client.mode == HOLD and math.dist(client.position, place) < 0.1 and "Policy flies" not in client.texts


async def another_client(flown, target):
    """MAVSDK beside the ground station: sees the mode, goes to a place, and sees that another mode flies there."""
    configuration = Configuration.create_with_component_type(ComponentType.GROUND_STATION)
    async with Mavsdk(configuration) as mavsdk:
        await mavsdk.add_any_connection(f"udpin://127.0.0.1:{flown.offboard}")
        system = await mavsdk.first_autopilot(timeout_s=10.0)
        assert system is not None, "no autopilot found"
        action, telemetry = ActionAsync(system), TelemetryAsync(system)
        here = await telemetry.position()
        while not here.absolute_altitude_m > 0.0:
            await asyncio.sleep(0.1)
            here = await telemetry.position()
        north, east, up = target
        latitude = here.latitude_deg + north * 1e-7 / METRES
        longitude = here.longitude_deg + east * 1e-7 / METRES
        await action.goto_location(latitude, longitude, here.absolute_altitude_m + up, 0.0)


def ended_by_a_place_to_go_to(client, flown):
    """MAVSDK's goto takes the vehicle from the policy."""
    assert set_mode(client, POLICY) == ACCEPTED
    in_mode(client, POLICY)
    client.rest(1.0)
    before = client.position
    # The ground station is heard meanwhile, or the vehicle would hold because that is lost.
    with concurrent.futures.ThreadPoolExecutor(1) as threads:
        gone = threads.submit(asyncio.run, asyncio.wait_for(another_client(flown, (1.0, 1.0, 0.5)), 60))
        client.until(lambda _: gone.done(), SPEED * 60.0, "MAVSDK's goto")
        gone.result()
    place = (before[0] + 1.0, before[1] + 1.0, before[2] - 0.5)
    in_mode(client, HOLD)
    client.until(lambda _: math.dist(client.position, place) < 0.3, 25.0, f"there: {place}")
    assert client.mode == HOLD and not any("lost" in text for text in client.texts), client.texts


def land(client):
    assert client.command(m.MAV_CMD_NAV_LAND) == ACCEPTED
    in_mode(client, LAND)
    client.until(lambda _: not client.armed, 25.0, "landed and disarmed")


def main():
    with vehicle(speed=SPEED) as flown:
        # MAVSDK does not sign.
        if SIGNED:
            accept_unsigned(flown)
        client = Client(flown.ground)
        client.line.wait_heartbeat(timeout=10)
        while client.position is None:
            client.step()
        home = take_off(client)
        policy_flies(client, home)
        law_takes_over(client, home)
        held(client)
        ended_by_a_place_to_go_to(client, flown)
        land(client)
        print("  policy: flew, was taken over from, was ended by a mode and by a place; landed", flush=True)


if __name__ == "__main__":
    sys.exit(main())

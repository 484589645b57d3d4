"""MAVSDK: connect, healthy and armable, parameters, arm, take off, a square offboard, a place on the globe, hold, land; a mission."""

import asyncio
import math
import sys
import time

from mavsdk.asyncio import ComponentType, Configuration, Mavsdk
from mavsdk.asyncio.plugins.action import ActionAsync
from mavsdk.asyncio.plugins.mission import MissionAsync
from mavsdk.asyncio.plugins.offboard import OffboardAsync
from mavsdk.asyncio.plugins.param import ParamAsync
from mavsdk.asyncio.plugins.telemetry import TelemetryAsync
from mavsdk.plugins.mission import MissionItem, MissionPlan
from mavsdk.plugins.offboard import PositionNedYaw
from mavsdk.plugins.telemetry import FlightMode

from vehicle import EMULATED, SIGNED, STRETCH, accept_unsigned, vehicle

# MAVSDK's own time-outs are seconds of this desk's: faster vehicles only shorten the flight.
SPEED = 2.0
METRES = 111_194.93  # of a degree


class Client:
    def __init__(self, system):
        self.action, self.offboard = ActionAsync(system), OffboardAsync(system)
        self.param, self.telemetry = ParamAsync(system), TelemetryAsync(system)
        self.mission = MissionAsync(system)

    async def until(self, what, patience, reason):
        end = time.monotonic() + STRETCH * patience
        while not await what():
            assert time.monotonic() < end, f"not within {STRETCH * patience} s: {reason}; at {await self.place()}"
            await asyncio.sleep(0.05)

    async def place(self):
        now = (await self.telemetry.position_velocity_ned()).position
        return now.north_m, now.east_m, now.down_m

    async def near(self, target, within=0.2):
        return math.dist(await self.place(), target) < within

    async def rests(self):
        now = (await self.telemetry.position_velocity_ned()).velocity
        return math.hypot(now.north_m_s, now.east_m_s, now.down_m_s) < 0.03

    async def fly_to(self, target, yaw):
        await self.offboard.set_position_ned(PositionNedYaw(*target, yaw))
        await self.until(lambda: self.near(target), 20, f"there: {target}")


async def fly(flown):
    configuration = Configuration.create_with_component_type(ComponentType.GROUND_STATION)
    async with Mavsdk(configuration) as mavsdk:
        await mavsdk.add_any_connection(f"udpin://127.0.0.1:{flown.offboard}")
        system = await mavsdk.first_autopilot(timeout_s=10.0)
        assert system is not None, "no autopilot found"
        client = Client(system)
        await client.until(client.telemetry.health_all_ok, 20, "health_all_ok")
        await client.until(lambda: armable(client), 20, "is_armable")
        print("  mavsdk: healthy and armable", flush=True)

        await client.param.set_param_float("TKO_ALT", 2.5)
        assert await client.param.get_param_float("TKO_ALT") == 2.5
        everything = await client.param.get_all_params()
        assert any(one.name == "FENCE_HEIGHT" for one in everything.float_params)
        print(f"  mavsdk: {len(everything.float_params)} parameters, one set", flush=True)

        home = await client.place()
        await client.action.arm()
        await client.until(client.telemetry.armed, 3, "armed")
        await client.action.takeoff()
        await client.until(client.telemetry.in_air, 10, "in the air")
        await client.until(lambda: client.near((home[0], home[1], home[2] - 1.5)), 20, "1.5 m up")
        print("  mavsdk: took off", flush=True)

        north, east, up = home[0], home[1], home[2] - 2.0
        await client.offboard.set_position_ned(PositionNedYaw(north, east, up, 90.0))
        await client.offboard.start()
        assert await client.offboard.is_active()
        for x, y in [(1, 0)] if EMULATED else [(2, 0), (2, 2), (0, 2), (0, 0)]:
            await client.fly_to((north + x, east + y, up), 90.0)
        assert (await client.telemetry.flight_mode()) == FlightMode.OFFBOARD
        await client.offboard.stop()
        await client.until(lambda: in_mode(client, FlightMode.HOLD), 5, "hold after offboard")
        print(f"  mavsdk: flew {'a step' if EMULATED else 'a square'} offboard", flush=True)

        here = await client.telemetry.position()
        latitude, longitude = here.latitude_deg + 3.0 / METRES, here.longitude_deg - 2.0 / METRES
        was = await client.place()
        await client.action.goto_location(latitude, longitude, here.absolute_altitude_m + 1.0, 0.0)
        target = (was[0] + 3.0, was[1] - 2.0, was[2] - 1.0)
        await client.until(lambda: client.near(target, 0.3), 25, f"there by globe: {target}")
        print("  mavsdk: went to a place on the globe", flush=True)

        await client.action.hold()
        # How long that takes of this desk's time depends on how fast the vehicle's time goes.
        await client.until(client.rests, 25, "at rest")
        held = await client.place()
        await asyncio.sleep(2.0)
        assert await client.near(held, 0.1), (held, await client.place())
        await client.action.land()
        await client.until(lambda: disarmed(client), 30, "landed and disarmed")
        await client.until(lambda: landed(client), 2, "said to be on the ground")
        assert abs((await client.place())[2] - home[2]) < 0.1
        print("  mavsdk: held, landed, disarmed", flush=True)
        if not EMULATED:
            await fly_mission(client)


def waypoint(latitude, longitude, height):
    """A waypoint that is passed without stopping; what has no number is left to the vehicle."""
    nan, actions = math.nan, (MissionItem.CameraAction.NONE, MissionItem.VehicleAction.NONE)
    return MissionItem(latitude, longitude, height, nan, True, nan, nan, actions[0], nan, nan, 0.3, nan, nan, actions[1])


async def fly_mission(client):
    """A square by MAVSDK's mission plugin, from the ground to the ground."""
    home = await client.place()
    here = await client.telemetry.position()
    corners = [(2, 0), (2, 2), (0, 2), (0, 0)]
    items = [waypoint(here.latitude_deg + x / METRES, here.longitude_deg + y / METRES, 2.0) for x, y in corners]
    await client.mission.set_return_to_launch_after_mission(True)
    await client.mission.upload_mission(MissionPlan(items))
    back = (await client.mission.download_mission()).mission_items
    assert len(back) == len(items), back
    for sent, one in zip(items, back):
        assert abs(sent.latitude_deg - one.latitude_deg) < 2e-7, (sent, one)
        assert abs(sent.longitude_deg - one.longitude_deg) < 2e-7, (sent, one)
        assert abs(sent.relative_altitude_m - one.relative_altitude_m) < 1e-3, (sent, one)
    print(f"  mavsdk: sent a mission of {len(items)} items and read it back", flush=True)
    await client.until(lambda: armable(client), 20, "is_armable")
    await client.action.arm()
    await client.mission.start_mission()
    await client.until(lambda: in_mode(client, FlightMode.MISSION), 5, "in its mission mode")
    left = [(home[0] + x, home[1] + y, home[2] - 2.0) for x, y in corners]

    async def passed():
        if left and await client.near(left[0], 0.6):
            left.pop(0)
        return not left

    await client.until(passed, 40, "past every corner")
    await client.until(lambda: client.mission.is_mission_finished(), 20, "said to be finished")
    await client.until(lambda: disarmed(client), 30, "landed and disarmed")
    assert await client.near(home, 0.15), (home, await client.place())
    await client.mission.clear_mission()
    print("  mavsdk: flew the mission, landed at home, disarmed", flush=True)


async def armable(client):
    return (await client.telemetry.health()).is_armable


async def landed(client):
    return not await client.telemetry.in_air()


async def in_mode(client, mode):
    return (await client.telemetry.flight_mode()) == mode


async def disarmed(client):
    return not await client.telemetry.armed()


def main():
    with vehicle(speed=SPEED) as flown:
        # MAVSDK does not sign.
        if SIGNED:
            accept_unsigned(flown)
        asyncio.run(asyncio.wait_for(fly(flown), 300 if EMULATED else 150))


if __name__ == "__main__":
    sys.exit(main())

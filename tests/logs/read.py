"""Reads the logs that .ci/logs has made: `read.py FOLDER`."""

import json
import pathlib
import subprocess
import sys

from mcap.reader import make_reader
from pyulog import ULog

# Topics that Flight Review plots and a card has.
PLOTTED = {
    "vehicle_attitude": ["q[0]", "q[1]", "q[2]", "q[3]"],
    "vehicle_angular_velocity": ["xyz[0]", "xyz[1]", "xyz[2]"],
    "vehicle_local_position": ["x", "y", "z", "vx", "vy", "vz"],
    "vehicle_local_position_setpoint": ["x", "y", "z", "vx", "vy", "vz"],
    "trajectory_setpoint": ["position[0]", "velocity[0]"],
    "actuator_motors": ["control[0]", "control[3]"],
    "battery_status": ["voltage_v"],
    "vehicle_status": ["nav_state", "arming_state"],
    "vehicle_land_detected": ["landed"],
}


def told(tool, file):
    """What a command of pyulog prints."""
    command = pathlib.Path(sys.executable).with_name(tool)
    return subprocess.run([command, file], check=True, capture_output=True, text=True).stdout


def read(file):
    log = ULog(str(file))
    assert not log.file_corruption, file
    return log


def card(file):
    """A card's file: who flew, with what, what was said; and every tick."""
    log = read(file)
    assert sorted(data.name for data in log.data_list) == ["sensor_gyro_fifo", "tick"]
    ticks = log.get_dataset("tick").data
    assert len(ticks["timestamp"]) == 399, len(ticks["timestamp"])
    gyro = log.get_dataset("sensor_gyro_fifo").data
    assert (gyro["samples"] == 32).all() and (gyro["dt"] == 1000.0).all()
    # 1 rad/s about x and y, a quarter of a turn apart.
    for n in range(32):
        x, y = (gyro[f"{axis}[{n}]"] * gyro["scale"] for axis in "xy")
        assert (abs(x**2 + y**2 - 1.0) < 1e-2).all(), n
    information = told("ulog_info", file)
    for words in ["sys_name: saturated hybrid feedback", "vehicle: mine", "ver_sw: 0.2.0", "frames: world z up"]:
        assert words in information, information
    parameters = dict(line.split(",") for line in told("ulog_params", file).splitlines())
    assert float(parameters["LAND_SPEED"]) == float(log.initial_parameters["LAND_SPEED"]) > 0.0
    assert {"SYS_ID", "GAIN_ATT_P", "MASS", "k_p_across"} <= parameters.keys(), sorted(parameters)
    assert not log.changed_parameters
    assert "said at 2000000" in told("ulog_messages", file)
    return log


def px4(file, original):
    """The same flight in PX4's topics: what Flight Review plots, with nothing of the rest lost."""
    log = read(file)
    ticks = original.get_dataset("tick").data["timestamp"]
    for topic, fields in PLOTTED.items():
        data = log.get_dataset(topic).data
        assert (data["timestamp"] == ticks).all(), topic
        assert set(fields) <= data.keys(), (topic, sorted(data))
    voltage = log.get_dataset("battery_status").data["voltage_v"]
    assert (abs(voltage - 11.1) < 1e-5).all(), voltage
    assert log.initial_parameters.keys() == original.initial_parameters.keys()
    texts = [[message.message for message in one.logged_messages] for one in (log, original)]
    assert texts[0] == texts[1] and texts[0], texts


def mcap(file):
    """A recording of a second: every topic, JSON as its schema has it, in order."""
    with open(file, "rb") as stream:
        reader = make_reader(stream)
        counts, last = {}, 0
        for schema, channel, message in reader.iter_messages():
            fields = json.loads(schema.data)["properties"].keys()
            assert json.loads(message.data).keys() <= fields, (channel.topic, schema.name)
            assert message.log_time >= last
            last = message.log_time
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
    for topic in ["/vehicle", "/reference", "/tf", "/law", "/rotors"]:
        assert counts.get(topic, 0) >= 100, counts
    assert counts["/scene"] == 1, counts


def main(folder):
    original = card(folder / "card.ulg")
    px4(folder / "px4.ulg", original)
    mcap(folder / "flight" / "flight.mcap")
    print("read: a card's log, the same as PX4's topics, an MCAP recording")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))

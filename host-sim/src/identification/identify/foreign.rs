//! Logs of other flight controllers: recognised by their first bytes, and answered with what to do.

/// What a file must have that is written from another log.
pub const READABLE_LOGS: &str = "identify reads ULog, of this firmware or of PX4, and a CSV with the columns t, est_vx to \
est_vz, est_qw to est_qz, est_wx to est_wz, thrust, tau_x to tau_z, pdx to pdz in the frames and units of docs/log.md; \
write that from your log; or say with --columns FILE which column of a real flight's CSV is what \
(docs/real-flights.md)";

/// How the log begins that some program writes, at which byte, and what is to be said of it.
const OTHER_LOGS: [(usize, &[u8], &str); 9] = [
    (
        0,
        b"H Product:Blackbox",
        "is a Blackbox log of Betaflight or INAV, which holds no velocities of a vehicle that flies setpoints",
    ),
    (
        0,
        &[0xA3, 0x95, 0x80],
        "is a DataFlash log of ArduPilot: mavlogdump.py --format csv --types ATT,IMU,RCOU,XKF1 of pymavlink reads it",
    ),
    (0, b"FMT,", "is a DataFlash log of ArduPilot as text"),
    (8, &[0xFE], "is a telemetry log (tlog), too slow to identify from: fetch the vehicle's own log (log download)"),
    (8, &[0xFD], "is a telemetry log (tlog), too slow to identify from: fetch the vehicle's own log (log download)"),
    (0, b"\x89MCAP", "is an MCAP recording; of a simulated flight take log.csv beside it"),
    (0, b"#ROSBAG", "is a ROS bag"),
    (0, &[0x1F, 0x8B], "is compressed: gunzip it first"),
    (0, b"PK\x03\x04", "is a ZIP archive: unpack it first"),
];

/// What to do with a log of another program; none if it is not recognised.
pub fn recognised(bytes: &[u8]) -> Option<String> {
    let begins = |(at, magic): (usize, &[u8])| bytes.get(at..).is_some_and(|rest| rest.starts_with(magic));
    let (_, _, what) = OTHER_LOGS.into_iter().find(|(at, magic, _)| {
        // Text of eight letters before such a byte is no telemetry: times of day begin with zeros.
        begins((*at, magic)) && (*at == 0 || bytes.first() == Some(&0))
    })?;
    Some(format!("{what}; {READABLE_LOGS}"))
}

use super::*;
use crate::sessions::hil::{End, HilError, HilSession, serve};
use crate::sessions::messages::decode;
use firmware::frames;
use mavlink::dialects::common::{
    ESC_STATUS_DATA, HEARTBEAT_DATA, HIL_ACTUATOR_CONTROLS_DATA, HIL_SENSOR_DATA, ODOMETRY_DATA,
};
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MessageData};
use nalgebra::Vector3;
use scenario::Scenario;
use std::io::Read;
use std::path::Path;

/// For waits that are to end in vain.
const FUTILE_WAIT: Duration = Duration::from_millis(300);

/// For waits that only a hang makes long.
const HANG_TIMEOUT: Duration = Duration::from_secs(30);

/// A port and the flight controller's end of its connection.
fn connected(timeout: Duration) -> (SimulatorPort, TcpStream) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = Address::Connect(listener.local_addr().unwrap().to_string());
    let port = SimulatorPort::open(&address, timeout, &Interrupt::default()).unwrap();
    let board = listener.accept().unwrap().0;
    board.set_read_timeout(Some(HANG_TIMEOUT)).unwrap();
    (port, board)
}

fn bytes(message: &impl MessageData) -> Vec<u8> {
    let mut frame = MAVLinkV2MessageRaw::new();
    frame.serialize_message_data(MavHeader { system_id: 1, component_id: 1, sequence: 0 }, message);
    frame.raw_bytes().to_vec()
}

fn command(time_usec: u64, level: f32) -> Vec<u8> {
    let mut controls = [0.0; 16];
    controls[..4].fill(level);
    bytes(&HIL_ACTUATOR_CONTROLS_DATA { time_usec, controls, ..Default::default() })
}

/// The next message of a kind that the board receives; none if it is another.
fn received<D: MessageData>(board: &mut TcpStream) -> Option<D> {
    let (mut parser, mut byte) = (Parser::new(), [0]);
    loop {
        board.read_exact(&mut byte).unwrap();
        if let Some(frame) = parser.push(byte[0], 0) {
            return decode(&frame);
        }
    }
}

#[test]
fn a_command_is_found_behind_noise_other_messages_and_in_pieces() {
    let (mut port, mut board) = connected(HANG_TIMEOUT);
    board.write_all(&[0, 1, 2, 0x55]).unwrap();
    board.write_all(&bytes(&HEARTBEAT_DATA::default())).unwrap();
    let frame = command(7_000, 0.5);
    let (begin, end) = frame.split_at(11);
    board.write_all(begin).unwrap();
    std::thread::sleep(POLL_PERIOD);
    board.write_all(end).unwrap();
    board.write_all(&command(17_000, 0.25)).unwrap();
    let first = port.receive().unwrap().unwrap();
    assert_eq!((first.time, first.commands), (7_000, [0.5; 4]));
    assert_eq!(port.receive().unwrap().unwrap().time, 17_000);
}

#[test]
fn a_silent_side_is_given_up_and_one_that_goes_is_no_error() {
    let (mut port, board) = connected(FUTILE_WAIT);
    let started = Instant::now();
    assert!(matches!(port.receive(), Err(PortError::Silent(FUTILE_WAIT))));
    assert!((FUTILE_WAIT..HANG_TIMEOUT).contains(&started.elapsed()), "{:?}", started.elapsed());
    drop(board);
    assert!(port.receive().unwrap().is_none());
}

#[test]
fn no_connection_is_waited_for_without_end() {
    let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();
    for address in [Address::Connect(free.clone()), Address::Listen(free)] {
        let started = Instant::now();
        let Err(PortError::NoConnection(who, waited, _)) =
            SimulatorPort::open(&address, FUTILE_WAIT, &Interrupt::default())
        else {
            panic!("connected")
        };
        assert_eq!((who, waited), (address, FUTILE_WAIT));
        assert!(started.elapsed() < HANG_TIMEOUT);
    }
}

#[test]
fn a_side_that_does_not_even_refuse_is_given_up_in_time_and_for_an_interrupt() {
    // The listener accepts nothing: once as many wait as the system lets, it answers no more.
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let waiting: Vec<TcpStream> =
        (0..1000).map_while(|_| TcpStream::connect_timeout(&address, Duration::from_millis(100)).ok()).collect();
    assert!(waiting.len() < 1000);
    let address = Address::Connect(address.to_string());
    let started = Instant::now();
    let Err(PortError::NoConnection(..)) = SimulatorPort::open(&address, FUTILE_WAIT, &Interrupt::default()) else {
        panic!("found")
    };
    let interrupt = Interrupt::default();
    let asking = interrupt.clone();
    let user = std::thread::spawn(move || {
        std::thread::sleep(FUTILE_WAIT);
        asking.ask();
    });
    assert!(matches!(SimulatorPort::open(&address, 4 * HANG_TIMEOUT, &interrupt), Err(PortError::Interrupted(_))));
    user.join().unwrap();
    assert!(started.elapsed() < HANG_TIMEOUT, "{:?}", started.elapsed());
}

#[test]
fn each_command_is_answered_with_the_periods_end_pose_first_until_poses_are_withheld() {
    let (mut port, mut board) = connected(HANG_TIMEOUT);
    let scenario = Scenario::load(Path::new("../vehicles/study.toml")).unwrap();
    let session = HilSession { duration: Some(0.03), pose_until: Some(0.02), speed: None };
    let board = std::thread::spawn(move || {
        for tick in 0..3 {
            let time = 5_000 + 10_000 * tick;
            board.write_all(&command(time, 0.0)).unwrap();
            if tick < 2 {
                let pose: ODOMETRY_DATA = received(&mut board).expect("a pose first");
                assert_eq!((pose.time_usec, pose.z), (time + 10_000, 0.0));
                assert_eq!((pose.pose_covariance, pose.velocity_covariance), ([0.0; 21], [0.0; 21]));
            }
            let speeds: ESC_STATUS_DATA = received(&mut board).expect("the rotors' speeds next");
            assert_eq!(speeds.rpm, [0; 4]);
            let sensor: HIL_SENSOR_DATA = received(&mut board).expect("sensors last");
            assert_eq!(sensor.time_usec, time + 10_000);
            // At rest it feels the ground push: up, which is against FRD's z.
            let force = frames::body(&Vector3::new(sensor.xacc, sensor.yacc, sensor.zacc));
            assert!((force - Vector3::z() * 9.81).norm() < 1e-4, "{force}");
        }
    });
    let summary = serve(&scenario, &mut port, &session, None, None).unwrap();
    board.join().unwrap();
    assert_eq!((summary.pace.ticks(), summary.end), (3, End::Over));
    assert!(summary.to_string().contains(", 0 missed"), "{summary}");
}

/// Everything that a board receives in a session with sensors at 1 kHz, whose commands come a little irregularly.
fn received_in_a_noisy_session() -> Vec<u8> {
    const TICK_COUNT: u64 = 20;
    let (mut port, mut board) = connected(HANG_TIMEOUT);
    let study = std::fs::read_to_string("../vehicles/study.toml").unwrap();
    let scenario = Scenario::parse(&format!("{study}\n[estimator]\n"), "test.toml").unwrap();
    let board = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        for tick in 0..TICK_COUNT {
            let time = 5_000 + 10_000 * tick + 3 * (tick % 4);
            board.write_all(&command(time, 0.9)).unwrap();
            let mut ends = 0;
            let mut parser = Parser::new();
            while ends < time + 10_000 {
                let mut byte = [0];
                board.read_exact(&mut byte).unwrap();
                bytes.push(byte[0]);
                let sensor = parser.push(byte[0], 0).and_then(|frame| decode::<HIL_SENSOR_DATA>(&frame));
                ends = sensor.map_or(ends, |sensor| sensor.time_usec);
            }
        }
        bytes
    });
    let session = HilSession { duration: Some(0.01 * TICK_COUNT as f64), pose_until: None, speed: None };
    serve(&scenario, &mut port, &session, None, None).unwrap();
    board.join().unwrap()
}

#[test]
fn a_session_with_noise_is_the_same_to_the_last_bit_each_time_and_says_how_sure_its_poses_are() {
    let bytes = received_in_a_noisy_session();
    assert_eq!(bytes, received_in_a_noisy_session());
    let (mut parser, mut poses, mut samples) = (Parser::new(), 0, 0);
    for byte in bytes {
        let Some(frame) = parser.push(byte, 0) else { continue };
        samples += u32::from(decode::<HIL_SENSOR_DATA>(&frame).is_some());
        let Some(pose) = decode::<ODOMETRY_DATA>(&frame) else { continue };
        poses += 1;
        assert_eq!((pose.pose_covariance[0], pose.pose_covariance[11]), (1e-3 * 1e-3, 1e-3 * 1e-3));
        let attitude_noise = 0.3_f32.to_radians();
        assert!((pose.pose_covariance[20].sqrt() - attitude_noise).abs() < 1e-6);
        assert!(pose.velocity_covariance[0].is_nan());
    }
    // A pose every 10 ms: the last two are still under way.
    assert_eq!((samples, poses), (200, 18));
}

#[test]
fn a_session_is_held_to_a_speed_of_this_desks_time() {
    const TICK_COUNT: u64 = 20;
    let scenario = Scenario::load(Path::new("../vehicles/study.toml")).unwrap();
    let took = |speed| {
        let (mut port, mut board) = connected(HANG_TIMEOUT);
        let board = std::thread::spawn(move || {
            for tick in 1..=TICK_COUNT {
                board.write_all(&command(10_000 * tick, 0.0)).unwrap();
                while received::<HIL_SENSOR_DATA>(&mut board).is_none() {}
            }
        });
        let session = HilSession { duration: Some(0.01 * TICK_COUNT as f64), pose_until: None, speed };
        let summary = serve(&scenario, &mut port, &session, None, None).unwrap();
        board.join().unwrap();
        assert_eq!(summary.pace.ticks(), TICK_COUNT);
        summary.took
    };
    // 0.2 s of the vehicle's; the first tick starts the clock.
    let (free, held) = (took(None), took(Some(0.25)));
    assert!((Duration::from_millis(760)..HANG_TIMEOUT).contains(&held) && free < held, "{free:?} {held:?}");
}

#[test]
fn a_command_that_is_no_number_ends_the_session_in_words() {
    let (mut port, mut board) = connected(HANG_TIMEOUT);
    board.write_all(&command(5_000, f32::NAN)).unwrap();
    let scenario = Scenario::load(Path::new("../vehicles/study.toml")).unwrap();
    let Err(HilError::Flight(what)) = serve(&scenario, &mut port, &HilSession::default(), None, None) else {
        panic!("flown")
    };
    assert!(what.contains("0 to 1"), "{what}");
}

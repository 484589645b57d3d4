//! CRTP: a session's packets, and what becomes of them.

use crate::support::receiver::{Local, report};
use controller_core::certificate::certified::Certified;
use controller_core::governor::{HeadingSetpoint, Motion};
use controller_core::heading::Heading;
use controller_core::reference::Reference;
use controller_core::state::State;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use firmware::crtp::packet::Packet;
use firmware::crtp::pieces::MEMORY_BYTES;
use firmware::crtp::session::Session;
use firmware::link::commander::COMMANDER_TIMEOUT_US;
use firmware::link::signing::Key;
use firmware::parameters::table::Name;
use firmware::shared::{Protocol, Report};
use flight::{Mode, Request};
use nalgebra::{Quaternion, Vector3};

/// The session's own sender.
const SENDER: (u8, u8) = firmware::crtp::flying::SENDER;

const SECOND: u64 = 1_000_000;

/// A client at its session.
struct Client<'a> {
    session: Box<Session<'a, NoopRawMutex>>,
    now: u64,
}

impl<'a> Client<'a> {
    fn new(shared: &'a Local) -> Self {
        let memory = Box::leak(Box::new([0; MEMORY_BYTES]));
        Self { session: Box::new(Session::new(shared.for_crtp(), memory)), now: SECOND }
    }

    /// Sends a packet; what comes back at once.
    fn send(&mut self, port: u8, channel: u8, data: &[u8]) -> Vec<Packet> {
        self.session.take(&Packet::new(port, channel).with(data), self.now);
        self.received()
    }

    fn received(&mut self) -> Vec<Packet> {
        let now = self.now;
        std::iter::from_fn(|| self.session.next(now)).collect()
    }

    /// The only answer's data.
    fn ask(&mut self, port: u8, channel: u8, data: &[u8]) -> Vec<u8> {
        match &self.send(port, channel, data)[..] {
            [answer] if (answer.port, answer.channel) == (port, channel) => answer.data().to_vec(),
            other => panic!("{other:?}"),
        }
    }

    /// Time passes, and the vehicle is led.
    fn pass(&mut self, time: u64) {
        let end = self.now + time;
        while self.now < end {
            self.now = (self.now + 10_000).min(end);
            self.session.lead(self.now);
        }
    }

    /// What the console has said since.
    fn console(&mut self) -> String {
        let packets = self.received().into_iter().filter(|packet| packet.port == 0);
        let bytes: Vec<u8> = packets.flat_map(|packet| packet.data().to_vec()).collect();
        String::from_utf8(bytes).unwrap()
    }
}

fn floats<const COUNT: usize>(numbers: [f32; COUNT]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// A vehicle in the air, whose reference rests at a place, facing x; its own setpoints are flown if it flies.
fn flies(shared: &Local, mode: Mode, place: Vector3<f32>, time: u64) {
    let still = Vector3::zeros();
    let attitude = Quaternion::identity();
    let state = Some(State { position: place, velocity: still, attitude, angular_velocity: still });
    let reference = Some(Reference::resting(place, Heading::FORWARD));
    let is_airborne = mode != Mode::Idling;
    shared.report.put(Report { mode, state, reference, is_airborne, ..Report::NONE }, time);
    shared.setpoint_owner.set((mode == Mode::Flying).then_some(SENDER));
}

/// With a certified configuration.
fn certified() -> Local {
    let verdict = Box::leak(Box::new(Certified::new(firmware::configuration::embedded().unwrap())));
    let shared = Local::new();
    shared.verdict.put(verdict, 0);
    shared
}

fn requests(shared: &Local) -> Vec<Request> {
    std::iter::from_fn(|| shared.requests.take()).map(|asked| asked.request).collect()
}

/// The number of a parameter, by the table of contents.
fn parameter(client: &mut Client<'_>, group: &str, name: &str) -> [u8; 2] {
    let count = client.ask(2, 0, &[3]);
    let count = u16::from_le_bytes([count[1], count[2]]);
    let wanted = [group.as_bytes(), &[0], name.as_bytes(), &[0]].concat();
    let numbers = (0..count).map(u16::to_le_bytes);
    let found = numbers.into_iter().find(|[low, high]| client.ask(2, 0, &[2, *low, *high])[4..] == wanted);
    found.unwrap_or_else(|| panic!("{group}.{name}"))
}

#[test]
fn both_tables_are_told_item_by_item_and_their_checksums_are_of_what_is_told() {
    let shared = Local::new();
    let mut client = Client::new(&shared);
    for (port, room) in [(2, 0), (5, 2)] {
        let information = client.ask(port, 0, &[3]);
        assert_eq!(information.len(), 7 + room);
        let (count, checksum) = information[1..].split_at(2);
        let count = u16::from_le_bytes(count.try_into().unwrap());
        let told: Vec<u8> = (0..count)
            .flat_map(|number| {
                let [low, high] = number.to_le_bytes();
                let item = client.ask(port, 0, &[2, low, high]);
                assert_eq!(item[..3], [2, low, high]);
                item[3..].to_vec()
            })
            .collect();
        assert_eq!(checksum[..4], crc32(&told).to_le_bytes());
        let [low, high] = count.to_le_bytes();
        assert_eq!(client.ask(port, 0, &[2, low, high]), [2], "an item that is not there");
        assert_eq!(client.send(port, 0, &[9]), []);
    }
}

/// CRC-32 as zip files have it, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let shift = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| shift(crc)))
}

#[test]
fn a_parameter_is_read_and_set_and_what_is_refused_stays_with_a_reason() {
    let shared = Local::new();
    let mut client = Client::new(&shared);
    let low = parameter(&mut client, "BAT", "LOW");
    let set = |client: &mut Client<'_>, volts: f32| client.ask(2, 2, &[&low[..], &volts.to_le_bytes()].concat());
    assert_eq!(set(&mut client, 7.5)[2..], 7.5_f32.to_le_bytes());
    assert_eq!(shared.parameters.get(Name::BatteryLow), 7.5);
    assert_eq!(client.ask(2, 1, &low)[2..], [&[0][..], &7.5_f32.to_le_bytes()].concat());
    let packets = client.send(2, 2, &[&low[..], &99_f32.to_le_bytes()].concat());
    assert_eq!(packets[0].data()[2..], 7.5_f32.to_le_bytes());
    let said: Vec<u8> = packets[1..].iter().flat_map(|packet| packet.data().to_vec()).collect();
    assert_eq!(String::from_utf8(said).unwrap(), "BAT_LOW: allowed are 0.00 to 60.00 V\n");
    assert_eq!(client.ask(2, 1, &[0xFF, 0xFF]), [0xFF, 0xFF, 2]);
    assert_eq!(client.ask(2, 2, &[0xFF, 0xFF, 0]), [0xFF, 0xFF, 2]);
}

#[test]
fn a_value_without_effect_is_not_taken_as_if_it_had_one() {
    let shared = Local::new();
    let mut client = Client::new(&shared);
    let controller = parameter(&mut client, "stabilizer", "controller");
    let packets = client.send(2, 2, &[controller[0], controller[1], 3]);
    assert_eq!(packets[0].data(), [controller[0], controller[1], 0]);
    assert!(packets.len() > 1, "no reason");
    let reset = parameter(&mut client, "kalman", "resetEstimation");
    assert_eq!(client.ask(2, 2, &[reset[0], reset[1], 1]), [reset[0], reset[1], 0]);
    // By name: of the right kind, of a wrong one, of one that is not there.
    let by_name = |client: &mut Client<'_>, rest: &[u8]| client.ask(2, 3, &[b"\0BAT\0CRIT\0", rest].concat());
    assert_eq!(by_name(&mut client, &[&[6][..], &6.5_f32.to_le_bytes()].concat()), b"\0BAT\0CRIT\0\0");
    assert_eq!(shared.parameters.get(Name::BatteryCritical), 6.5);
    assert_eq!(by_name(&mut client, &[8, 1]), b"\0BAT\0CRIT\0\x16");
    assert_eq!(client.ask(2, 3, b"\0NO\0SUCH\0\x08\x01"), b"\0NO\0SUCH\0\x02");
}

#[test]
fn arming_is_answered_once_control_has_decided() {
    let shared = certified();
    report(&shared, Mode::Ready, SECOND);
    let mut client = Client::new(&shared);
    assert_eq!(client.send(9, 1, &[1, 1]), []);
    assert_eq!(requests(&shared), [Request::Arm]);
    report(&shared, Mode::Idling, client.now);
    assert_eq!(client.received()[0].data(), [0x81, 1, 1]);
    // One that is refused is answered after its time.
    report(&shared, Mode::Checks, client.now);
    assert_eq!(client.send(9, 1, &[1, 1]), []);
    client.now += 100_000;
    assert_eq!(client.received()[0].data(), [0x81, 0, 0]);
    assert_eq!(client.ask(9, 0, &[12])[1..], [0, 0]);
}

#[test]
fn a_take_off_with_too_little_time_goes_to_the_place() {
    let shared = certified();
    let mut client = Client::new(&shared);
    flies(&shared, Mode::Idling, Vector3::new(1.0, 2.0, 0.0), SECOND);
    let packets = client.send(8, 0, &[&[7, 0][..], &floats([1.5, 0.0]), &[1], &0.5_f32.to_le_bytes()].concat());
    assert_eq!(packets[0].data(), [7, 0, 0, 0]);
    assert!(packets[1].data().starts_with(b"0.5 s is too short"));
    let asked = shared.requests.take().unwrap();
    assert_eq!((asked.request, asked.setpoints), (Request::FlySetpoints, Some(SENDER)));
    let setpoint = shared.setpoint.take().unwrap().value;
    assert_eq!(setpoint.motion, Motion::Position(Vector3::new(1.0, 2.0, 1.5)));
    // There, the vehicle is led at rest, and the command is over.
    flies(&shared, Mode::Flying, Vector3::new(1.0, 2.0, 1.5), client.now);
    client.pass(20_000);
    assert_eq!(u16::from_le_bytes(client.ask(9, 0, &[12])[1..].try_into().unwrap()) & 0x300, 0x200);
}

#[test]
fn a_way_with_time_enough_is_led_by_the_clock_and_a_landing_ends_it() {
    let shared = certified();
    let mut client = Client::new(&shared);
    flies(&shared, Mode::Flying, Vector3::zeros(), SECOND);
    let to = [&[12, 0, 0, 0][..], &floats([2.0, 0.0, 0.0, 0.0, 60.0])].concat();
    assert_eq!(client.ask(8, 0, &to), [12, 0, 0, 0]);
    let place = |shared: &Local| match shared.setpoint.take().unwrap().value.motion {
        Motion::PositionVelocityAcceleration { position, .. } => position.x,
        other => panic!("{other:?}"),
    };
    client.pass(2 * SECOND);
    assert_eq!(place(&shared), 0.0);
    client.pass(30 * SECOND);
    assert!((place(&shared) - 1.0).abs() < 1e-3);
    client.pass(31 * SECOND);
    assert!((place(&shared) - 2.0).abs() < 1e-5);
    // Whatever else the vehicle does ends it.
    flies(&shared, Mode::Landing, Vector3::zeros(), client.now);
    client.pass(SECOND);
    let _ = shared.setpoint.take();
    flies(&shared, Mode::Flying, Vector3::zeros(), client.now);
    client.pass(SECOND);
    assert_eq!(shared.setpoint.take(), None);
}

#[test]
fn commands_for_others_and_without_an_armed_vehicle_do_nothing() {
    let shared = certified();
    let mut client = Client::new(&shared);
    flies(&shared, Mode::Ready, Vector3::zeros(), SECOND);
    let take_off = |group: u8| [&[1, group][..], &floats([1.0, 9.0])].concat();
    assert_eq!(client.send(8, 0, &take_off(0))[0].data()[3], 16);
    flies(&shared, Mode::Idling, Vector3::zeros(), SECOND);
    assert_eq!(client.ask(8, 0, &take_off(2)), [1, 2, 0, 0]);
    assert_eq!((requests(&shared), shared.setpoint.take()), (vec![], None));
    client.send(8, 0, &[0, 6]);
    client.send(8, 0, &take_off(2));
    assert_eq!(requests(&shared), [Request::FlySetpoints]);
    for wrong in [&[11, 0][..], &[99], &[], &[7, 0, 1]] {
        assert_eq!(client.send(8, 0, wrong)[0].data()[3], 8, "{wrong:?}");
    }
    let never = [&[12, 0, 0, 0][..], &floats([f32::NAN, 0.0, 0.0, 0.0, 9.0])].concat();
    assert_eq!(client.send(8, 0, &never)[0].data()[3], 8);
}

#[test]
fn a_stream_is_flown_from_its_first_setpoint_and_a_hand_off_the_sticks_ends_it() {
    let shared = certified();
    let mut client = Client::new(&shared);
    flies(&shared, Mode::Idling, Vector3::zeros(), SECOND);
    let hover = [&[10][..], &floats([0.5, 0.0, 0.0, 1.0])].concat();
    client.send(7, 0, &hover);
    let setpoint = shared.setpoint.take().unwrap().value;
    assert_eq!(setpoint.turn, HeadingSetpoint::Rate(0.0));
    assert_eq!(requests(&shared), [Request::FlySetpoints]);
    flies(&shared, Mode::Flying, Vector3::zeros(), client.now);
    client.now += 100_000;
    client.send(7, 0, &hover);
    assert_eq!((requests(&shared), shared.setpoint.take().is_some()), (vec![], true));
    // cflib sends zeros when it closes a link.
    client.send(3, 0, &[0; 14]);
    assert_eq!(requests(&shared), [Request::Hold]);
    client.send(3, 0, &[0; 14]);
    assert_eq!(requests(&shared), []);
    // After a pause it is another stream.
    client.now += 2 * SECOND;
    client.send(7, 0, &hover);
    assert_eq!(requests(&shared), [Request::FlySetpoints]);
}

#[test]
fn a_stop_lands_what_flies_and_disarms_what_stands() {
    let shared = certified();
    let mut client = Client::new(&shared);
    for (mode, expected) in
        [(Mode::Flying, vec![Request::Land]), (Mode::Idling, vec![Request::Disarm]), (Mode::Ready, vec![])]
    {
        flies(&shared, mode, Vector3::zeros(), SECOND);
        client.send(7, 0, &[0]);
        assert_eq!(requests(&shared), expected, "{mode:?}");
        client.send(8, 0, &[3, 0]);
        assert_eq!(requests(&shared), expected, "{mode:?}");
    }
    assert!(!shared.disarm.is_raised());
}

#[test]
fn setpoints_of_others_and_sticks_are_not_disturbed() {
    let shared = certified();
    let mut client = Client::new(&shared);
    let hover = [&[10][..], &floats([0.5, 0.0, 0.0, 1.0])].concat();
    flies(&shared, Mode::Flying, Vector3::zeros(), SECOND);
    client.send(7, 0, &hover);
    let _ = (shared.setpoint.take(), requests(&shared));
    // Another client has taken over meanwhile.
    shared.setpoint_owner.set(Some((255, 190)));
    client.now += 100_000;
    client.send(7, 0, &hover);
    assert!(shared.setpoint.take().is_none());
    shared.setpoint_owner.set(None);
    shared.sticks.put(true, client.now);
    client.now += 2 * SECOND;
    let packets = client.send(7, 0, &hover);
    assert!(shared.setpoint.take().is_none() && requests(&shared).is_empty());
    assert!(!packets.is_empty(), "no word of it");
}

#[test]
fn an_emergency_stop_stops_but_for_a_station_that_commands() {
    let shared = certified();
    let mut client = Client::new(&shared);
    let stop = |client: &mut Client<'_>, port: u8, data: &[u8]| {
        client.send(port, 1, data);
        shared.disarm.take()
    };
    flies(&shared, Mode::Flying, Vector3::zeros(), SECOND);
    shared.commander.put(None, SECOND);
    assert!(stop(&mut client, 9, &[3]) && stop(&mut client, 6, &[3]));
    shared.commander.put(Some((255, 190)), SECOND);
    assert!(!stop(&mut client, 9, &[3]));
    client.now += COMMANDER_TIMEOUT_US + 1;
    shared.commander_heard.put((), client.now);
    assert!(!stop(&mut client, 9, &[3]));
    client.now += COMMANDER_TIMEOUT_US + 1;
    assert!(stop(&mut client, 9, &[3]));
}

#[test]
fn a_watchdog_that_is_not_fed_any_more_stops_the_motors_once() {
    let shared = certified();
    let mut client = Client::new(&shared);
    flies(&shared, Mode::Flying, Vector3::zeros(), SECOND);
    shared.commander.put(None, SECOND);
    for _ in 0..5 {
        client.send(9, 1, &[4]);
        client.now += 900_000;
        client.received();
        assert!(!shared.disarm.take());
    }
    client.now += 200_000;
    assert!(client.console().contains("watchdog"));
    assert!(shared.disarm.take());
    client.now += 9 * SECOND;
    client.received();
    assert!(!shared.disarm.take());
}

#[test]
fn poses_are_taken_whole_packed_and_without_an_attitude() {
    let shared = certified();
    let mut client = Client::new(&shared);
    let number = shared.parameters.get(Name::RadioAddress) as u8;
    let pose = |client: &mut Client<'_>, channel: u8, data: &[u8]| {
        client.now += 20_000;
        client.send(6, channel, data);
        // Of two at once the first will do.
        client.send(6, channel, data);
        let (pose, second) = (shared.poses.take(), shared.poses.take());
        assert_eq!(second, None);
        pose.map(|pose| (client.now - pose.time, pose.value))
    };
    let whole = [&[8][..], &floats([1.0, 2.0, 3.0, 0.0, 0.0, 1.0, 0.0])].concat();
    let (age, found) = pose(&mut client, 1, &whole).unwrap();
    assert_eq!((age, found.position()), (0, Vector3::new(1.0, 2.0, 3.0)));
    assert_eq!(found.attitude(), Quaternion::new(0.0, 0.0, 0.0, 1.0));
    assert!(shared.pose_delay_unknown.is_raised());
    shared.parameters.set(Name::PoseDelay, 10.0).unwrap();
    assert_eq!(pose(&mut client, 1, &whole).unwrap().0, 10_000);
    assert!(!shared.pose_delay_unknown.is_raised());

    let item = |id: u8, x: i16| [&[id][..], &x.to_le_bytes(), &[0; 4]].concat();
    let level = 0xC000_0000_u32.to_le_bytes();
    let two = [&[9][..], &item(number ^ 1, 7), &level, &item(number, -1500), &level].concat();
    assert!((pose(&mut client, 1, &two).unwrap().1.position().x + 1.5).abs() < 1e-6);
    assert_eq!(pose(&mut client, 1, &two[..12]), None, "another vehicle's");
    assert_eq!(pose(&mut client, 2, &[item(9, 1), item(number, 250)].concat()).unwrap().1.position().x, 0.25);
    // A place alone says nothing of the attitude that the estimate has.
    let turned = Quaternion::new(0.8, 0.0, 0.0, 0.6);
    let still = Vector3::zeros();
    let state = Some(State { position: still, velocity: still, attitude: turned, angular_velocity: still });
    shared.report.put(Report { state, ..Report::NONE }, client.now);
    let alone = pose(&mut client, 0, &floats([4.0, 5.0, 6.0])).unwrap().1;
    assert_eq!(alone.position(), Vector3::new(4.0, 5.0, 6.0));
    assert!((alone.attitude() - turned).norm() < 1e-6);
}

#[test]
fn a_pose_that_cannot_be_one_or_comes_beside_another_protocols_is_refused() {
    let shared = certified();
    let mut client = Client::new(&shared);
    for numbers in [[f32::NAN; 7], [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0], [1e9, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]] {
        client.send(6, 1, &[&[8][..], &floats(numbers)].concat());
        assert!(shared.poses.take().is_none(), "{numbers:?}");
    }
    let good = [&[8][..], &floats([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])].concat();
    shared.pose_protocol.put(Protocol::Mavlink, client.now);
    client.send(6, 1, &good);
    assert!(shared.poses.take().is_none());
    client.now += 2 * SECOND;
    client.send(6, 1, &good);
    assert!(shared.poses.take().is_some());
}

#[test]
fn where_everything_must_be_signed_questions_are_answered_and_nothing_else_is_done() {
    let shared = certified();
    shared.signing.set(Key::new([7; 32]), 0, 0);
    flies(&shared, Mode::Flying, Vector3::zeros(), SECOND);
    let mut client = Client::new(&shared);
    let low = parameter(&mut client, "BAT", "LOW");
    let pose = [&[8][..], &floats([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])].concat();
    let hover = [&[10][..], &floats([0.5, 0.0, 0.0, 1.0])].concat();
    for (port, channel, data) in [
        (9, 1, &[1, 1][..]),
        (9, 1, &[3]),
        (9, 1, &[4]),
        (6, 1, &[3]),
        (6, 1, &pose),
        (7, 0, &hover),
        (7, 0, &[0]),
        (8, 0, &[3, 0]),
        (13, 0, &[1, 1]),
        (2, 2, &[low[0], low[1], 0, 0, 0xE0, 0x40]),
        (4, 2, &[0, 0, 0, 0, 0, 1]),
    ] {
        client.send(port, channel, data);
    }
    client.now += 5 * SECOND;
    client.received();
    assert_eq!(requests(&shared), []);
    assert!(shared.setpoint.take().is_none() && shared.poses.take().is_none() && !shared.disarm.take());
    assert_eq!(shared.parameters.get(Name::BatteryLow), 0.0);
    assert_eq!(client.ask(4, 1, &[0, 0, 0, 0, 0, 1])[6], 0);
    shared.parameters.set(Name::SignedOnly, 0.0).unwrap();
    client.send(7, 0, &hover);
    assert_eq!(requests(&shared), [Request::FlySetpoints]);
}

#[test]
fn a_trajectory_is_uploaded_read_back_and_flown_but_not_changed_meanwhile() {
    let shared = certified();
    let mut client = Client::new(&shared);
    flies(&shared, Mode::Flying, Vector3::zeros(), SECOND);
    let mut piece = vec![0; 128];
    piece.extend(9_f32.to_le_bytes());
    for (chunk, bytes) in piece.chunks(24).enumerate() {
        let address = (24 * chunk as u32).to_le_bytes();
        assert_eq!(client.ask(4, 2, &[&[0][..], &address, bytes].concat())[5], 0);
    }
    assert_eq!(client.ask(4, 1, &[0, 128, 0, 0, 0, 4])[5..], [&[0][..], &9_f32.to_le_bytes()].concat());
    assert_eq!(client.ask(8, 0, &[6, 2, 1, 0, 0, 0, 0, 0, 1]), [6, 2, 1, 0]);
    let start = [&[13, 0, 0, 0, 0, 2][..], &1_f32.to_le_bytes()].concat();
    assert_eq!(client.ask(8, 0, &start), [13, 0, 0, 0]);
    assert_eq!(client.ask(4, 2, &[0, 0, 0, 0, 0, 1])[5], 16);
    client.pass(20 * SECOND);
    assert_eq!(client.ask(4, 2, &[0, 0, 0, 0, 0, 1])[5], 0);
    for (wrong, error) in [(3, 2), (77, 2)] {
        let start = [&[13, 0, 0, 0, 0, wrong][..], &1_f32.to_le_bytes()].concat();
        assert_eq!(client.send(8, 0, &start)[0].data()[3], error);
    }
    assert_eq!(client.ask(4, 0, &[1]), [1, 1]);
    assert_eq!(client.ask(4, 0, &[2, 0])[..7], [2, 0, 0x12, 0, 16, 0, 0]);
    assert_eq!(client.ask(4, 0, &[2, 9]), [2, 9]);
    assert_eq!(client.ask(4, 1, &[7, 0, 0, 0, 0, 4])[5], 5);
    assert_eq!(client.ask(4, 1, &[0, 0xFF, 0xFF, 0, 0, 4])[5], 5);
    assert_eq!(client.ask(4, 1, &[0, 0, 0, 0, 0, 25])[5], 5);
}

#[test]
fn who_is_there_is_told_and_a_probe_is_no_client() {
    let shared = Local::new();
    let mut client = Client::new(&shared);
    assert!(client.send(15, 3, &[]).is_empty() && client.send(1, 0, &[0]).is_empty());
    assert!(shared.ground_station.get().is_none() && !shared.has_console.is_raised());
    assert_eq!(client.ask(15, 0, &[1, 2, 3]), [1, 2, 3]);
    assert_eq!(client.ask(15, 1, &[0]), b"Bitcraze Crazyflie");
    assert_eq!(client.ask(13, 1, &[0]), [0, 12, 0, 0, 0]);
    assert_eq!(client.ask(13, 1, &[2]), b"\x02CB11");
    assert!(shared.ground_station.get().is_some() && shared.has_console.is_raised());
    client.now += 11 * SECOND;
    client.received();
    assert!(!shared.has_console.is_raised());
}

#[test]
fn no_packet_whatever_its_bytes_panics_or_is_answered_twice() {
    let shared = certified();
    flies(&shared, Mode::Flying, Vector3::zeros(), SECOND);
    let mut client = Client::new(&shared);
    let mut state = 0x2545_F491_4F6C_DD1D_u64;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    for _ in 0..200_000 {
        let count = (random() % 31) as usize;
        let data: Vec<u8> = (0..count).map(|_| random() as u8).collect();
        let (port, channel) = (random() as u8 & 15, random() as u8 & 3);
        let answers = client.send(port, channel, &data);
        let direct = answers.iter().filter(|answer| (answer.port, answer.channel) == (port, channel) && port != 0);
        assert!(direct.count() <= 1, "{port} {channel} {data:?}: {answers:?}");
        client.pass(10_000);
        let _ = (requests(&shared), shared.setpoint.take(), shared.poses.take(), shared.disarm.take());
    }
}

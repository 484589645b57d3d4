use super::*;
use estimation::estimator::Fault as EstimatorFault;
use firmware::link::signing::{KEPT_AHEAD, Key, Signing};
use flight::Mode;
use mavlink::dialects::common::{
    ATT_POS_MOCAP_DATA, COMMAND_LONG_DATA, HEARTBEAT_DATA, MavCmd, MavFrame, MavType, PositionTargetTypemask,
    SET_POSITION_TARGET_LOCAL_NED_DATA,
};
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MessageData};
use scenario::STUDY;
use scenario::body::BodyState;
use std::net::{Ipv4Addr, UdpSocket};

mod answering;
mod kept;

/// A session without a desk's clock, and a client of it.
struct Flown {
    sitl: Sitl,
    client: UdpSocket,
    local: u16,
    sequence: u8,
    /// The client's; without a key it signs nothing.
    signing: Signing<NoopRawMutex>,
}

impl Flown {
    fn boot(text: &str, faults: &[&str], parameters: Option<PathBuf>) -> Self {
        Self::boot_with(PoseSource::Camera, text, faults, parameters, None)
    }

    fn boot_with(
        poses: PoseSource,
        text: &str,
        faults: &[&str],
        parameters: Option<PathBuf>,
        signing_key: Option<Key>,
    ) -> Self {
        let socket = || UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let (client, ground, free) = (socket(), socket(), socket());
        let port = |socket: &UdpSocket| socket.local_addr().unwrap().port();
        let ports = Ports { offboard: port(&client), ground: port(&ground), local: port(&free) };
        drop(free);
        let faults = faults.iter().map(|fault| fault.parse().unwrap()).collect();
        let session = SitlSession {
            file: "a file".to_owned(),
            ports,
            crtp: None,
            speed: 1.0,
            duration: None,
            poses,
            has_hands: false,
            faults,
            parameters,
            signing_key,
            truth: None,
            recording: None,
            gyro: None,
        };
        let mut said = String::new();
        let say = |line: &str| said.push_str(line);
        let (sitl, warning) = Sitl::boot(&Scenario::parse(text, "a test").unwrap(), &session, say).unwrap();
        assert_eq!(warning, None);
        assert!(said.contains(": starting"), "{said}");
        Self { sitl, client, local: ports.local, sequence: 0, signing: Signing::new() }
    }

    fn send(&mut self, message: &impl MessageData) {
        let mut frame = MAVLinkV2MessageRaw::new();
        self.sequence = self.sequence.wrapping_add(1);
        frame.serialize_message_data(MavHeader { system_id: 255, component_id: 190, sequence: self.sequence }, message);
        self.signing.sign(&mut frame, 0);
        self.client.send_to(frame.raw_bytes(), (Ipv4Addr::LOCALHOST, self.local)).unwrap();
    }

    fn ask(&mut self, command: MavCmd, [param1, param2]: [f32; 2]) {
        let (target_system, target_component) = (1, 1);
        let default = COMMAND_LONG_DATA::DEFAULT;
        self.send(&COMMAND_LONG_DATA { command, param1, param2, target_system, target_component, ..default });
    }

    fn command(&mut self, command: MavCmd, param1: f32) {
        self.ask(command, [param1, 0.0]);
        self.pass(0.1);
    }

    /// Lets vehicle time pass, s, with a heartbeat every half second.
    fn pass(&mut self, seconds: f64) {
        let end = self.sitl.clock.now() + (seconds * 1e6) as u64;
        while self.sitl.clock.now() < end {
            let now = self.sitl.clock.now();
            if now.is_multiple_of(500_000) {
                self.send(&HEARTBEAT_DATA { mavtype: MavType::MAV_TYPE_GCS, ..HEARTBEAT_DATA::DEFAULT });
            }
            self.sitl.receive();
            self.sitl.pass((now + 10_000).min(end));
        }
    }

    /// Lets vehicle time pass, s, and sends a pose of where the vehicle really is every 10 ms.
    fn pass_with_poses(&mut self, seconds: f64) {
        for _ in 0..(seconds * 100.0) as u32 {
            let BodyState { position, attitude, .. } = self.sitl.hardware.state();
            let q = firmware::frames::attitude(&attitude.cast()).coords;
            let at = firmware::frames::world(&position.cast());
            let time_usec = 7_000_000 + self.sitl.clock.now();
            self.send(&ATT_POS_MOCAP_DATA { time_usec, q: [q.w, q.x, q.y, q.z], x: at.x, y: at.y, z: at.z });
            self.pass(0.01);
        }
    }

    fn mode(&self) -> Mode {
        self.sitl.summary(None).mode.unwrap()
    }

    fn said(&self, text: &str) -> bool {
        self.sitl.texts.borrow().iter().any(|(_, said)| said.contains(text))
    }

    /// Ready after 5 s, armed and up at 20 s.
    fn in_the_air(text: &str, faults: &[&str]) -> Self {
        let mut flown = Self::boot(text, faults, None);
        flown.pass(5.0);
        assert_eq!(flown.mode(), Mode::Ready);
        flown.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, 1.0);
        flown.command(MavCmd::MAV_CMD_NAV_TAKEOFF, 0.0);
        flown.pass(14.8);
        assert_eq!(flown.mode(), Mode::Holding, "{:?}", flown.sitl.texts);
        flown
    }
}

#[test]
fn a_client_arms_takes_off_and_lands_with_late_and_noisy_poses() {
    let mut flown = Flown::in_the_air(STUDY, &[]);
    let up = flown.sitl.hardware.state().position;
    assert!((up.z - 1.5).abs() < 0.05 && (up.x - 1.0).abs() < 0.05, "{up}");
    // The camera answered TIMESYNC: the estimate is of where the vehicle is, not of where a pose was 20 ms ago.
    let health = flown.sitl.shared.report.get().unwrap().value.health;
    assert!(!health.faults.contain(EstimatorFault::NotStarted) && health.pose_age.unwrap() >= 20_000, "{health:?}");
    flown.command(MavCmd::MAV_CMD_NAV_LAND, 0.0);
    flown.pass(12.0);
    assert!(matches!(flown.mode(), Mode::Checks | Mode::Ready), "{:?}", flown.sitl.texts);
    // A touchdown ends where the vehicle was after the plant's step.
    let height = flown.sitl.hardware.state().position.z;
    assert!((-1e-3..=0.0).contains(&height), "{height}");
    assert_eq!(flown.sitl.summary(None).missed, 0);
}

#[test]
fn a_client_that_sends_the_poses_is_warned_that_their_delay_is_unknown() {
    let mut flown = Flown::boot_with(PoseSource::Link, STUDY, &[], None, None);
    flown.pass(5.0);
    assert_eq!(flown.mode(), Mode::Checks, "no camera of its own");
    flown.pass_with_poses(5.0);
    assert_eq!(flown.mode(), Mode::Ready, "{:?}", flown.sitl.texts);
    assert!(!flown.said("delay unknown"));
    flown.ask(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, [1.0, 0.0]);
    flown.pass_with_poses(0.5);
    assert!(flown.said("Poses: delay unknown; use TIMESYNC or POSE_DELAY"), "{:?}", flown.sitl.texts);
    flown.ask(MavCmd::MAV_CMD_NAV_TAKEOFF, [0.0, 0.0]);
    flown.pass_with_poses(14.5);
    assert_eq!(flown.mode(), Mode::Holding, "{:?}", flown.sitl.texts);
    // A camera that answers TIMESYNC says how late it is.
    assert!(!Flown::in_the_air(STUDY, &[]).said("delay unknown"));
}

#[test]
fn a_client_that_sends_the_poses_flies_lands_and_flies_again() {
    let mut flown = Flown::boot_with(PoseSource::Link, STUDY, &[], None, None);
    for flight in 1..=3 {
        flown.pass_with_poses(5.0);
        assert_eq!(flown.mode(), Mode::Ready, "before flight {flight}: {:?}", flown.sitl.texts);
        flown.ask(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, [1.0, 0.0]);
        flown.ask(MavCmd::MAV_CMD_NAV_TAKEOFF, [0.0, 0.0]);
        flown.pass_with_poses(8.0);
        flown.ask(MavCmd::MAV_CMD_NAV_LAND, [0.0, 0.0]);
        flown.pass_with_poses(9.0);
        assert!(!flown.mode().is_armed(), "after flight {flight}: {:?}", flown.sitl.texts);
        // While it stands each pose is the last one to the bit.
        assert!(!flown.said("frozen") && !flown.said("no believable pose"), "{:?}", flown.sitl.texts);
    }
}

#[test]
fn motors_stop_within_a_second_of_touchdown_wherever_poses_are_lost() {
    for lost in [14.0, 17.0, 20.5, 23.0] {
        let mut flown = Flown::boot(STUDY, &[&format!("pose@{lost}")], None);
        flown.pass(5.0);
        flown.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, 1.0);
        flown.command(MavCmd::MAV_CMD_NAV_TAKEOFF, 0.0);
        flown.pass(5.0);
        let mut touched = None;
        let mut stopped = None;
        while stopped.is_none() && flown.sitl.clock.now() < 60_000_000 {
            flown.pass(0.02);
            let now = flown.sitl.clock.now();
            if flown.sitl.hardware.state().position.z < 1e-3 {
                touched = touched.or(Some(now));
            }
            stopped = (!flown.mode().is_armed()).then_some(now);
        }
        let off = (stopped.unwrap() - touched.unwrap()) as f64 * 1e-6;
        println!("poses lost at {lost} s: motors off {off:.2} s after touchdown");
        assert!(off < 1.0, "{lost}: {off} s, {:?}", flown.sitl.texts);
    }
}

#[test]
fn faults_come_at_their_times_and_do_what_the_flight_rules_say() {
    for (fault, seconds, mode, text) in [
        ("pose@21..40", 3.0, Mode::Descending, "Pose lost"),
        ("gyro@22.5", 3.0, Mode::Stopped, "no IMU"),
        ("ground-station@21..40", 10.5, Mode::Landing, "Ground station still lost: landing"),
    ] {
        let mut flown = Flown::in_the_air(STUDY, &[fault]);
        assert!(!flown.said(text), "{fault}: too early");
        flown.pass(seconds);
        assert_eq!((flown.mode(), flown.said(text)), (mode, true), "{fault}: {:?}", flown.sitl.texts);
    }
}

#[test]
fn a_rotor_falls_short_of_its_thrust_while_its_fault_lasts() {
    let thrust = |flown: &Flown| flown.sitl.hardware.thrusts()[0];
    let mut flown = Flown::in_the_air(STUDY, &["rotor1=0.4@21..21.02", "rotor1@25"]);
    flown.pass(1.0);
    let hovering = thrust(&flown);
    // Too short to be found. With a lag of 30 ms its speed falls from 1 to 0.82.
    flown.pass(0.02);
    let share = thrust(&flown) / hovering;
    assert!((0.6..0.75).contains(&share), "{share}");
    flown.pass(2.5);
    let share = thrust(&flown) / hovering;
    assert!((0.95..1.05).contains(&share) && flown.mode() == Mode::Holding, "{share}, {:?}", flown.sitl.texts);
    flown.pass(1.68);
    let (share, all) = (thrust(&flown) / hovering, flown.sitl.hardware.thrusts().iter().sum::<f64>());
    assert!(share < 0.01 && all > hovering, "{share}, {all} N");
}

#[test]
fn the_batterys_voltage_is_the_vehicles_and_a_fault_overrules_it() {
    let battery = "\n[battery]\nfull_voltage = 12.6\nempty_voltage = 10.5\nresistance = 0.03\ncapacity = 2.2\n";
    let mut flown = Flown::in_the_air(&format!("{STUDY}{battery}"), &["battery=9.8@25"]);
    let volts = |flown: &Flown| flown.sitl.shared.voltage.get().unwrap().value;
    assert!((12.0..12.59).contains(&volts(&flown)), "{}", volts(&flown));
    flown.pass(5.5);
    assert_eq!(volts(&flown), 9.8);
    assert!(flown.sitl.status().ends_with("9.80 V"), "{}", flown.sitl.status());
}

#[test]
fn wind_blows_in_it() {
    let wind = "\n[wind]\nsteady = [4.0, 0.0, 0.0]\n";
    let mut still = Flown::in_the_air(STUDY, &[]);
    let mut windy = Flown::in_the_air(&format!("{STUDY}{wind}"), &[]);
    still.pass(3.0);
    windy.pass(3.0);
    let lean = |flown: &Flown| {
        let up = nalgebra::UnitQuaternion::new_normalize(flown.sitl.hardware.state().attitude) * nalgebra::Vector3::z();
        up.x
    };
    assert!(lean(&still).abs() < 0.01 && lean(&windy) < -0.02, "{} {}", lean(&still), lean(&windy));
}

/// Set down by setpoints while it leans into the wind: the legs it falls back onto turn it as its gyro feels, and its
/// poses go on being believed.
#[test]
fn set_down_at_a_lean_it_keeps_its_pose() {
    let mut flown = Flown::in_the_air(&format!("{STUDY}\n[wind]\nsteady = [6.0, 0.0, 0.0]\n"), &[]);
    let down = SET_POSITION_TARGET_LOCAL_NED_DATA {
        vz: 0.3,
        // Velocity alone.
        type_mask: PositionTargetTypemask::from_bits_retain(0b1101_1100_0111),
        coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
        target_system: 1,
        target_component: 1,
        ..SET_POSITION_TARGET_LOCAL_NED_DATA::DEFAULT
    };
    let tilt = |flown: &Flown| {
        let attitude = nalgebra::UnitQuaternion::new_normalize(flown.sitl.hardware.state().attitude);
        (attitude * nalgebra::Vector3::z()).z.clamp(-1.0, 1.0).acos().to_degrees()
    };
    let mut lean = 0.0;
    for sent in 0..240 {
        flown.send(&down);
        if sent == 10 {
            flown.ask(MavCmd::MAV_CMD_DO_SET_MODE, [1.0, 6.0]);
        }
        if flown.sitl.hardware.state().position.z > 0.05 {
            lean = tilt(&flown);
        }
        flown.pass(0.05);
    }
    assert!(lean > 10.0 && tilt(&flown) < 0.1, "{lean} and {} degrees", tilt(&flown));
    let health = flown.sitl.shared.report.get().unwrap().value.health;
    assert!(health.faults.worst().is_none() && health.pose_age.is_some_and(|age| age < 100_000), "{health:?}");
    // What the legs carry counts as thrust, and is reported; nothing else is.
    let texts = flown.sitl.texts.borrow();
    let other = texts.iter().rfind(|(_, text)| !text.starts_with("Thrust x1."));
    assert_eq!(other.unwrap().1, "Flying setpoints");
    assert_eq!(flown.mode(), Mode::Flying);
}

#[test]
fn what_no_board_could_fly_is_refused_by_name() {
    let session = SitlSession {
        file: "a file".to_owned(),
        ports: Ports { local: 0, ..Ports::default() },
        crtp: None,
        speed: 1.0,
        duration: None,
        poses: PoseSource::Camera,
        has_hands: false,
        faults: Vec::new(),
        parameters: None,
        signing_key: None,
        truth: None,
        recording: None,
        gyro: None,
    };
    let quiet = |_: &str| ();
    let refused = |text: &str| Sitl::boot(&Scenario::parse(text, "a test").unwrap(), &session, quiet).err().unwrap();
    assert!(refused(scenario::PAPER).starts_with("a file: rotors: missing"));
    let slow = STUDY.replace("lag = 0.030 ", "lag = 1.0 ");
    assert!(refused(&slow).contains("unstable"), "{}", refused(&slow));
    let coarse = STUDY.replace("step = 0.001", "step = 0.002");
    assert!(refused(&coarse).contains("plant.step"), "{}", refused(&coarse));
    let session = SitlSession { faults: vec!["rotor5@20".parse().unwrap()], ..session };
    let refused = Sitl::boot(&Scenario::parse(STUDY, "a test").unwrap(), &session, quiet).err().unwrap();
    assert_eq!(refused, "--fault: rotor5 is not there: the vehicle's are rotor1 to rotor4");
}

#[test]
fn a_recording_has_the_flight_tick_by_tick_and_every_word() {
    let path = std::env::temp_dir().join(format!("host-sim-session-{}.mcap", std::process::id()));
    let mut flown = Flown::boot(STUDY, &[], None);
    let mut record = SessionRecord::create(&path, &Scenario::parse(STUDY, "a test").unwrap(), STUDY).unwrap();
    assert!(!path.exists(), "it shows up when it is finished");
    let (mut ticks, mut words) = (0, 0);
    let mut watch = |flown: &mut Flown, seconds: u32| {
        for _ in 0..seconds * 100 {
            flown.pass(0.01);
            record.observe(&flown.sitl.moment()).unwrap();
            let said = flown.sitl.texts.take();
            said.iter().for_each(|(time, text)| record.observe_text(*time, text).unwrap());
            (ticks, words) = (ticks + 1, words + said.len());
        }
    };
    watch(&mut flown, 5);
    flown.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, 1.0);
    flown.command(MavCmd::MAV_CMD_NAV_TAKEOFF, 0.0);
    watch(&mut flown, 12);
    let height = flown.sitl.hardware.state().position.z;
    record.finish().unwrap();
    let bytes = std::fs::read(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    let mut last = std::collections::HashMap::new();
    let mut counts = std::collections::HashMap::<String, usize>::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        *counts.entry(message.channel.topic.clone()).or_default() += 1;
        let value = serde_json::from_slice::<serde_json::Value>(&message.data).unwrap();
        let schema = &message.channel.schema.as_ref().unwrap().data;
        let described = serde_json::from_slice::<serde_json::Value>(schema).unwrap();
        let known = |field| described["properties"].get(field).is_some();
        assert!(value.as_object().unwrap().keys().all(known), "{}", message.channel.topic);
        last.insert(message.channel.topic.clone(), value);
    }
    assert_eq!((counts["/vehicle"], counts["/state"], counts["/log"]), (ticks, ticks, words));
    assert_eq!(last["/vehicle"]["pose"]["position"]["z"].as_f64(), Some(height));
    assert_eq!(last["/state"]["mode"], Mode::Holding.text());
    // The law flies from the arming on, and knows where it is to be.
    assert!(counts["/law"] > 1_000 && counts["/law"] == counts["/reference"], "{counts:?}");
    assert!((last["/reference"]["pose"]["position"]["z"].as_f64().unwrap() - height).abs() < 0.05);
    assert!((last["/told"]["pose"]["position"]["z"].as_f64().unwrap() - height).abs() < 0.05);
}

use super::formats::Formats;
use super::reader::Ulog;
use super::topics::{TICK_TOPIC, written};
use super::writer::{Topic, Writer};
use super::{HEAD_BYTES, MAGIC};
use firmware::card::sector;
use firmware::hardware::MotorCommand;
use firmware::recorder::ring::{Ring, SLOT_BYTES};
use firmware::recorder::tick::{self, Tick};
use firmware::recorder::ulog;
use flight::Mode;
use nalgebra::{Quaternion, Vector3};

/// A message of this kind.
fn message(kind: u8, body: &[u8]) -> Vec<u8> {
    [&(body.len() as u16).to_le_bytes()[..], &[kind], body].concat()
}

/// A file of these messages.
fn file(messages: &[(u8, &[u8])]) -> Vec<u8> {
    let head = [&MAGIC[..], &[1], &7_u64.to_le_bytes()].concat();
    messages.iter().fold(head, |file, (kind, body)| [file, message(*kind, body)].concat())
}

/// The firmware's recording of two ticks.
fn recording() -> Vec<u8> {
    let mut memory = vec![[0; SLOT_BYTES]; 4];
    let mut ring = Ring::recover(&mut memory);
    ring.begin();
    for index in 0..2 {
        let state = controller_core::state::State {
            position: Vector3::new(1.0, 2.0, 3.0),
            velocity: Vector3::new(0.1, 0.2, 0.3),
            attitude: Quaternion::new(0.5, 0.5, -0.5, 0.5),
            angular_velocity: Vector3::new(-1.0, -2.0, -3.0),
        };
        let tick = Tick {
            time: 1_000_000 + 10_000 * index,
            mode: Mode::Holding,
            is_airborne: true,
            state: Some(state),
            reference: None,
            wrench: None,
            thrust_scale: None,
            pose_age: None,
            missed: 0,
            command: MotorCommand::Run([0.1, 0.2, 0.3, 0.4]),
            rotor_speeds: [Some(500.0), None, Some(600.0), Some(0.0)],
            voltage: Some(15.5),
        };
        ring.put(&tick.to_bytes());
    }
    let mut file = vec![0; 10_000];
    let length = ulog::read(&ring, "mine", 0, &mut file);
    file.truncate(length);
    file
}

#[test]
fn fields_are_found_behind_arrays_nested_messages_and_padding() {
    let nested = [&[0, 1, 0][..], b"outer"].concat();
    let body = [
        &[1, 0][..],
        &5_u64.to_le_bytes(),
        &[9; 3],
        &(-2_i16).to_le_bytes(),
        &1.5_f32.to_le_bytes(),
        &3_i16.to_le_bytes(),
    ];
    let file = file(&[
        (b'F', b"inner:int16_t a;float b;"),
        (b'F', b"outer:uint64_t timestamp;uint8_t[3] _padding0;inner[1] in;int16_t last;uint8_t[4] _padding1;"),
        (b'A', &nested),
        (b'D', &body.concat()),
        (b'Z', b"of a kind that is to come"),
    ]);
    let log = Ulog::read(&file, &["outer"]).unwrap();
    let rows = log.topic("outer").unwrap().columns(&["timestamp", "in[0].a", "in[0].b", "last"]);
    assert_eq!(rows, Some(vec![vec![5.0, -2.0, 1.5, 3.0]]));
    assert_eq!(log.topic("outer").unwrap().columns(&["in[0].c"]), None);
}

#[test]
fn a_message_that_does_not_fit_is_skipped_with_its_byte_and_none_panics() {
    let subscribed = [&[0, 1, 0][..], b"t"].concat();
    let format: (u8, &[u8]) = (b'F', b"t:uint64_t timestamp;");
    let subscription: (u8, &[u8]) = (b'A', &subscribed);
    for (messages, said) in [
        (vec![(b'A', &[][..])], "byte 16: a subscription is cut short"),
        (vec![(b'P', &[200, 1][..])], "byte 16: a key is cut short"),
        (vec![(b'P', b"\x07float A\x01")], "byte 16: the parameter A is not a number"),
        (vec![(b'F', b"nameless")], "byte 16: the format \"nameless\" has no name"),
        (vec![subscription], "byte 16: there is no format \"t\""),
        (vec![(b'F', b"t:t a;"), subscription], "byte 25: the format \"t\" holds itself"),
        (vec![(b'F', b"e:"), (b'F', b"t:e[9999999999] a;"), subscription], "byte 42: the format \"e\" is empty"),
        (vec![(b'F', b"t:float[99999] a;"), subscription], "byte 36: t: is longer than 65535 bytes"),
        (vec![(b'F', b"t:float[-1] a;"), subscription], "byte 33: t: the field \"float[-1] a\" has no length"),
        (vec![format, subscription, (b'D', &[1, 0, 5])], "byte 47: a record of t is cut short"),
        (vec![(0, &[5; 7])], "byte 16: a message of no kind"),
    ] {
        let log = Ulog::read(&file(&[&messages[..], &[(b'L', &[b'6'; 12])]].concat()), &["t"]).unwrap();
        assert_eq!((log.damage.places, log.texts.len()), (1, 1), "{said}");
        assert!(log.damage.first.starts_with(said), "{}", log.damage);
    }
    for (flags, said) in [(&[0; 3][..], "flags are cut short"), (&[2; 16], "is of a ULog that needs a newer reader")] {
        assert_eq!(Ulog::read(&file(&[(b'B', flags)]), &[]).unwrap_err(), said);
    }
    // Every prefix of a file, and every byte of it changed, is read or refused.
    let whole = recording();
    for end in 0..whole.len() {
        let _ = Ulog::read(&whole[..end], &[TICK_TOPIC]);
        let mut changed = whole.clone();
        changed[end] ^= 0xFF;
        let _ = Ulog::read(&changed, &[TICK_TOPIC]).map(|log| written(&log));
    }
    assert!(Ulog::read(&whole[..HEAD_BYTES - 1], &[TICK_TOPIC]).is_err());
    let cut = Ulog::read(&whole[..whole.len() - 1], &[TICK_TOPIC]).unwrap();
    assert_eq!((cut.topic(TICK_TOPIC).unwrap().len(), cut.damage.to_string()), (1, String::new()));
    assert!(Formats::default().fields("t").is_err());
}

/// A file of a hundred records of `t`, a and its square, with what is done to its bytes from the 50th record on.
fn damaged(damage: impl FnOnce(&mut Vec<u8>, usize)) -> Ulog {
    let topics = [Topic { name: "t", fields: "uint64_t timestamp;float a;float squared;" }];
    let mut writer = Writer::new(4, &topics, &[], &[]);
    let mut at = 0;
    for number in 0..100_u16 {
        if number == 50 {
            at = writer.clone().finish().len();
        }
        let a = f32::from(number);
        writer.record(0, 1000 * u64::from(number), &[a.to_le_bytes(), (a * a).to_le_bytes()].concat());
    }
    let mut bytes = writer.finish();
    damage(&mut bytes, at);
    let log = Ulog::read(&bytes, &["t"]).unwrap();
    let rows = log.topic("t").unwrap().columns(&["timestamp", "a", "squared"]).unwrap();
    assert!(rows.iter().all(|row| row[0] == 1000.0 * row[1] && row[2] == row[1] * row[1]), "{rows:?}");
    log
}

#[test]
fn one_damaged_message_costs_itself_alone_whatever_byte_of_it_is_damaged() {
    // Length, 2 bytes; kind; topic, 2 bytes; time, 8 bytes. What follows are numbers, any of which may be right, and so
    // may a time that is still between its neighbours'.
    const RECORD_BYTES: usize = 21;
    for byte in (0..5).chain(7..13) {
        for bit in 0..8 {
            let log = damaged(|bytes, at| bytes[at + byte] ^= 1 << bit);
            let rows = log.topic("t").unwrap().len();
            assert!(rows == 99, "byte {byte}, bit {bit}: {rows} rows, {:?}", log.damage);
            // A message of a kind that is to come is no damage.
            assert!(byte == 2 || log.damage.places == 1, "byte {byte}, bit {bit}: {:?}", log.damage);
        }
    }
    for (what, lost, log) in [
        ("bytes missing", 1, damaged(|bytes, at| drop(bytes.drain(at + 4..at + 9)))),
        ("bytes too many", 0, damaged(|bytes, at| drop(bytes.splice(at..at, [7; 40])))),
        ("a sector of zeros", 25, damaged(|bytes, at| bytes[at + 2..at + 514].fill(0))),
        ("a sector of ones", 25, damaged(|bytes, at| bytes[at + 2..at + 514].fill(0xFF))),
    ] {
        assert_eq!(log.topic("t").unwrap().len(), 100 - lost, "{what}: {:?}", log.damage);
        assert!(log.damage.places > 0 && log.damage.bytes <= 25 * RECORD_BYTES, "{what}: {:?}", log.damage);
    }
    let said = damaged(|bytes, at| bytes[at] = 0xFF).damage.to_string();
    assert_eq!(
        said,
        format!("; 1 damaged place of {RECORD_BYTES} bytes skipped: byte 1162: a message that ends where none begins")
    );
}

#[test]
fn a_card_whose_sectors_end_with_filler_is_read_whole() {
    let recording = recording();
    let last = &recording[recording.len() - ulog::DATA_HEAD.len() - tick::TICK_BYTES..];
    let mut sector = sector::BLANK_SECTOR;
    let (record, filler) = sector.split_at_mut(last.len());
    record.copy_from_slice(last);
    let head = ulog::head(sector::FILLER_KIND, filler.len() - sector::MESSAGE_HEAD_BYTES);
    filler[..sector::MESSAGE_HEAD_BYTES].copy_from_slice(&head);
    let card = [recording, sector.repeat(40), sector::BLANK_SECTOR.repeat(20)].concat();
    let read = Ulog::read(&card, &[TICK_TOPIC]).unwrap();
    assert_eq!(read.damage.to_string(), "");
    assert_eq!(read.topic(TICK_TOPIC).unwrap().len(), 2 + 40);
}

#[test]
fn what_was_written_is_read() {
    let topics = [Topic { name: "t", fields: "uint64_t timestamp;float a;" }];
    let mut writer = Writer::new(4, &topics, &[("sys_name", "here")], &[("GAIN", 1.25)]);
    writer.text(b'6', 5, "words");
    writer.record(0, 6, &2.5_f32.to_le_bytes());
    let log = Ulog::read(&writer.finish(), &["t"]).unwrap();
    assert_eq!((log.start, log.information["sys_name"].as_str(), log.parameters["GAIN"]), (4, "here", 1.25));
    assert_eq!((log.texts[0].level, log.texts[0].time, log.texts[0].words.as_str()), (b'6', 5, "words"));
    assert_eq!(log.topic("t").unwrap().columns(&["timestamp", "a"]), Some(vec![vec![6.0, 2.5]]));
}

#[test]
fn ticks_become_px4s_topics_in_px4s_frames() {
    let log = Ulog::read(&recording(), &[TICK_TOPIC]).unwrap();
    let file = written(&log).unwrap();
    let asked = [
        "vehicle_attitude",
        "vehicle_angular_velocity",
        "vehicle_local_position",
        "actuator_motors",
        "esc_status",
        "battery_status",
        "vehicle_status",
        "vehicle_land_detected",
    ];
    let px4 = Ulog::read(&file, &asked).unwrap();
    let first = |topic: &str, names: &[&str]| px4.topic(topic).unwrap().columns(names).unwrap()[0].clone();
    assert_eq!(first("vehicle_attitude", &["timestamp", "q[0]", "q[1]", "q[2]", "q[3]"]), [1e6, 0.5, 0.5, 0.5, -0.5]);
    assert_eq!(first("vehicle_angular_velocity", &["xyz[0]", "xyz[1]", "xyz[2]"]), [-1.0, 2.0, 3.0]);
    assert_eq!(first("vehicle_local_position", &["x", "y", "z", "xy_valid"]), [1.0, -2.0, -3.0, 1.0]);
    assert!((first("actuator_motors", &["control[3]"])[0] - 0.4).abs() < 1e-6);
    let of_motors = ["esc[0].esc_rpm", "esc[1].esc_rpm", "esc_count", "esc_online_flags", "esc_armed_flags"];
    assert_eq!(first("esc_status", &of_motors), [4775.0, 0.0, 4.0, 13.0, 15.0]);
    assert_eq!(first("battery_status", &["voltage_v"]), [15.5]);
    // AUTO_LOITER, armed, in the air.
    assert_eq!(first("vehicle_status", &["nav_state", "arming_state"]), [4.0, 2.0]);
    assert_eq!(first("vehicle_land_detected", &["landed"]), [0.0]);
    assert_eq!(px4.information, log.information);
    let foreign = Ulog::read(&file, &[TICK_TOPIC]).unwrap();
    assert!(written(&foreign).unwrap_err().contains("holds no record of a tick"));
}

use super::*;

const VIEW: View =
    View { report: None, imu: None, voltage: Some(12.345), rotor_speeds: None, supervisor: 0x8001, battery_low: 13.0 };

fn place(group: &str, name: &str) -> u16 {
    VARIABLES.iter().position(|variable| (variable.group, variable.name) == (group, name)).unwrap() as u16
}

/// Sends a command; its error.
fn control(log: &mut Log, data: &[u8], now: u64) -> u8 {
    let answer = log.control(&Packet::new(ports::LOG, CONTROL).with(data), now).unwrap();
    assert_eq!((answer.port, answer.channel, &answer.data()[..2]), (ports::LOG, CONTROL, &data[..2]));
    answer.data()[2]
}

fn entry(kind: Kind, group: &str, name: &str) -> [u8; 3] {
    let [low, high] = place(group, name).to_le_bytes();
    [kind as u8, low, high]
}

#[test]
fn a_block_goes_out_at_its_period_with_the_values_of_then() {
    let mut log = Log::new();
    let voltage = entry(Kind::Float, "pm", "vbat");
    let thousandths = entry(Kind::U16, "pm", "vbatMV");
    assert_eq!(control(&mut log, &[&[6, 9], &voltage[..]].concat(), 0), 0);
    assert_eq!(control(&mut log, &[&[7, 9], &thousandths[..]].concat(), 0), 0);
    assert_eq!(control(&mut log, &[3, 9, 2], 5_000), 0);
    assert_eq!((log.due(), log.next(24_999, &VIEW)), (25_000, None));
    let packet = log.next(0x0203_0405 * 1_000, &VIEW).unwrap();
    let expected = [&[9, 5, 4, 3][..], &12.345_f32.to_le_bytes(), &12_345_u16.to_le_bytes()].concat();
    assert_eq!((packet.channel, packet.data()), (DATA, &expected[..]));
    // What is late is not made up for.
    assert_eq!(log.due(), 0x0203_0405 * 1_000 + 20_000);
    assert_eq!(control(&mut log, &[4, 9], 0), 0);
    assert_eq!(log.due(), u64::MAX);
}

#[test]
fn a_period_of_nothing_is_once_and_the_shortest_is_a_tick() {
    let mut log = Log::new();
    control(&mut log, &[6, 1], 0);
    assert_eq!(control(&mut log, &[8, 1, 0, 0], 70), 0);
    assert_eq!(log.next(70, &VIEW).unwrap().data(), [1, 0, 0, 0]);
    assert_eq!(log.due(), u64::MAX);
    control(&mut log, &[8, 1, 1, 0], 100);
    assert_eq!(log.due(), 10_100);
}

#[test]
fn blocks_take_turns() {
    let mut log = Log::new();
    for number in [1, 2] {
        control(&mut log, &[6, number], 0);
        control(&mut log, &[3, number, 1], 0);
    }
    let numbers: std::vec::Vec<u8> =
        (0..4).map(|turn| log.next(10_000 * (1 + turn / 2), &VIEW).unwrap().data()[0]).collect();
    assert_eq!(numbers, [1, 2, 1, 2]);
}

#[test]
fn what_cannot_be_is_refused_and_leaves_all_as_it_was() {
    let mut log = Log::new();
    let float = entry(Kind::Float, "pm", "vbat");
    assert_eq!(control(&mut log, &[&[7, 3], &float[..]].concat(), 0), NOT_THERE);
    assert_eq!(control(&mut log, &[3, 3, 1], 0), NOT_THERE);
    assert_eq!(control(&mut log, &[2, 3], 0), NOT_THERE);
    assert_eq!(control(&mut log, &[99, 3], 0), UNKNOWN_COMMAND);
    assert_eq!(control(&mut log, &[3, 3], 0), UNKNOWN_COMMAND);
    // Six floats are 24 bytes, the seventh is too much; a variable that is not there; a kind that is none.
    let seven: std::vec::Vec<u8> = [&[6, 3][..], &float.repeat(7)].concat();
    assert_eq!(control(&mut log, &seven, 0), TOO_LARGE);
    assert_eq!(control(&mut log, &[6, 3, 7, 0xFF, 0xFF], 0), NOT_THERE);
    assert_eq!(control(&mut log, &[6, 3, 9, 0, 0], 0), NOT_THERE);
    assert_eq!(log.entries.len() + log.blocks.len(), 0);
    assert_eq!(control(&mut log, &[&[6, 3], &float[..]].concat(), 0), 0);
    assert_eq!(control(&mut log, &[&[6, 3], &float[..]].concat(), 0), ALREADY_THERE);
    assert_eq!(control(&mut log, &[5, 0], 0), 0);
    assert_eq!(log.entries.len() + log.blocks.len(), 0);
}

#[test]
fn there_is_room_for_so_many_and_no_more() {
    let mut log = Log::new();
    let byte = entry(Kind::U8, "supervisor", "info");
    for number in 0..16 {
        assert_eq!(control(&mut log, &[&[6, number], &byte.repeat(8)[..]].concat(), 0), 0, "{number}");
    }
    assert_eq!(control(&mut log, &[6, 16], 0), TOO_MANY);
    assert_eq!(control(&mut log, &[&[7, 0], &byte[..]].concat(), 0), TOO_MANY);
    assert_eq!(control(&mut log, &[2, 0], 0), 0);
    assert_eq!(control(&mut log, &[&[6, 16], &byte[..]].concat(), 0), 0);
}

#[test]
fn kinds_convert_and_cut_what_does_not_fit() {
    let written = |kind: Kind, value| kind.write(Packet::new(5, 2), value).data().to_vec();
    for (kind, value, bytes) in [
        (Kind::U8, 300.0, vec![255]),
        (Kind::U8, -4.0, vec![0]),
        (Kind::I8, -200.0, vec![0x80]),
        (Kind::U16, f64::NAN, vec![0, 0]),
        (Kind::I16, -2.0, vec![0xFE, 0xFF]),
        (Kind::U32, 4_294_967_295.0, vec![0xFF; 4]),
        (Kind::I32, -1.0, vec![0xFF; 4]),
        (Kind::Half, 1.5, vec![0x00, 0x3E]),
        (Kind::Float, -0.5, vec![0, 0, 0, 0xBF]),
    ] {
        assert_eq!(written(kind, value), bytes, "{kind:?} {value}");
    }
}

#[test]
fn names_fit_a_packet_and_no_two_are_the_same() {
    for (index, variable) in VARIABLES.iter().enumerate() {
        assert!(variable.group.len() + variable.name.len() <= 24, "{}.{}", variable.group, variable.name);
        assert_eq!(usize::from(place(variable.group, variable.name)), index);
    }
}

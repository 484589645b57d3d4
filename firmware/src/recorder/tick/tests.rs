use super::*;

/// Bytes of ULog's basic types.
fn size(kind: &str) -> usize {
    match kind {
        "uint64_t" => 8,
        "float" => 4,
        "uint16_t" => 2,
        "uint8_t" => 1,
        _ => panic!("{kind}"),
    }
}

/// Bytes and names of the format's fields.
fn fields() -> Vec<(usize, usize, &'static str)> {
    let (_, fields) = FORMAT.split_once(':').unwrap();
    let fields = fields.trim_end_matches(';').split(';').map(|field| {
        let (kind, name) = field.split_once(' ').unwrap();
        match kind.split_once('[') {
            Some((kind, count)) => (size(kind), count.trim_end_matches(']').parse().unwrap(), name),
            None => (size(kind), 1, name),
        }
    });
    fields.collect()
}

#[test]
fn the_format_is_as_long_as_a_record_and_has_no_gaps() {
    assert_eq!(fields().iter().map(|(size, count, _)| size * count).sum::<usize>(), TICK_BYTES);
    assert!(fields().is_sorted_by(|a, b| a.0 >= b.0));
    assert_eq!(MotorCommand::One { motor: 2, level: 0.5 }.levels(), [0.0, 0.0, 0.5, 0.0]);
}

#[test]
fn unknown_values_are_nan_and_all_of_a_record_is_written() {
    let tick = Tick {
        time: 7,
        mode: Mode::Locked,
        is_airborne: true,
        state: None,
        reference: None,
        wrench: None,
        thrust_scale: None,
        pose_age: None,
        missed: 0,
        command: MotorCommand::Run([0.1, 0.2, 0.3, 0.4]),
        rotor_speeds: [Some(500.0), None, Some(600.0), Some(0.0)],
        voltage: None,
    };
    let bytes = tick.to_bytes();
    let mut at = 0;
    for (size, count, name) in fields() {
        let field = &bytes[at..at + size * count];
        at += size * count;
        let floats: Vec<f32> = field.chunks(4).filter_map(|x| Some(f32::from_le_bytes(x.try_into().ok()?))).collect();
        match name {
            "timestamp" => assert_eq!(field, [7, 0, 0, 0, 0, 0, 0, 0]),
            "motors" => assert_eq!(floats, [0.1, 0.2, 0.3, 0.4]),
            "rotor_speeds" => assert!(floats[0] == 500.0 && floats[1].is_nan() && floats[3] == 0.0, "{floats:?}"),
            "missed_ticks" => assert_eq!(field, [0, 0]),
            "mode" => assert_eq!(field, [Mode::Locked as u8]),
            "airborne" => assert_eq!(field, [1]),
            _ => assert!(floats.len() == count && floats.iter().all(|x| x.is_nan()), "{name}: {floats:?}"),
        }
    }
}

use super::*;
use crate::crtp::errors;

fn polynomial_piece(coefficients: [[f32; 2]; 4], duration: f32) -> Vec<u8> {
    let mut bytes = Vec::new();
    for [zeroth, first] in coefficients {
        let all = [zeroth, first, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        bytes.extend(all.iter().flat_map(|coefficient| coefficient.to_le_bytes()));
    }
    bytes.extend(duration.to_le_bytes());
    bytes
}

fn with(address: usize, bytes: &[u8]) -> Pieces<'static> {
    let mut pieces = Pieces::new(Box::leak(Box::new([0; MEMORY_BYTES])));
    assert!(bytes.chunks(24).enumerate().all(|(chunk, bytes)| pieces.write(address + 24 * chunk, bytes)));
    pieces
}

#[test]
fn polynomials_are_flown_one_after_the_other_and_not_beyond_the_last() {
    let first = polynomial_piece([[0.0, 1.0], [2.0, 0.0], [1.0, 0.0], [0.0, 0.1]], 2.0);
    let second = polynomial_piece([[2.0, 0.0], [2.0, 3.0], [1.0, 0.0], [0.2, 0.0]], 1.0);
    let mut pieces = with(100, &[first, second].concat());
    assert_eq!(pieces.define(3, 0, 100, 2), Ok(()));
    let (definition, length) = pieces.defined(3).unwrap();
    assert_eq!(length, 3.0);
    let place = |time| pieces.at(&definition, time).unwrap().position();
    assert_eq!(place(0.5).as_slice(), [0.5, 2.0, 1.0]);
    assert_eq!(place(2.5).as_slice(), [2.0, 3.5, 1.0]);
    assert_eq!((place(9.0), place(-1.0).x), (place(3.0), 0.0));
}

/// De Casteljau's construction.
fn construct(points: &[f64], share: f64) -> f64 {
    match points {
        [point] => *point,
        _ => {
            let next: Vec<f64> = points.windows(2).map(|two| two[0] + (two[1] - two[0]) * share).collect();
            construct(&next, share)
        }
    }
}

#[test]
fn curves_are_those_of_their_control_points() {
    let start = [100_i16, -200, 1000, 900];
    let (seven, three, one) = ([150_i16, 260, 10, -90, 400, 500, 600], [-300_i16, 50, 70], [1500_i16]);
    let mut bytes: Vec<u8> = start.iter().flat_map(|number| number.to_le_bytes()).collect();
    // x of seventh degree, y of third, z straight, yaw as it is; then x stays and yaw turns.
    bytes.push(0b00_01_10_11);
    bytes.extend(2_500_u16.to_le_bytes());
    bytes.extend(seven.iter().chain(&three).chain(&one).flat_map(|number| number.to_le_bytes()));
    bytes.push(0b01_00_00_00);
    bytes.extend(1_000_u16.to_le_bytes());
    bytes.extend(1_800_i16.to_le_bytes());
    let mut pieces = with(0, &bytes);
    pieces.define(0, 1, 0, 2).unwrap();
    let (definition, length) = pieces.defined(0).unwrap();
    assert!((length - 3.5).abs() < 1e-6);
    let expected = |begin: i16, points: &[i16], share| {
        let all: Vec<f64> = [&[begin], points].concat().iter().map(|number| f64::from(*number) * 1e-3).collect();
        construct(&all, share)
    };
    for time in [0.0, 0.4, 1.3, 2.5] {
        let [x, y, z] = pieces.at(&definition, time).unwrap().axes;
        let share = f64::from(time) / 2.5;
        for (axis, value) in
            [(x, expected(100, &seven, share)), (y, expected(-200, &three, share)), (z, expected(1000, &one, share))]
        {
            assert!((f64::from(axis.value) - value).abs() < 1e-5, "{time}: {axis:?} {value}");
        }
    }
    let last = pieces.at(&definition, 3.0).unwrap();
    assert_eq!(last.axes.map(|axis| axis.rate), [0.0; 3]);
    assert!((last.position().x - 0.6).abs() < 1e-6 && (last.yaw.value - 135_f32.to_radians()).abs() < 1e-5);
}

#[test]
fn what_is_not_there_or_cannot_be_flown_is_not_defined() {
    let good = polynomial_piece([[0.0; 2]; 4], 1.0);
    let mut pieces = with(0, &good);
    for (number, kind, offset, count, error) in [
        (10, 0, 0, 1, errors::NOT_THERE),
        (0, 2, 0, 1, errors::UNKNOWN_COMMAND),
        (0, 0, 0, 0, errors::INVALID),
        (0, 0, 0, 2, errors::INVALID),
        (0, 0, 4096, 1, errors::INVALID),
        (0, 0, u32::MAX, 1, errors::INVALID),
        (0, 0, 3970, 1, errors::INVALID),
        (0, 1, 4090, 1, errors::INVALID),
    ] {
        assert_eq!(pieces.define(number, kind, offset, count), Err(error), "{number} {kind} {offset} {count}");
    }
    for spoiled in [[[f32::NAN, 0.0]; 4], [[0.0, f32::INFINITY]; 4]] {
        assert!(pieces.write(0, &polynomial_piece(spoiled, 1.0)));
        assert_eq!(pieces.define(0, 0, 0, 1), Err(errors::INVALID));
    }
    for duration in [-1.0, f32::NAN, f32::INFINITY, 3_601.0] {
        assert!(pieces.write(0, &polynomial_piece([[0.0; 2]; 4], duration)));
        assert_eq!(pieces.define(0, 0, 0, 1), Err(errors::INVALID), "{duration}");
    }
    assert_eq!(pieces.defined(0), None);
}

#[test]
fn a_trajectory_whose_pieces_were_spoiled_since_is_none() {
    let mut pieces = with(0, &polynomial_piece([[0.0; 2]; 4], 1.0));
    pieces.define(0, 0, 0, 1).unwrap();
    assert!(pieces.write(128, &[0; 4]));
    assert_eq!(pieces.defined(0), None);
}

#[test]
fn memory_is_written_whole_or_not_at_all() {
    let mut pieces = with(0, &[7; 24]);
    assert!(!pieces.write(MEMORY_BYTES - 2, &[1; 3]) && !pieces.write(usize::MAX, &[1]));
    assert_eq!(pieces.read(MEMORY_BYTES - 2, 2), Some(&[0; 2][..]));
    assert_eq!(pieces.read(20, 8), Some(&[7, 7, 7, 7, 0, 0, 0, 0][..]));
    assert_eq!((pieces.read(MEMORY_BYTES, 1), pieces.read(usize::MAX, 2)), (None, None));
}

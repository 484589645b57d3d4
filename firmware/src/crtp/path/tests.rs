use super::*;
use std::f32::consts::FRAC_PI_2;

/// One piece: along x at 1 m/s for 2 s, from (1, 2, 3), the yaw turning from 0.4 rad at 0.1 rad/s.
fn uploaded() -> Pieces<'static> {
    let mut pieces = Pieces::new(Box::leak(Box::new([0; 256])));
    let mut bytes = Vec::new();
    for [zeroth, first] in [[1.0_f32, 1.0], [2.0, 0.0], [3.0, 0.0], [0.4, 0.1]] {
        let all = [zeroth, first, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        bytes.extend(all.iter().flat_map(|coefficient| coefficient.to_le_bytes()));
    }
    bytes.extend(2.0_f32.to_le_bytes());
    assert!(pieces.write(0, &bytes));
    pieces.define(0, 0, 0, 1).unwrap();
    pieces
}

fn along(pieces: &Pieces<'_>) -> Along {
    let (definition, length) = pieces.defined(0).unwrap();
    Along { definition, length, timescale: 1.0, is_reversed: false, shift: Vector3::zeros(), turn: 0.0 }
}

#[test]
fn pieces_are_flown_slower_and_backwards() {
    let pieces = uploaded();
    let path = Path::Pieces(Along { timescale: 2.0, is_reversed: true, ..along(&pieces) });
    assert_eq!(path.duration(), Some(4.0));
    let at = path.at(1.0, &pieces).unwrap();
    assert_eq!(at.position(), Vector3::new(2.5, 2.0, 3.0));
    assert_eq!((at.axes[0].rate, at.yaw.rate), (-0.5, -0.05));
    assert_eq!(path.at(9.0, &pieces).unwrap().position().x, 1.0);
}

#[test]
fn pieces_are_turned_about_their_frame_and_then_shifted() {
    let pieces = uploaded();
    let shift = Vector3::new(10.0, 0.0, -1.0);
    let at = Path::Pieces(Along { turn: FRAC_PI_2, shift, ..along(&pieces) }).at(1.0, &pieces).unwrap();
    assert!((at.position() - Vector3::new(8.0, 2.0, 2.0)).norm() < 0.02, "{:?}", at.position());
    let [x, y, z] = at.axes.map(|axis| axis.rate);
    assert!(x.abs() < 5e-3 && (y - 1.0).abs() < 5e-3 && z == 0.0);
    assert!((at.yaw.value - 0.5 - FRAC_PI_2).abs() < 1e-6);
}

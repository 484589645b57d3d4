use super::*;

#[test]
fn every_tick_brings_the_rotors_as_much_nearer_to_the_laws_thrusts() {
    let least = Thrusts::from_slice(&[0.5, 1.0]).unwrap();
    let wanted = Thrusts::from_slice(&[2.5, 0.0]).unwrap();
    let mut spool = Spool::new(least);
    for _ in 0..2 {
        for tick in 1..=SPOOL_TICKS {
            assert!(!spool.is_over());
            let part = tick as f32 / 100.0;
            let given = spool.advance(wanted.clone());
            let expected = [0.5 + 2.0 * part, 1.0 - part];
            assert!(given.iter().zip(expected).all(|(given, expected)| (given - expected).abs() < 1e-6), "{tick}");
        }
        assert!(spool.is_over());
        assert_eq!(spool.advance(wanted.clone()), wanted);
        spool.restart();
    }
}

use super::*;

#[test]
fn at_any_rate_a_second_brings_the_rotors_evenly_to_the_laws_thrusts() {
    let least = Thrusts::from_slice(&[0.5, 1.0]).unwrap();
    let wanted = Thrusts::from_slice(&[2.5, 0.0]).unwrap();
    for rate in [50, 100, 500, 1_000] {
        let mut spool = Spool::new(least.clone(), 1_000_000 / rate);
        // What has flown before does not count.
        spool.advance(wanted.clone());
        spool.restart();
        for tick in 1..=rate {
            assert!(!spool.is_over());
            let part = tick as f32 / rate as f32;
            let given = spool.advance(wanted.clone());
            let expected = [0.5 + 2.0 * part, 1.0 - part];
            assert!(
                given.iter().zip(expected).all(|(given, expected)| (given - expected).abs() < 1e-6),
                "{rate} Hz, {tick}"
            );
        }
        assert!(spool.is_over());
        assert_eq!(spool.advance(wanted.clone()), wanted);
    }
}

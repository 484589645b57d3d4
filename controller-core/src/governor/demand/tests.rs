use super::*;

/// The squares of the shares of a motion `f` times too fast by one of its derivatives, a tick of 0.01 s.
fn asked(demand: &StreamDemand, derivative: i32, f: f32) -> StreamDemand {
    let mut squares = [0.01; 4];
    squares[derivative as usize - 1] = f.powi(2 * derivative);
    let [speed, acceleration, jerk, snap] = squares;
    demand.with(speed, [acceleration, jerk, snap], 0.1, 0.01)
}

#[test]
fn the_factor_is_that_of_the_derivative_that_asks_most() {
    for derivative in 1..=4 {
        for f in [0.8, 1.0, 1.4, 3.0, 15.0] {
            let found = asked(&StreamDemand::NONE, derivative, f).following().unwrap().slower();
            assert!((found / f - 1.0).abs() < 1e-5, "derivative {derivative}: {found} for {f}");
        }
        let max = asked(&StreamDemand::NONE, derivative, 1e4).following().unwrap().slower();
        assert!((max / 16.0 - 1.0).abs() < 1e-5, "{max}");
    }
    assert_eq!(StreamDemand::NONE.following(), None);
}

#[test]
fn what_was_asked_counts_for_ten_seconds_and_for_no_more_than_twenty() {
    let mut demand = asked(&StreamDemand::NONE, 2, 2.0);
    let mut slower = || {
        demand = asked(&demand, 2, 1.1);
        demand.following().unwrap().slower()
    };
    assert!((0..1_000).all(|_| (slower() - 2.0).abs() < 1e-4));
    let last = (0..1_100).map(|_| slower()).last().unwrap();
    assert!((last - 1.1).abs() < 1e-4, "{last}");
}

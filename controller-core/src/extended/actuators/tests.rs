use super::*;

/// The model against its differential equation in small steps.
#[test]
fn end_and_mean_are_those_of_the_lag_whatever_the_delay() {
    let period = 0.01;
    for (lag, delay) in [(0.0, 0.0), (0.005, 0.0), (0.03, 0.01), (0.03, 0.013), (0.001, 0.0275), (0.0, 0.004)] {
        let model = ActuatorModel::new(&ActuatorParameters { lag, delay }, period).unwrap();
        let mut state = ActuatorState::steady(Vector4::zeros());
        let (mut x, mut history) = (0.0_f64, [0.0_f64; 8]);
        let steps = 20_000;
        let step = f64::from(period) / f64::from(steps);
        for tick in 0..30 {
            let sent = f64::from((tick * 37 % 11) as f32 - 5.0);
            history.rotate_right(1);
            history[0] = sent;
            state.command(Vector4::repeat(sent as f32));
            let mean = model.advance(&mut state);
            let mut sum = 0.0;
            for i in 0..steps {
                let age = f64::from(delay) - (f64::from(i) + 0.5) * step;
                let late = (age / f64::from(period)).ceil().max(0.0) as usize;
                let before = x;
                x = if lag > 0.0 {
                    history[late] + (x - history[late]) * (-step / f64::from(lag)).exp()
                } else {
                    history[late]
                };
                sum += if lag > 0.0 { 0.5 * (before + x) } else { x };
            }
            assert!((f64::from(mean.x) - sum / f64::from(steps)).abs() < 2e-3, "{lag} {delay} {tick}: {mean}");
            assert!((f64::from(state.acting.x) - x).abs() < 2e-3, "{lag} {delay} {tick}: {}", state.acting);
        }
    }
}

#[test]
fn delays_and_lags_beyond_the_model_are_refused_by_name() {
    let field = |lag, delay| ActuatorModel::new(&ActuatorParameters { lag, delay }, 0.01).unwrap_err().field;
    assert_eq!(field(-0.001, 0.0), "rotors.lag");
    assert_eq!(field(f32::INFINITY, 0.0), "rotors.lag");
    assert_eq!(field(0.0, f32::NAN), "sampling.delay");
    assert_eq!(field(0.0, 0.301), "sampling.delay");
    // Thirty periods are not beyond it, whatever rounding makes of them.
    for period_us in 1_u32..=100_000 {
        let period = f64::from(period_us) * 1e-6;
        let parameters = ActuatorParameters { lag: 0.0, delay: (30.0 * period) as f32 };
        assert_eq!(ActuatorModel::new(&parameters, period as f32).unwrap().whole_delay, 30, "{period_us} us");
    }
}

use super::super::history::Increment;
use super::super::nominal::{self, Nominal};
use super::*;
use nalgebra::{Quaternion, SMatrix, SVector, UnitQuaternion};

type Full = SMatrix<f64, 15, 15>;

impl Covariance {
    /// All of P.
    pub(in crate::estimator) fn full(&self) -> Full {
        let rows = [
            [self.pp, self.pv, self.pt, self.pg, self.pa],
            [self.pv.transpose(), self.vv, self.vt, self.vg, self.va],
            [self.pt.transpose(), self.vt.transpose(), self.tt, self.tg, self.ta],
            [self.pg.transpose(), self.vg.transpose(), self.tg.transpose(), self.gg, self.ga],
            [self.pa.transpose(), self.va.transpose(), self.ta.transpose(), self.ga.transpose(), self.aa],
        ];
        Full::from_fn(|i, j| f64::from(rows[i / 3][j / 3][(i % 3, j % 3)]))
    }

    /// From all of P.
    fn from_full(full: &Full) -> Self {
        let block = |i: usize, j: usize| full.fixed_view::<3, 3>(3 * i, 3 * j).map(|x| x as f32);
        Self {
            pp: block(0, 0),
            pv: block(0, 1),
            pt: block(0, 2),
            pg: block(0, 3),
            pa: block(0, 4),
            vv: block(1, 1),
            vt: block(1, 2),
            vg: block(1, 3),
            va: block(1, 4),
            tt: block(2, 2),
            tg: block(2, 3),
            ta: block(2, 4),
            gg: block(3, 3),
            ga: block(3, 4),
            aa: block(4, 4),
        }
    }
}

const SILENT: EstimatorParameters = EstimatorParameters {
    gyro_noise: 0.0,
    accelerometer_noise: 0.0,
    gyro_walk: 0.0,
    accelerometer_walk: 0.0,
    ..EstimatorParameters::BMI088
};

/// A state as it may be: upside down, fast, biased.
fn somewhere() -> Nominal {
    Nominal {
        position: Vector3::new(1.0, -2.0, 3.0),
        velocity: Vector3::new(4.0, -1.0, -2.0),
        attitude: Quaternion::new(0.1_f32, 0.9, -0.3, 0.2).normalize(),
        gyro_bias: Vector3::new(0.01, -0.02, 0.005),
        accelerometer_bias: Vector3::new(0.2, -0.1, 0.15),
    }
}

fn increment() -> Increment {
    Increment::steady(0, 5_000, &Vector3::new(4.0, -3.0, 2.0), &Vector3::new(1.0, -2.0, 15.0))
}

/// The nominal motion in double precision, on `nominal` displaced by `error`.
fn moved(nominal: &Nominal, error: &SVector<f64, 15>, increment: &Increment) -> ([f64; 6], UnitQuaternion<f64>) {
    let part = |i: usize| error.fixed_rows::<3>(3 * i).into_owned();
    let attitude = UnitQuaternion::new_normalize(nominal.attitude.cast::<f64>());
    let attitude = UnitQuaternion::from_scaled_axis(part(2)) * attitude;
    let (p, v) = (nominal.position.cast::<f64>() + part(0), nominal.velocity.cast::<f64>() + part(1));
    let (b_g, b_a) = (nominal.gyro_bias.cast::<f64>() + part(3), nominal.accelerometer_bias.cast::<f64>() + part(4));
    let h = f64::from(increment.seconds());
    // The continuous motion under a steady rate and force, in small steps.
    let rate = increment.delta_angle.cast::<f64>() / h - b_g;
    let bent = increment.delta_angle.cross(&increment.delta_velocity).cast::<f64>() * 0.5;
    let force = (increment.delta_velocity.cast::<f64>() - bent) / h - b_a;
    let (mut p, mut v, steps) = (p, v, 2_000);
    let step = h / f64::from(steps);
    for n in 0..steps {
        let turned = attitude * UnitQuaternion::from_scaled_axis(rate * (step * (f64::from(n) + 0.5)));
        let a = turned * force - Vector3::z() * 9.81;
        p += v * step + a * (0.5 * step * step);
        v += a * step;
    }
    ([p.x, p.y, p.z, v.x, v.y, v.z], attitude * UnitQuaternion::from_scaled_axis(rate * h))
}

/// d(error after) / d(error before), by central differences of the continuous motion in double precision.
fn transition(nominal: &Nominal, increment: &Increment) -> Full {
    let mut f = Full::identity();
    for column in 0..15 {
        let mut error = SVector::<f64, 15>::zeros();
        error[column] = 1e-6;
        let ((plus, q_plus), (minus, q_minus)) =
            (moved(nominal, &error, increment), moved(nominal, &-error, increment));
        for row in 0..6 {
            f[(row, column)] = (plus[row] - minus[row]) / 2e-6;
        }
        let turned = (q_plus * q_minus.inverse()).scaled_axis() / 2e-6;
        f.fixed_view_mut::<3, 1>(6, column).copy_from(&turned);
    }
    f
}

/// Some covariance with everything correlated, of plausible size.
fn correlated() -> Full {
    let scales = [0.01, 0.05, 0.02, 0.003, 0.1];
    let root = Full::from_fn(|i, j| scales[i / 3] * ((i * 7 + j * 13 + i * j) as f64).sin());
    root * root.transpose() + Full::from_fn(|i, j| if i == j { 0.1 * scales[i / 3] * scales[i / 3] } else { 0.0 })
}

/// The greatest entry of `a` - `b`, each divided by the deviations of its row and column in `b`.
fn apart(a: &Full, b: &Full) -> f64 {
    let scaled = |i: usize, j: usize| (a[(i, j)] - b[(i, j)]).abs() / (b[(i, i)] * b[(j, j)]).sqrt();
    (0..225).map(|n| scaled(n / 15, n % 15)).fold(0.0, f64::max)
}

#[test]
fn the_covariance_propagates_as_differences_of_the_motion_do() {
    let (nominal, increment) = (somewhere(), increment());
    let f = transition(&nominal, &increment);
    let before = correlated();
    let mut covariance = Covariance::from_full(&before);
    let motion = nominal.clone().advance(&increment, 9.81);
    covariance.advance(&motion, &SILENT);
    let expected = f * before * f.transpose();
    let error = apart(&covariance.full(), &expected);
    assert!(error < 2e-5, "{error}");
    // An entry of the transition that is missing would show: the increment changes the covariance by far more.
    assert!(apart(&before, &expected) > 100.0 * error);
}

#[test]
fn noise_adds_its_density_times_the_time() {
    let mut covariance = Covariance::diagonal([0.0; 5]);
    let motion = Nominal { velocity: Vector3::zeros(), ..somewhere() }.advance(&increment(), 9.81);
    (0..200).for_each(|_| covariance.advance(&motion, &EstimatorParameters::BMI088));
    // After 1 s; the accelerometer's noise goes into the velocity alone where the attitude is exact: not here, so it is
    // more.
    let p = EstimatorParameters::BMI088;
    assert!((covariance.gg.m11 / (p.gyro_walk * p.gyro_walk) - 1.0).abs() < 1e-4);
    assert!((covariance.aa.m33 / (p.accelerometer_walk * p.accelerometer_walk) - 1.0).abs() < 1e-4);
    let walked = p.gyro_noise * p.gyro_noise + p.gyro_walk * p.gyro_walk / 3.0;
    assert!((covariance.tt.m22 / walked - 1.0).abs() < 0.01, "{}", covariance.tt.m22 / walked);
    assert!(covariance.vv.m11 > p.accelerometer_noise * p.accelerometer_noise);
}

#[test]
fn a_measurement_leaves_what_the_textbook_says() {
    let before = correlated();
    for (part, at) in [(Part::Position, 0), (Part::Velocity, 3), (Part::Attitude, 6)] {
        let noise = Matrix3::new(4e-4, 1e-4, 0.0, 1e-4, 3e-4, 5e-5, 0.0, 5e-5, 2e-4_f32);
        let residual = Vector3::new(0.01_f32, -0.02, 0.03);
        let mut covariance = Covariance::from_full(&before);
        let weight = inverse(&(covariance.block(part) + noise)).unwrap();
        let correction = covariance.fuse(part, &residual, &noise, &weight);
        // P - P H' S^-1 H P, in double precision.
        let columns = before.fixed_columns::<3>(at).into_owned();
        let s = before.fixed_view::<3, 3>(at, at) + noise.cast::<f64>();
        let gain = columns * s.try_inverse().unwrap();
        let expected = before - gain * columns.transpose();
        let error = apart(&covariance.full(), &expected);
        assert!(error < 1e-4, "{part:?}: {error}");
        let Correction { position, velocity, attitude, gyro_bias, accelerometer_bias } = correction;
        let wanted = gain * residual.cast::<f64>();
        for (n, found) in [position, velocity, attitude, gyro_bias, accelerometer_bias].iter().enumerate() {
            let wanted = wanted.fixed_rows::<3>(3 * n).into_owned();
            assert!((found.cast::<f64>() - wanted).norm() < 1e-4 * wanted.norm(), "{part:?}: {n}");
        }
    }
}

#[test]
fn it_stays_symmetric_and_positive_through_an_hour_of_poses() {
    let mut covariance = Covariance::diagonal([10.0, 10.0, 1.0, 0.05, 0.5]);
    let mut nominal = somewhere();
    let noise = |deviation: f32| Matrix3::from_diagonal_element(deviation * deviation);
    let mut min = f64::INFINITY;
    for n in 0..360_000_u64 {
        let rate = Vector3::new(1.0, -2.0, 3.0) * ((n / 500) % 3) as f32;
        let increment = Increment::steady(0, 10_000, &rate, &Vector3::new(0.5, -0.2, 9.5));
        let motion = nominal.advance(&increment, 9.81);
        covariance.advance(&motion, &EstimatorParameters::BMI088);
        for (part, deviation) in [(Part::Position, 1e-4), (Part::Attitude, 5e-4)] {
            let noise = noise(deviation);
            let weight = inverse(&(covariance.block(part) + noise)).unwrap();
            covariance.fuse(part, &Vector3::zeros(), &noise, &weight);
        }
        if n % 1_000 == 0 || n < 100 {
            let full = covariance.full();
            assert_eq!(full, full.transpose(), "{n}");
            // Scaled to unit diagonal, so that units do not matter.
            let scale = full.diagonal().map(|x| 1.0 / x.sqrt());
            let scaled = Full::from_fn(|i, j| full[(i, j)] * scale[i] * scale[j]);
            min = min.min(scaled.symmetric_eigenvalues().min());
            assert!(covariance.is_positive(), "{n}");
        }
    }
    assert!(min > 1e-4, "least eigenvalue of the correlations {min}");
}

#[test]
fn the_inverse_is_one_and_what_is_not_positive_has_none() {
    let m = Matrix3::new(4.0, 1.0, -0.5, 1.0, 3.0, 0.2, -0.5, 0.2, 2.0_f32);
    for scale in [1e-8_f32, 1.0, 1e6] {
        let product = inverse(&(m * scale)).unwrap() * (m * scale);
        assert!((product - Matrix3::identity()).norm() < 1e-6, "{product}");
    }
    assert_eq!(inverse(&-m), None);
    assert_eq!(inverse(&(m * f32::NAN)), None);
    assert_eq!(inverse(&Matrix3::from_element(1.0)), None);
}

#[test]
fn a_moved_frame_turns_what_is_known_of_the_velocity() {
    let before = correlated();
    let mut covariance = Covariance::from_full(&before);
    let quarter = nominal::rotation(&Vector3::new(0.0, 0.0, 4.0 * (core::f32::consts::PI / 8.0).tan()));
    let turn = UnitQuaternion::new_unchecked(quarter).to_rotation_matrix().into_inner();
    let pose = Matrix3::from_diagonal_element(1e-6);
    covariance.rebase(&turn, &pose, &pose, 0.0);
    let (found, turn) = (covariance.full(), turn.cast::<f64>());
    let block = |m: &Full, i: usize, j: usize| m.fixed_view::<3, 3>(3 * i, 3 * j).into_owned();
    assert!((block(&found, 1, 1) - turn * block(&before, 1, 1) * turn.transpose()).norm() < 1e-8);
    assert!((block(&found, 1, 4) - turn * block(&before, 1, 4)).norm() < 1e-8);
    assert_eq!(block(&found, 0, 1), Matrix3::zeros());
    assert!(found.symmetric_eigenvalues().min() > 0.0);
}

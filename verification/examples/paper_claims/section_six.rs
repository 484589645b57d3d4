//! The paper's Section VI, flown by its design and by nested saturations: what either asks of the actuators.

use crate::claims::{Claims, three};
use host_sim::flight::Flight;
use host_sim::rivals::jet::Jet;
use host_sim::rivals::nested::{Nested, Outer};
use host_sim::rivals::pilot::model;
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::reality::sensors::Sensors;
use std::error::Error;

/// Table I in the names of [`host_sim::rivals::nested`]; the integral is as good as none, since the paper's law has
/// none.
pub const MATCHED_GAINS: [f64; 10] = [6.0, 9.0, 1e-6, 2.0, 0.499, 1e-3, 100.0, 0.206, 0.1, 0.045];
/// The duration of the actuators' picture, s.
const ACTUATOR_PLOT_S: f64 = 4.0;

/// A flight of nested saturations with these gains.
pub fn nested(scenario: &Scenario, gains: [f64; 10]) -> Result<Flight, Box<dyn Error>> {
    let law = Nested::new(model(scenario), scenario.configuration.vehicle(), gains).ok_or("nested: undefined")?;
    Ok(Flight::of_rival(scenario, Box::new(law)))
}

/// Among 64 pairs of k_v and k_p at the same level, those that are first within 0.2 m in Section VI.
pub fn searched(paper: &Scenario) -> Result<[f64; 10], Box<dyn Error>> {
    let mut best = (f64::INFINITY, MATCHED_GAINS);
    for k_v in [0.2, 0.3, 0.45, 0.7, 1.0, 1.5, 2.2, 3.3] {
        for part in [2.0, 2.5, 3.0, 4.0, 6.0, 9.0, 14.0, 20.0] {
            let mut gains = MATCHED_GAINS;
            (gains[0], gains[1]) = (k_v, k_v * k_v / part);
            let settled = SectionSix::simulate(paper, nested(paper, gains)?)?.settled;
            if settled < best.0 {
                best = (settled, gains);
            }
        }
    }
    Ok(best.1)
}

/// A law's figures in the paper's Section VI.
#[derive(Default)]
pub struct SectionSix {
    thrust: (f64, f64),
    torque: Vector3<f64>,
    /// Maximum |omega_d|, rad/s.
    rate: f64,
    /// Since when within 0.2 m, s.
    settled: f64,
    height_lost: f64,
    /// In the last 10 s: m, rad.
    steady: (f64, f64),
    /// (s, N) and (s, N m) of the first seconds.
    pub thrusts: Vec<(f64, f64)>,
    pub torques: Vec<(f64, f64)>,
    pub errors: Vec<(f64, f64)>,
    pub yaws: Vec<(f64, f64)>,
}

impl SectionSix {
    /// Flies it.
    pub fn simulate(paper: &Scenario, mut flight: Flight) -> Result<Self, Box<dyn Error>> {
        let mut shown = Self { thrust: (f64::INFINITY, 0.0), ..Self::default() };
        let duration = paper.timing.duration();
        for _ in 0..paper.timing.ticks {
            let tick = flight.tick()?;
            let (time, thrust) = (tick.time_us as f64 * 1e-6, f64::from(tick.wrench.thrust));
            let torque = tick.wrench.torque.map(f64::from);
            shown.thrust = (shown.thrust.0.min(thrust), shown.thrust.1.max(thrust));
            shown.torque = shown.torque.sup(&torque.abs());
            shown.rate = shown.rate.max(tick.diagnostics.desired_angular_velocity.norm().into());
            shown.height_lost = shown.height_lost.max(paper.initial.position.z - tick.state.position.z);
            let error = (tick.state.position - tick.reference.position.map(f64::from)).norm();
            let heading = tick.reference.heading.direction();
            let yaw = tick.state.yaw() - f64::from(heading.y).atan2(heading.x.into());
            let yaw = yaw.sin().atan2(yaw.cos()).abs();
            if error > 0.2 {
                shown.settled = time;
            }
            if time > duration - 10.0 {
                shown.steady = (shown.steady.0.max(error), shown.steady.1.max(yaw));
            }
            if time < ACTUATOR_PLOT_S {
                shown.thrusts.push((time, thrust));
                shown.torques.push((time, torque.norm()));
            }
            shown.errors.push((time, error));
            shown.yaws.push((time, yaw.to_degrees()));
        }
        Ok(shown)
    }
}

/// What Section VI shows of the paper's design, of nested saturations with the same small motions, and of the quickest
/// of them.
pub fn claim(claims: &mut Claims, filtered: &SectionSix, others: [&SectionSix; 2]) {
    let of = |get: &dyn Fn(&SectionSix) -> f64| others.map(get);
    let interval = |shown: &SectionSix| format!("{:.2} to {:.2}", shown.thrust.0, shown.thrust.1);
    let within = (3.51..=6.19).contains(&filtered.thrust.0) && filtered.thrust.1 <= 6.19;
    let both = others.map(interval).join("; ");
    claims.add("thrust within 3.51 to 6.19 N", "Section VI, N", interval(filtered), both, &[within]);
    let axes = [("x", 0), ("y", 1), ("z", 2)];
    for (axis, index) in axes {
        let get = |shown: &SectionSix| shown.torque[index];
        let figure = format!("Section VI, greatest |torque {axis}|, N m");
        claims.less("less torque than nested saturations", &figure, get(filtered), &of(&get));
    }
    claims.less(
        "bounded attitude references",
        "Section VI, greatest |omega_d|, rad/s",
        filtered.rate,
        &of(&|s| s.rate),
    );
    let figure = "Section VI, last 10 s, greatest position error, mm";
    let precise = filtered.steady.0 < 1e-3;
    let other = of(&|s| 1e3 * s.steady.0).map(three).join("; ");
    claims.add("position error below 1 mm in the end", figure, three(1e3 * filtered.steady.0), other, &[precise]);
    let figure = "Section VI, within 0.2 m for good after, s";
    claims.less("(not claimed) sooner there", figure, filtered.settled, &of(&|s| s.settled));
    claims.less("(not claimed) less height lost", "Section VI, m", filtered.height_lost, &of(&|s| s.height_lost));
}

/// Heading on a circle that tilts the vehicle by 14 degrees.
pub fn heading(claims: &mut Claims, gains: [f64; 10]) -> Result<(), Box<dyn Error>> {
    let along = include_str!("../../../scenarios/circle.toml");
    let facing_x = along.replace("offset = 1.57079633, rate = 1.57079633", "offset = 0.0, rate = 0.0");
    let mut circle = Scenario::parse(&facing_x, "scenarios/circle.toml")?;
    // Both begin on it.
    let first = circle.trajectory.at(0);
    (circle.initial.position, circle.initial.velocity) = (first.position.map(f64::from), first.velocity.map(f64::from));
    let flown = [
        SectionSix::simulate(&circle, Flight::new(&circle)?)?,
        SectionSix::simulate(&circle, nested(&circle, gains)?)?,
    ];
    let [ours, other] = flown.map(|shown| shown.steady.1.to_degrees());
    claims.less(
        "exact heading, tilted too",
        "1 m circle at 0.25 Hz facing x, last 10 s, greatest yaw error, degrees",
        ours,
        &[other],
    );
    Ok(())
}

/// How fast the position feedback can change, one axis, at the same level and the same small motions.
pub fn rates(claims: &mut Claims, paper: &Scenario) {
    let [k_v, k_p, k_i, m_v, p_share, i_share, ..] = MATCHED_GAINS;
    let outer = Outer::new(k_v, k_p, k_i, m_v, p_share, i_share);
    let vehicle = model(paper);
    let free = vehicle.thrust_max / vehicle.mass + vehicle.gravity;
    let sup = |max: Option<f64>| {
        let mut sup = (0.0_f64, 0.0_f64);
        let along = |value: f64| Vector3::new(value, 0.0, 0.0);
        for (p, v) in (-60..=60).flat_map(|p| (-60..=60).map(move |v| (f64::from(p) * 0.05, f64::from(v) * 0.05))) {
            let of = |a: f64, j: f64| {
                let [p, v, a, j] = [p, v, a, j].map(along);
                let feedback = outer.feedback(&Jet([p, v, a]), &Jet([v, a, j]), &Jet::ZERO).0;
                feedback.map(|part| part.x)
            };
            let signs: &[f64] = &[-1.0, 1.0];
            let accelerations: Vec<f64> = match max {
                None => vec![of(0.0, 0.0)[0]],
                Some(max) => signs.iter().map(|sign| sign * max).collect(),
            };
            for a in accelerations {
                let [_, rate, _] = of(a, 0.0);
                let [_, _, second] = of(a, rate);
                sup = (sup.0.max(rate.abs()), sup.1.max(second.abs()));
            }
        }
        sup
    };
    let (ideal, tumbling) = (sup(None), sup(Some(free)));
    let (k_f, k_s, m_p) = (2.0_f64, 20.0_f64, 2.0);
    let u_l = (k_f / k_s).powf(k_f / (k_s - k_f));
    let (first, second) = (2.0 * k_f * u_l * m_p, 2.0 * k_f * m_p * (k_f * u_l + k_s));
    let other = |ideal: f64, tumbling: f64| format!("{} aligned, {} at any attitude", three(ideal), three(tumbling));
    let claim = "less conservative bounds of u', u''";
    claims.add(
        claim,
        "u_f' of one axis, m/s^3",
        three(first),
        other(ideal.0, tumbling.0),
        &[first < ideal.0, first < tumbling.0],
    );
    claims.add(
        claim,
        "u_f'' of one axis, m/s^4",
        three(second),
        other(ideal.1, tumbling.1),
        &[second < ideal.1, second < tumbling.1],
    );
}

/// Torque that noise makes: what the derivatives cost that need the measured attitude and velocity.
pub fn noise(claims: &mut Claims, paper: &Scenario) -> Result<(), Box<dyn Error>> {
    let mut noisy = host_sim::flight::tasks::hover(paper, Vector3::zeros(), 10.0)?;
    noisy.reality.sensors = Some(Sensors {
        pose_delay_ticks: 0,
        imu_delay: 0.0,
        ..host_sim::studies::tune::trials::noise(paper.timing.period())
    });
    let restless = |mut flight: Flight| {
        let (mut squares, mut before) = (0.0, None::<Vector3<f64>>);
        for _ in 0..noisy.timing.ticks {
            let torque = flight.tick()?.wrench.torque.map(f64::from);
            squares += before.map_or(0.0, |before| (torque - before).norm_squared());
            before = Some(torque);
        }
        Ok::<f64, Box<dyn Error>>(1e3 * (squares / (noisy.timing.ticks - 1) as f64).sqrt())
    };
    let (ours, other) = (restless(Flight::new(&noisy)?)?, restless(nested(&noisy, MATCHED_GAINS)?)?);
    claims.less(
        "simpler derivatives of the position law",
        "hover in noise: torque's change a tick, RMS, mN m",
        ours,
        &[other],
    );
    Ok(())
}

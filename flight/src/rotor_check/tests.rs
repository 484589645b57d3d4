extern crate std;

use super::*;
use crate::PERIOD_US;
use crate::hummingbird::rotors;
use std::string::ToString;
use std::vec::Vec;

const LAG_S: f32 = 0.03;

/// A flight of which the rotors lag and are commanded, and what was found in it.
struct Bench {
    check: RotorCheck,
    rotors: Rotors,
    /// rad/s.
    speeds: [f32; 4],
    /// The share of its commanded speed that each settles at.
    shares: [f32; 4],
    answers: [bool; 4],
    /// Real over nominal speed.
    ratio: f32,
    now: u64,
    reports: Vec<(u64, RotorFault)>,
    lost: Option<(u64, LostRotor)>,
}

impl Bench {
    fn new() -> Self {
        let rotors = rotors();
        let check = RotorCheck::new(Some(&rotors), LAG_S, PERIOD_US as f32 * 1e-6);
        let (reports, lost) = (Vec::new(), None);
        Self {
            check,
            rotors,
            speeds: [0.0; 4],
            shares: [1.0; 4],
            answers: [true; 4],
            ratio: 1.0,
            now: 0,
            reports,
            lost,
        }
    }

    fn tick(&mut self, turning: Turning, commands: [f32; 4]) {
        let seen: [Option<f32>; 4] = core::array::from_fn(|i| Some(self.speeds[i]).filter(|_| self.answers[i]));
        let RotorFindings { report, lost } = self.check.tick(turning, Some(&seen), self.now);
        self.reports.extend(report.map(|fault| (self.now, fault)));
        self.lost = self.lost.or(lost.map(|lost| (self.now, lost)));
        for ((speed, share), command) in self.speeds.iter_mut().zip(self.shares).zip(commands) {
            *speed += (self.ratio * share * command - *speed) * (1.0 - (PERIOD_US as f32 * -1e-6 / LAG_S).exp());
        }
        self.now += PERIOD_US;
    }

    fn fly(&mut self, thrusts: [f32; 4], seconds: f32) {
        let commands = core::array::from_fn(|i| self.rotors[i].speed_at(thrusts[i]));
        for _ in 0..(seconds * 1e6 / PERIOD_US as f32) as u32 {
            self.tick(Turning::Flying(&thrusts), commands);
        }
    }

    fn idle(&mut self, seconds: f32) {
        for _ in 0..(seconds * 1e6 / PERIOD_US as f32) as u32 {
            self.tick(Turning::Idling, [100.0; 4]);
        }
    }
}

const HOVER_N: [f32; 4] = [1.75; 4];

#[test]
fn rotors_that_follow_are_never_blamed() {
    for ratio in [0.8, 1.0, 1.9] {
        let mut bench = Bench { ratio, ..Bench::new() };
        bench.idle(3.0);
        for turn in 0..200 {
            let thrust = |i: usize| [0.2, 1.75, 4.0][(turn * 7 + i * 5 + turn / 3) % 3];
            bench.fly(core::array::from_fn(thrust), 0.01 * (1 + turn % 40) as f32);
        }
        assert_eq!((&bench.reports[..], bench.lost), (&[][..], None), "{ratio}");
    }
}

#[test]
fn a_dead_rotor_is_lost_sooner_than_its_speed_is_gone_and_named() {
    for rotor in 0..4 {
        let mut bench = Bench::new();
        bench.fly(HOVER_N, 3.0);
        let start = bench.now;
        bench.shares[rotor] = 0.0;
        bench.fly(HOVER_N, 1.0);
        let (found, lost) = bench.lost.unwrap();
        assert_eq!(lost, LostRotor { rotor, left: 0.0 });
        assert!(found - start <= 40_000, "{}", found - start);
        let not_turning = RotorFault { rotor, deviation: RotorDeviation::NotTurning };
        assert!(bench.reports.iter().any(|(_, fault)| *fault == not_turning), "{:?}", bench.reports);
        assert!(bench.reports.iter().all(|(_, fault)| fault.rotor == rotor));
    }
    let fault = RotorFault { rotor: 1, deviation: RotorDeviation::NotTurning };
    assert_eq!(fault.to_string(), "Rotor 2: not turning");
}

#[test]
fn a_rotor_that_keeps_most_of_its_speed_is_said_and_not_lost() {
    for (share, deviation) in [(0.65, RotorDeviation::TooSlow), (1.6, RotorDeviation::TooFast)] {
        let mut bench = Bench::new();
        bench.fly(HOVER_N, 3.0);
        bench.shares[2] = share;
        bench.fly(HOVER_N, 11.0);
        let expected = RotorFault { rotor: 2, deviation };
        assert_eq!(bench.reports.iter().map(|(_, fault)| *fault).collect::<Vec<_>>(), [expected; 2]);
        assert_eq!(bench.reports[1].0 - bench.reports[0].0, ROTOR_REPORT_INTERVAL_US);
        assert_eq!(bench.lost, None);
    }
}

#[test]
fn what_is_left_of_a_weak_rotor_is_measured() {
    let mut bench = Bench::new();
    bench.fly(HOVER_N, 3.0);
    bench.shares[0] = 0.45;
    bench.fly(HOVER_N, 1.0);
    let (_, lost) = bench.lost.unwrap();
    assert!(lost.rotor == 0 && (0.12..0.25).contains(&lost.left), "{lost:?}");
}

#[test]
fn a_silent_controller_is_said_and_nothing_is_lost() {
    let mut bench = Bench::new();
    bench.fly(HOVER_N, 1.0);
    bench.answers[3] = false;
    bench.fly(HOVER_N, 1.0);
    assert_eq!(
        bench.reports.iter().map(|(_, fault)| *fault).collect::<Vec<_>>(),
        [RotorFault { rotor: 3, deviation: RotorDeviation::Silent }]
    );
    assert_eq!(bench.lost, None);
    // All of them silent are controllers that do not answer at all.
    let mut bench = Bench { answers: [false; 4], ..Bench::new() };
    bench.fly(HOVER_N, 3.0);
    assert!(bench.reports.is_empty() && bench.lost.is_none());
}

#[test]
fn an_idling_rotor_that_does_not_turn_keeps_the_vehicle_on_the_ground() {
    let mut bench = Bench::new();
    bench.shares[1] = 0.0;
    bench.idle(0.9);
    assert_eq!(bench.check.grounding(bench.now), None);
    bench.idle(0.4);
    let fault = RotorFault { rotor: 1, deviation: RotorDeviation::NotTurning };
    assert_eq!(bench.check.grounding(bench.now), Some(fault));
    assert_eq!(bench.reports.iter().map(|(_, fault)| *fault).collect::<Vec<_>>(), [fault]);
    assert_eq!(bench.lost, None);
    // It turns after all.
    bench.shares[1] = 1.0;
    bench.idle(0.5);
    assert_eq!(bench.check.grounding(bench.now), None);
    // Not one of them turns.
    let mut bench = Bench { shares: [0.0; 4], ..Bench::new() };
    bench.idle(2.0);
    assert_eq!(bench.check.grounding(bench.now), Some(RotorFault { rotor: 0, ..fault }));
    // Disarmed, nothing is asked of a rotor.
    bench.tick(Turning::No, [0.0; 4]);
    assert_eq!(bench.check.grounding(bench.now), None);
}

#[test]
fn speeds_that_are_no_numbers_find_nothing_and_never_panic() {
    let mut check = RotorCheck::new(Some(&rotors()), LAG_S, 0.01);
    for (tick, speed) in [f32::NAN, f32::INFINITY, -1.0, f32::MAX].into_iter().cycle().take(400).enumerate() {
        let speeds = [Some(speed), Some(500.0), None, Some(f32::NAN)];
        let found = check.tick(Turning::Flying(&[f32::NAN, 1.0, 2.0]), Some(&speeds[..tick % 5]), tick as u64 * 10_000);
        assert_eq!(found.lost, None);
    }
    let mut nothing = RotorCheck::new(None, LAG_S, 0.01);
    assert_eq!(nothing.tick(Turning::Flying(&HOVER_N), Some(&[Some(1.0)]), 0), RotorFindings::default());
}

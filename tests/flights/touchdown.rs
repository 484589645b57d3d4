//! Touchdowns on sensors as they are. Legs that are stiff stop a vehicle within a millisecond, at 0.5 m/s with 50 g, of
//! which an accelerometer shows 24: the estimate learns the rest from poses, 20 ms late. Here landings begin at two
//! dozen moments, each with its own draw of noise and biases, because what is left out depends on where between two
//! samples and two poses the ground comes.
//!
//! `cargo test -p host-sim touchdown -- --nocapture` prints the figures that stand in `docs/measured.md`.

use crate::support::extended::vehicle;
use controller_core::certificate::certified::Certified;
use flight::{FlightSettings, Inputs, Mode, Request};
use scenario::reality::estimator::Estimator;
use verification::piloted::{PilotedVehicle, Place, Undisturbed};

/// When it gets which command, and until when it is watched.
const ARM_TICK: u64 = 200;
const TAKE_OFF: u64 = 220;
const LAND_TICK: u64 = 900;
const END_TICK: u64 = 1_700;

/// How far the estimate may be off, m: at a touchdown, and before it and from [`KNOWN_AFTER`] ticks after it on.
const AT_TOUCHDOWN: f64 = 25e-3;
const ESTIMATE_ERROR_MAX_M: f64 = 3e-3;
const KNOWN_AFTER: u64 = 15;

/// How far the estimate was off, m, while it flew, and after the touchdown; and the last tick after it at which that
/// was beyond [`ESTIMATE_ERROR_MAX_M`].
fn fly(name: &str, draw: u64) -> (f64, f64, u64) {
    let mut scenario = vehicle(name);
    scenario.reality.estimator = Some(Estimator { seed: draw, ..Estimator::default() });
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let mut place = Place::new(&scenario.configuration);
    let settings = FlightSettings::DEFAULT;
    let mut vehicle = PilotedVehicle::new(&scenario, Ok(&certified), &settings, &mut place, 0).unwrap();
    // 0.37 mm are 0.7 ms of going down.
    let height = 0.6 + 0.37e-3 * draw as f32;
    let (mut flying, mut landed, mut last) = (0.0_f64, 0.0_f64, 0);
    let mut touched = None;
    for tick in 1..END_TICK {
        let request = match tick {
            ARM_TICK => Some(Request::Arm),
            TAKE_OFF => Some(Request::TakeOff(Some(height))),
            LAND_TICK => Some(Request::Land),
            _ => None,
        };
        let given =
            Inputs { request, ground_station: Some(vehicle.now() + vehicle.pilot().period()), ..Inputs::default() };
        let (outcome, _) = vehicle.tick(&given, &mut Undisturbed).unwrap();
        assert!(!matches!(outcome.answer, Some(Err(_))), "{name}, draw {draw}, tick {tick}: {:?}", outcome.answer);
        let touchdown = vehicle.vehicle_mut().take_touchdown().filter(|touchdown| touchdown.speed > 0.1);
        touched = touched.or(touchdown.map(|_| tick));
        if tick < ARM_TICK {
            continue;
        }
        let off = (outcome.estimated.unwrap().state.position.cast() - vehicle.vehicle().state().position).norm();
        match touched {
            None => flying = flying.max(off),
            Some(when) => {
                landed = landed.max(off);
                last = if off > ESTIMATE_ERROR_MAX_M { tick - when } else { last };
            }
        }
        // Ready again, but for a pose in the last second that was not believed.
        let down = [Mode::Ready, Mode::Checks].contains(&outcome.mode);
        assert!(tick + 1 < END_TICK || down, "{name}, draw {draw}: {:?}", outcome.mode);
    }
    assert!(touched.is_some(), "{name}, draw {draw}");
    (flying, landed, last)
}

#[test]
fn what_a_touchdown_leaves_out_is_known_again_soon_whenever_it_comes() {
    println!("vehicle      telemetry off by [mm]: in the air, at touchdown    3 mm again after");
    for name in ["hummingbird", "study"] {
        let flown: Vec<_> = (0..24).map(|draw| fly(name, draw)).collect();
        let flying = flown.iter().map(|flown| flown.0).fold(0.0, f64::max);
        let landed = flown.iter().map(|flown| flown.1).fold(0.0, f64::max);
        let last = flown.iter().map(|flown| flown.2).max().unwrap();
        println!("{name:12} {:22.1} {:25.1}    {:.2} s", flying * 1e3, landed * 1e3, (last + 1) as f64 * 0.01);
        assert!(flying < ESTIMATE_ERROR_MAX_M && landed < AT_TOUCHDOWN && last < KNOWN_AFTER, "{name}: {flown:?}");
    }
}

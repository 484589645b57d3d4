//! How a flight ends that ends well: on the ground, disarmed, and not too hard.

use super::flight::Flight;
use firmware::hardware::MotorCommand;

/// The hardest touchdown that any way down may end with, m/s.
pub const TOUCHDOWN_MAX: f64 = 1.2;

/// Lets the vehicle come down within so many seconds: it touches the ground once, finds it, and disarms.
pub fn check_landed(flight: &mut Flight, seconds: f64) {
    let landed = flight.until("Landed: disarmed", seconds);
    let speed = flight.hardware.touchdown().expect("it has not touched the ground");
    println!("touched down at {speed:.3} m/s; disarmed at {:.2} s", 1e-6 * landed as f64);
    assert!(speed < TOUCHDOWN_MAX, "{speed} m/s");
    flight.pass(0.02);
    assert_eq!(flight.hardware.command(), MotorCommand::Stop);
    assert!(!flight.report().mode.is_armed(), "{:?}", flight.report().mode);
    let pose = flight.hardware.pose();
    assert_eq!((pose.position.z, pose.velocity.norm()), (0.0, 0.0));
}

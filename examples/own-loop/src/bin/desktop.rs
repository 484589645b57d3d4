//! The law in a loop of one's own: from upside down to a hover.
//!
//! `cargo run --bin desktop`

use controller_core::prelude::*;
use own_loop::{UPSIDE_DOWN, advanced, hummingbird};

fn main() -> Result<(), ParameterError> {
    let (certified, rotors) = hummingbird()?;
    let vehicle = certified.configuration().vehicle();
    let (mut law, mixer) = (Law::new(&certified, 0.01)?, Mixer::new(&rotors));
    let hover = Hover::new(Vector3::new(0.0, 0.0, 2.0), Heading::FORWARD)?;
    let mut state = UPSIDE_DOWN;
    for tick in 0..500 {
        let command = law.command(&state, &hover.at(tick * 10_000)).expect("finite numbers");
        let thrusts = mixer.allocate(&command.wrench).expect("finite numbers").thrusts;
        if tick % 50 == 0 {
            let (p, thrust) = (state.position, command.wrench.thrust);
            println!("{:4.1} s   {:6.3} {:6.3} {:6.3} m   {thrust:.2} N", tick as f32 * 0.01, p.x, p.y, p.z);
        }
        state = advanced(&state, vehicle, &mixer.wrench(&thrusts), 0.01);
    }
    let off = (state.position - hover.at(0).position).norm();
    assert!(off < 0.01, "{off} m off after 5 s");
    Ok(())
}

//! The law in an Embassy task. On a board, `state` would come from an estimator and `thrusts` go to the motors.
//!
//! `cargo run --bin embassy` flies 5 s in real time.

use controller_core::prelude::*;
use embassy_executor::Spawner;
use embassy_sync::{blocking_mutex::raw::CriticalSectionRawMutex, signal::Signal};
use embassy_time::{Duration, Ticker, Timer};
use own_loop::{UPSIDE_DOWN, advanced, hummingbird};

static STATE: Signal<CriticalSectionRawMutex, State> = Signal::new();
static WRENCH: Signal<CriticalSectionRawMutex, Wrench> = Signal::new();

#[embassy_executor::task]
async fn control(certified: Certified, rotors: Rotors) {
    let mut law = Law::new(&certified, 0.01).expect("a period within (0, 0.1] s");
    let mixer = Mixer::new(&rotors);
    let hover = Hover::new(Vector3::new(0.0, 0.0, 2.0), Heading::FORWARD).expect("finite numbers");
    let mut ticks = Ticker::every(Duration::from_millis(10));
    loop {
        ticks.next().await;
        // Without a new state, or with one that the law refuses, nothing is commanded: whoever drives the motors must
        // stop them then.
        let Some(state) = STATE.try_take() else { continue };
        let Ok(command) = law.command(&state, &hover.at(0)) else { continue };
        let Ok(allocation) = mixer.allocate(&command.wrench) else { continue };
        WRENCH.signal(mixer.wrench(&allocation.thrusts));
    }
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let (certified, rotors) = hummingbird().expect("its numbers are those of a vehicle");
    let (vehicle, mut state) = (*certified.configuration().vehicle(), UPSIDE_DOWN);
    spawner.spawn(control(certified, rotors).expect("the only one"));
    for _ in 0..500 {
        STATE.signal(state);
        let wrench = WRENCH.wait().await;
        state = advanced(&state, &vehicle, &wrench, 0.01);
        Timer::after_millis(1).await;
    }
    println!("after 500 ticks at {:.3} {:.3} {:.3} m", state.position.x, state.position.y, state.position.z);
    std::process::exit(i32::from((state.position - UPSIDE_DOWN.position).norm() > 0.01));
}

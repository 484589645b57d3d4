//! The flights that are measured, and the table.

use crate::body;
use crate::count::{CLOCKS_MHZ, Cost};
use crate::counter::Counter;
use crate::estimation;
use crate::stack;
use crate::tick;
use controller_core::allocation::{Allocation, Mixer};
use controller_core::certificate::certified::{Certified, Refused};
use controller_core::configuration::Configuration;
use controller_core::error::InputError;
use controller_core::extended::controller::Controller;
use controller_core::governor::{Governor, GovernorLimits, HeadingSetpoint, Memory, Motion, Setpoint};
use controller_core::heading::Heading;
use controller_core::law::Command;
use controller_core::law::Law;
use controller_core::math;
use controller_core::reference::harmonic::{Harmonic, HarmonicParameters, HeadingParameters};
use controller_core::reference::hover::Hover;
use controller_core::reference::{Reference, Trajectory};
use controller_core::shield::network::{INPUT_COUNT, Memory as Remembered, Network, OUTPUT_COUNT};
use controller_core::shield::{Demand, Settings, Shield, ShieldStep};
use controller_core::state::{State, Wrench};
use core::hint::black_box;
use cortex_m_semihosting::hprintln;
use firmware::boards::mps2::exit;
use firmware::replay::shielded::{network, recurrent_network};
use firmware::{configuration, replay};
use nalgebra::{Quaternion, Vector3};
use static_cell::ConstStaticCell;

/// Steps of a measured flight.
const FLIGHT_STEPS: u64 = 1000;
const PERIOD_US: u64 = 10_000;
const PERIOD_S: f32 = 0.01;
/// The measured call, the one that flies: state and reference in, wrench and the errors to report out.
type Step = fn(&mut Law, &State, &Reference) -> Result<Command, InputError>;

type Shielded = fn(&mut Shield, &mut Controller, &State, Option<&Demand>) -> Result<ShieldStep, InputError>;

type Outputs = fn(&Network<'static>, &[f32; INPUT_COUNT], &mut Remembered) -> [f32; OUTPUT_COUNT];

type Allocate = fn(&Mixer, &Wrench) -> Result<Allocation, InputError>;

#[cortex_m_rt::entry]
fn main() -> ! {
    exit::end(measure())
}

/// Everything, as a table; whether it could be measured at all.
fn measure() -> bool {
    let counter = cortex_m::Peripherals::take().and_then(|peripherals| Counter::start(peripherals.SYST));
    let Some(counter) = counter else {
        hprintln!("time does not follow instructions here: run QEMU with -icount shift=6");
        return false;
    };
    let Ok(embedded) = configuration::embedded() else {
        hprintln!("{}: the embedded configuration is refused", configuration::NAME);
        return false;
    };
    let Some(certified) = certified(&counter, &embedded) else { return false };
    let Ok(law) = Law::new(&certified, PERIOD_S) else { return false };
    let (Some(rotors), Some(circle)) = (embedded.rotors(), circle()) else { return false };
    let Ok(target) = Hover::new(Vector3::new(0.0, 0.0, 5.0), Heading::FORWARD) else { return false };
    let Some(papers) = replay::papers().ok().and_then(|papers| Certified::new(papers).ok()) else {
        return false;
    };
    let Ok(papers_law) = Law::new(&papers, PERIOD_S) else { return false };
    let mixer = Mixer::new(rotors);
    let (mut allocation, mut governing) = (Cost::default(), Cost::default());

    hprintln!("{:<42} {:>10} {:>10} {:>9} {:>9}", "instructions", "mean", "worst", "us@168MHz", "us@400MHz");
    let mut flight = Flight { law, mixer: Some(&mixer), certified: &certified, counter: &counter };
    let Some((settled, _)) = flight.fly(on(&circle), &circle, &mut Cost::default()) else { return false };
    let Some((_, cost)) = flight.fly(settled, &circle, &mut allocation) else { return false };
    cost.print("step, circle");
    allocation.print("allocation, circle");
    let mut recovering = Cost::default();
    let Some((_, cost)) = flight.fly(TUMBLING_STATE, &target, &mut recovering) else { return false };
    cost.print("step, tumbling recovery");
    recovering.print("allocation, tumbling recovery");
    let mut flight = Flight { law: papers_law, mixer: None, certified: &papers, counter: &counter };
    let Some((_, cost)) = flight.fly(settled, &circle, &mut Cost::default()) else { return false };
    cost.print("step, circle, the paper's law");
    if ![false, true].iter().all(|turns_rotors| shielded(&counter, &certified, &settled, *turns_rotors)) {
        hprintln!("the shield does not let its policy fly");
        return false;
    }
    if !govern(&counter, &embedded, &mut governing) {
        return false;
    }
    governing.print("governor tick");
    let mut following = Cost::default();
    if !follow(&counter, &embedded, &mut following) {
        hprintln!("the governor does not follow a circle");
        return false;
    }
    following.print("governor tick, following a circle");
    if !estimation::measure(&counter) {
        hprintln!("the estimator does not believe an exact pose");
        return false;
    }
    if !tick::measure(&counter, &circle) {
        hprintln!("the firmware does not fly an exact body");
        return false;
    }
    hprintln!("times: at one instruction a cycle, which no processor promises");
    hprintln!("one instruction is {} ticks of SysTick", counter.ticks_per_instruction());
    true
}

/// Certifies `configuration`, measured.
fn certified(counter: &Counter, configuration: &Configuration) -> Option<Certified> {
    type Certify = fn(Configuration) -> Result<Certified, Refused>;
    let certify: Certify = black_box(Certified::new);
    let (bytes, _) = stack::depth(|| certify(configuration.clone()).is_ok());
    let copy = configuration.clone();
    let (instructions, certified) = counter.long(|| certify(copy).ok());
    let Some(certified) = certified else {
        hprintln!("{}: the embedded configuration is not certified", configuration::NAME);
        return None;
    };
    let Some(instructions) = instructions else {
        hprintln!("the certificate takes more instructions than the timer counts");
        return None;
    };
    let [bolt, h743] = CLOCKS_MHZ.map(|clock| instructions / clock * 1e-6);
    hprintln!("certificate: {:.0} instructions, {:.2} s at 168 MHz, {:.2} s at 400 MHz", instructions, bolt, h743);
    hprintln!("             {} B of stack beside the result's {} B", bytes, size_of::<Certified>());
    Some(certified)
}

/// A flight under the law, with what it needs.
struct Flight<'a> {
    law: Law,
    /// None where thrust and torque act directly.
    mixer: Option<&'a Mixer>,
    certified: &'a Certified,
    counter: &'a Counter,
}

impl Flight<'_> {
    /// Flies [`FLIGHT_STEPS`] ticks from `state` after a reset; none if the law or the allocation refuses an input.
    fn fly(&mut self, mut state: State, trajectory: &dyn Trajectory, allocation: &mut Cost) -> Option<(State, Cost)> {
        let step: Step = black_box(Law::command);
        let allocate: Allocate = black_box(Mixer::allocate);
        let mut cost = Cost::default();
        self.law.reset();
        for tick in 0..FLIGHT_STEPS {
            let reference = black_box(trajectory.at(tick * PERIOD_US));
            let (instructions, command) = self.counter.short(|| step(&mut self.law, &state, &reference));
            cost.add(instructions);
            let wrench = command.ok()?.wrench;
            let achieved = match self.mixer {
                None => wrench,
                Some(mixer) => {
                    let asked = wrench.scaled(1.0 / self.law.thrust_scale());
                    let (instructions, allocated) = self.counter.short(|| allocate(mixer, &asked));
                    allocation.add(instructions);
                    mixer.wrench(&allocated.ok()?.thrusts)
                }
            };
            body::advance(&mut state, self.certified.configuration().vehicle(), &achieved, PERIOD_S);
        }

        Some((state, cost))
    }
}

/// A hover behind the shield, by accelerations or by speeds of the rotors, and the network that would fly it; whether
/// the policy flew.
fn shielded(counter: &Counter, certified: &Certified, from: &State, turns_rotors: bool) -> bool {
    let (corner, zero) = (Vector3::repeat(20.0), Vector3::zeros());
    let shield = Shield::new(certified.configuration(), &Settings::new(-corner, corner), PERIOD_S);
    let (Ok(mut law), Ok(mut shield)) = (Law::new(certified, PERIOD_S), shield) else { return false };
    let network = if turns_rotors { recurrent_network() } else { network() };
    let (Some(law), Some(network)) = (law.extended(), network) else { return false };
    let step: Shielded = black_box(Shield::step);
    let outputs: Outputs = black_box(Network::outputs);
    let (mut cost, mut thinking, mut state) = (Cost::default(), Cost::default(), *from);
    if turns_rotors {
        // The speeds that hover stay the same all the way: from rest they leave the vehicle where it is.
        state = State { velocity: zero, attitude: Quaternion::identity(), angular_velocity: zero, ..*from };
    }
    let observation = shield.observation(law, &state, &zero);
    let inputs = network.interface().inputs(&observation, &[0.0; OUTPUT_COUNT]);
    let (mut memory, hover) = (network.fresh(), observation.rotors);
    for _ in 0..FLIGHT_STEPS {
        let acceleration = -state.velocity - (state.position - from.position);
        let demand = if turns_rotors {
            Demand::Rotors { speeds: hover }
        } else {
            Demand::Acceleration { acceleration, yaw_rate: 0.0 }
        };
        let (instructions, flown) = counter.short(|| step(&mut shield, law, &state, Some(&demand)));
        let Ok(flown) = flown else { return false };
        if flown.reason.is_some() {
            return false;
        }
        cost.add(instructions);
        body::advance(&mut state, certified.configuration().vehicle(), &flown.wrench, PERIOD_S);
        let (instructions, answer) = counter.short(|| outputs(&network, &inputs, &mut memory));
        black_box(answer);
        thinking.add(instructions);
    }
    let [of_step, of_network] = if turns_rotors {
        ["shielded step, rotor speeds", "network, 22, 16, 16 that remember, 4"]
    } else {
        ["shielded step, the policy's", "network, 22, 32, 32, 4"]
    };
    cost.print(of_step);
    thinking.print(of_network);
    true
}

/// A circle of 1 m in four seconds, 1.5 m up, the heading turning along.
fn circle() -> Option<Harmonic> {
    let frequency = core::f64::consts::FRAC_PI_2;
    let parameters = HarmonicParameters {
        center: [0.0, 0.0, 1.5],
        amplitude: [1.0, 1.0, 0.0],
        frequency: [frequency, frequency, 0.0],
        phase: [0.0, -core::f64::consts::FRAC_PI_2, 0.0],
        heading: HeadingParameters { offset: 0.0, rate: 0.5, amplitude: 0.5, frequency },
    };
    Harmonic::new(parameters).ok()
}

/// Level, where `trajectory` begins, at its speed.
fn on(trajectory: &impl Trajectory) -> State {
    let Reference { position, velocity, .. } = trajectory.at(0);
    State { position, velocity, attitude: Quaternion::identity(), angular_velocity: Vector3::zeros() }
}

/// Upside down, falling, spinning about every axis.
const TUMBLING_STATE: State = State {
    position: Vector3::new(3.0, -2.0, 8.0),
    velocity: Vector3::new(2.0, 1.0, -3.0),
    attitude: Quaternion::from_vector(nalgebra::Vector4::new(1.0, 0.0, 0.0, 0.0)),
    angular_velocity: Vector3::new(10.0, -8.0, 6.0),
};

/// Half a minute of the governor following a circle inside the bounds, sent 20 times a second; the last ten seconds
/// count.
fn follow(counter: &Counter, configuration: &Configuration, cost: &mut Cost) -> bool {
    static MEMORY: ConstStaticCell<Memory> = ConstStaticCell::new(Memory::EMPTY);
    const TURN_RATE_RAD_PER_S: f32 = 1.0;
    let bounds = configuration.bounds();
    // At one radian a second all derivatives are as great as the radius.
    let radius = 0.7 * bounds.horizontal_acceleration.min(bounds.jerk).min(bounds.snap).min(bounds.horizontal_speed);
    let Ok(governor) = Governor::new(bounds, &GovernorLimits::default(), PERIOD_S, MEMORY.take()) else {
        return false;
    };
    let tick: fn(&mut Governor) -> Reference = black_box(Governor::tick);
    let mut follows = true;
    for number in 0..3500_u32 {
        // In 2^-32 turns, then as a phase, which wraps.
        let turned =
            f64::from(TURN_RATE_RAD_PER_S * PERIOD_S * number as f32) / core::f64::consts::TAU * 4_294_967_296.0;
        let (sin, cos) = math::sin_cos_turns((turned as u64) << 32);
        let out = Vector3::new(cos, sin, 0.0) * radius;
        if number % 5 == 0 {
            let velocity = Vector3::new(-sin, cos, 0.0) * (radius * TURN_RATE_RAD_PER_S);
            let motion = Motion::PositionVelocityAcceleration {
                position: out,
                velocity,
                acceleration: -out * (TURN_RATE_RAD_PER_S * TURN_RATE_RAD_PER_S),
            };
            if governor.accept(&Setpoint { motion, turn: HeadingSetpoint::Keep }).is_err() {
                return false;
            }
        }
        let (instructions, reference) = counter.short(|| tick(governor));
        if number >= 2500 {
            cost.add(instructions);
            // A tick later than sent.
            follows &= (reference.position - out).norm() < radius * TURN_RATE_RAD_PER_S * PERIOD_S + 0.001;
        }
    }
    follows
}

/// A minute of the governor under steps of position: there and back every ten seconds.
fn govern(counter: &Counter, configuration: &Configuration, cost: &mut Cost) -> bool {
    static MEMORY: ConstStaticCell<Memory> = ConstStaticCell::new(Memory::EMPTY);
    let (bounds, limits) = (configuration.bounds(), GovernorLimits::default());
    let Ok(governor) = Governor::new(bounds, &limits, PERIOD_S, MEMORY.take()) else {
        return false;
    };
    let tick: fn(&mut Governor) -> Reference = black_box(Governor::tick);
    for number in 0..6000_u32 {
        if number % 1000 == 0 {
            let away = if number % 2000 == 0 { 3.0 } else { 0.0 };
            let motion = Motion::Position(Vector3::new(away, -away, 0.5 * away));
            let setpoint = Setpoint { motion, turn: HeadingSetpoint::Angle { angle: away, rate: 0.0 } };
            if governor.accept(&setpoint).is_err() {
                return false;
            }
        }
        let (instructions, reference) = counter.short(|| tick(governor));
        black_box(reference);
        cost.add(instructions);
    }
    true
}

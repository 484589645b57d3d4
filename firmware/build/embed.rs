//! From a scenario to Rust source: the vehicle, gains, rotors and reference bounds that the firmware flies.
//!
//! With it goes which factors on its gains have sampled loops with margin, judged here because no board can, and a
//! number by which parameters that were tuned on one configuration know that they are on another.
//!
//! The numbers are written with all the digits that reading back bit for bit takes. Nothing that is worked out from
//! them is carried over: the board works out the rotors' inverse and the certificate again at boot.

use controller_core::allocation::{Motor, Rotor, Rotors, Spin};
use controller_core::configuration::{ExtendedLaw, LawParameters, PaperLaw};
use controller_core::constants::Constant;
use controller_core::extended::actuators::ActuatorParameters;
use nalgebra::Vector3;
use scenario::{Scenario, board};

/// What is to be built in.
#[derive(Debug)]
pub struct Embedded {
    /// The source of `fn built()` and a few constants.
    pub source: String,
    /// Why the firmware will refuse to arm, if it will.
    pub warning: Option<String>,
}

/// What the scenario in `text`, of the file `name`, becomes for a processor that flies at up to `rate_max`, Hz.
///
/// What the firmware cannot fly is refused ([`board`]). One that is not certified is built all the same, with a
/// warning. The board itself refuses to arm with it: it boots, answers, tests its motors, and names the inequality.
/// Errors: one line: the file, the field or the loop, and what is wrong.
pub fn embedded(text: &str, name: &str, rate_max: f64) -> Result<Embedded, String> {
    let scenario = Scenario::parse(text, name).map_err(|error| error.to_string())?;
    let rate = 1.0 / scenario.timing.period();
    if rate > rate_max {
        return Err(format!("{name}: control.rate: this board's processor flies at up to {rate_max} Hz, found {rate}"));
    }
    let warning = board::check(&scenario, name)?;
    let rotors = scenario.configuration.rotors().ok_or_else(|| format!("{name}: rotors: missing"))?;
    Ok(Embedded { source: source(&scenario, rotors), warning })
}

fn source(scenario: &Scenario, rotors: &Rotors) -> String {
    let configuration = &scenario.configuration;
    let (vehicle, limits) = (configuration.vehicle(), configuration.limits());
    let bounds = fields(configuration.bounds().entries());
    let rotors_are_nominal = rotors.are_of_nominal_speed();
    let rotors: String = rotors.iter().map(|rotor| format!("        {},\n", rotor_source(rotor))).collect();
    let law = law_source(configuration.law());
    let constants = constants(configuration.law());
    let loops = board::judged(scenario);
    let (across, vertical) = loops.bits();
    let Motor { linear, idle } = scenario.motor();
    format!(
        "/// The scenario's name.
pub const NAME: &str = \"{name}\";

/// A number of this configuration, below 2^24: see `scenario::board::identity`.
pub const IDENTITY: u32 = {identity};

/// The time between control ticks.
pub const PERIOD_US: u64 = {period};

/// What turns the rotors.
pub const MOTOR: Motor = Motor {{ linear: {linear:e}, idle: {idle:e} }};

/// Whether its sampled loops have margin for notches on the gyro that follow the rotors.
pub const FOLLOWS_ROTORS: bool = {follows};

/// Which factors on its gains have sampled loops with margin.
pub static LOOPS: JudgedLoops = JudgedLoops::from_bits([{across}], [{vertical}]);

/// The law's constants, as built.
pub const CONSTANTS: [(&str, f32); {count}] = [{constants}];

fn built() -> Result<Configuration, ParameterError> {{
    let vehicle = VehicleParameters {{ mass: {mass:e}, inertia: {inertia}, gravity: {gravity:e} }};
    let vehicle = Vehicle::new(vehicle)?;
    let limits = LimitParameters {{ thrust_max: {thrust_max:e}, torque_max: {torque_max} }};
    let limits = Limits::new(limits, &vehicle)?;
    let bounds = ReferenceBounds {{ {bounds} }};
    let rotors = Rotors::new(&[
{rotors}    ])?{speeds};
{law}}}
",
        name = scenario.name.escape_default(),
        speeds = if rotors_are_nominal { ".of_nominal_speed()" } else { "" },
        count = constants.len(),
        constants = constants.join(", "),
        across = bytes(across),
        vertical = bytes(vertical),
        identity = board::identity(scenario),
        follows = board::may_follow_rotors(scenario),
        period = scenario.timing.period_us,
        mass = vehicle.mass,
        inertia = vector(&vehicle.inertia),
        gravity = vehicle.gravity,
        thrust_max = limits.thrust_max,
        torque_max = vector(&limits.torque_max),
    )
}

/// The law's constants by name.
fn constants(law: &LawParameters) -> Vec<String> {
    let named = |(constant, value): (Constant, f32)| format!("(\"{}\", {value:e})", constant.key);
    match law {
        LawParameters::Paper(PaperLaw { gains, .. }) => gains.entries().map(named).collect(),
        LawParameters::Extended(ExtendedLaw { parameters, .. }) => parameters.entries().map(named).collect(),
    }
}

/// The law's constants, and the configuration made of them.
fn law_source(law: &LawParameters) -> String {
    match law {
        LawParameters::Paper(PaperLaw { gains, thrust_floor }) => {
            let floor = thrust_floor.map_or(String::new(), |floor| format!("?.with_thrust_floor({floor:e})"));
            format!(
                "    use controller_core::gains::{{GainParameters, Gains}};
    let gains = Gains::new(GainParameters {{ {} }}, &vehicle)?;
    Configuration::new(vehicle, limits, gains, bounds)?.with_rotors(rotors){floor}
",
                fields(gains.entries())
            )
        }
        LawParameters::Extended(ExtendedLaw { parameters, actuators: ActuatorParameters { lag, delay } }) => format!(
            "    use controller_core::configuration::ExtendedLaw;
    use controller_core::extended::actuators::ActuatorParameters;
    use controller_core::extended::parameters::{{Extended, ExtendedParameters}};
    let parameters = Extended::new(ExtendedParameters {{ {} }}, &vehicle)?;
    let law = ExtendedLaw {{ parameters, actuators: ActuatorParameters {{ lag: {lag:e}, delay: {delay:e} }} }};
    Configuration::extended(vehicle, limits, law, bounds)?.with_rotors(rotors)
",
            fields(parameters.entries())
        ),
    }
}

fn rotor_source(rotor: &Rotor) -> String {
    let position = vector(&rotor.position);
    let spin = match rotor.spin {
        Spin::Clockwise => "Clockwise",
        Spin::CounterClockwise => "CounterClockwise",
    };
    let Rotor { thrust_coefficient, drag_coefficient, thrust_min, thrust_max, .. } = rotor;
    format!(
        "Rotor {{ position: {position}, spin: Spin::{spin}, thrust_coefficient: {thrust_coefficient:e}, \
         drag_coefficient: {drag_coefficient:e}, thrust_min: {thrust_min:e}, thrust_max: {thrust_max:e} }}"
    )
}

/// The fields of a struct of constants.
fn fields(constants: impl Iterator<Item = (Constant, f32)>) -> String {
    let written: Vec<String> = constants.map(|(constant, value)| format!("{}: {value:e}", constant.key)).collect();
    written.join(", ")
}

/// The elements of an array.
fn bytes(bytes: &[u8]) -> String {
    bytes.iter().map(u8::to_string).collect::<Vec<_>>().join(", ")
}

fn vector(v: &Vector3<f32>) -> String {
    format!("Vector3::new({:e}, {:e}, {:e})", v.x, v.y, v.z)
}

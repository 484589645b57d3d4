//! What a speed controller answers to a frame: how fast its motor turns, or how it is itself.
//!
//! An answer's 12 bits are `eeem mmmm mmmm`: m shifted left by e is the time of an electrical turn, us. A motor of p
//! poles turns mechanically once in p / 2 of those:
//!
//! ```text
//! w = 2 pi / (p / 2) / (period 1e-6)
//! ```
//!
//! A controller shifts no more than it must, so m's highest bit is set where e is not zero. What that leaves over are
//! the extended answers (EDT, bird-sanctuary/extended-dshot-telemetry, 2.0.0): e says which, m's 8 lower bits how much.
//! They come between the others, from controllers that were told to send them. All bits set are a motor at rest.

/// What an answer says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Answer {
    /// The time of an electrical turn, us.
    Period(u32),
    /// The motor stands still, or turns more slowly than 65 ms an electrical turn.
    AtRest,
    /// The controller's temperature, degrees Celsius.
    Temperature(u8),
    /// Its voltage, V.
    Voltage(f32),
    /// Its current, A.
    Current(u8),
    /// A number for those who write its firmware: the first or the second.
    Debug(u8, u8),
    /// How hard it is for it to keep the motor turning: 0 not at all, 255 it cannot. Before 2.0.0 a third number.
    Stress(u8),
    /// Its events, and its greatest stress: see [`Answer::DESYNCHRONISED`].
    Status(u8),
}

/// The answer of a motor at rest.
const AT_REST: u16 = 0xFFF;

/// Bits of m, and its highest.
const MANTISSA_BITS: u32 = 9;
const HIGHEST_BIT: u16 = 1 << (MANTISSA_BITS - 1);

/// V in one count.
const VOLTAGE_STEP_V: f32 = 0.25;

impl Answer {
    /// The bits of a status that report a motor that lost its step (a warning), or does not turn (an error).
    pub const DESYNCHRONISED: u8 = 1 << 6;
    /// See [`Self::DESYNCHRONISED`].
    pub const STALLED: u8 = 1 << 5;

    /// What 12 bits say; none for a turn in no time.
    pub fn from_bits(bits: u16) -> Option<Self> {
        let (exponent, mantissa) = (bits >> MANTISSA_BITS & 0b111, bits & (2 * HIGHEST_BIT - 1));
        let number = bits as u8;
        if bits == AT_REST {
            return Some(Self::AtRest);
        }
        if exponent == 0 || mantissa >= HIGHEST_BIT {
            let period = u32::from(mantissa) << exponent;
            return (period > 0).then_some(Self::Period(period));
        }
        Some(match exponent {
            1 => Self::Temperature(number),
            2 => Self::Voltage(f32::from(number) * VOLTAGE_STEP_V),
            3 => Self::Current(number),
            4 => Self::Debug(0, number),
            5 => Self::Debug(1, number),
            6 => Self::Stress(number),
            _ => Self::Status(number),
        })
    }

    /// Its 12 bits, as a controller has them: what is below a step is cut off.
    pub fn to_bits(self) -> u16 {
        let extended = |kind: u16, number: u8| kind << MANTISSA_BITS | u16::from(number);
        match self {
            Self::AtRest => AT_REST,
            Self::Period(period) => {
                let exponent = (u32::BITS - period.leading_zeros()).saturating_sub(MANTISSA_BITS);
                let whole = u16::try_from(period >> exponent).unwrap_or(AT_REST);
                if exponent < 8 { (exponent as u16) << MANTISSA_BITS | whole } else { AT_REST }
            }
            Self::Temperature(number) => extended(1, number),
            Self::Voltage(voltage) => extended(2, (voltage / VOLTAGE_STEP_V) as u8),
            Self::Current(number) => extended(3, number),
            Self::Debug(which, number) => extended(4 + u16::from(which.min(1)), number),
            Self::Stress(number) => extended(6, number),
            Self::Status(number) => extended(7, number),
        }
    }

    /// What a motor of so many `poles` that turns at `speed`, rad/s, has its controller say.
    pub fn of_speed(speed: f32, poles: f32) -> Self {
        let period = turn_us(poles) / speed;
        // A NaN, and a motor that stands still, are at rest.
        if period > 0.0 && period < 65_408.0 { Self::Period((period as u32).max(1)) } else { Self::AtRest }
    }

    /// The speed of a motor of so many `poles`, rad/s; none where the answer says something else.
    pub fn speed(self, poles: f32) -> Option<f32> {
        match self {
            Self::Period(period) => Some(turn_us(poles) / period as f32),
            Self::AtRest => Some(0.0),
            _ => None,
        }
    }
}

/// The time of an electrical turn at 1 rad/s, us.
fn turn_us(poles: f32) -> f32 {
    4e6 * core::f32::consts::PI / poles
}

#[cfg(test)]
mod tests;

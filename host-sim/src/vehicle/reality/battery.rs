//! The voltage that the motors have.
//!
//! An open-circuit voltage that falls with the charge, behind a resistance; motors and controllers of a constant
//! efficiency draw the electrical power P that the rotors' shafts need:
//!
//! ```text
//! E = E_empty + (E_full - E_empty) q / Q                    open circuit, V; zero once q = 0
//! P = sum k_m w_i^3 / efficiency = I V,   V = E - R I       W
//! I = 2 P / (E + sqrt(E^2 - 4 R P))                         the smaller current of the two, A
//! q' = -I                                                   A s
//! ```
//!
//! Where 4 R P > E^2 the battery cannot deliver P: it gives all it can, I = E / 2R, V = E / 2. The voltage is held over
//! each plant step.
//!
//! Sources: the battery, Gazebo's LinearBatteryPlugin (V = e_0 + e_1 (1 - q / Q) - R I), a Rint model as in H. He, R.
//! Xiong, J. Fan, *Evaluation of Lithium-Ion Battery Equivalent Circuit Models*, Energies 4(4), 2011; power per rotor,
//! D. Shi, X. Dai, X. Zhang, Q. Quan, *A Practical Performance Evaluation Method for Electric Multicopters*, IEEE/ASME
//! T. Mech. 22(3), 2017.

use scenario::reality::battery::Battery;

/// A battery at some charge, under some load.
#[derive(Debug, Clone)]
pub struct BatteryState {
    battery: Battery,
    /// A s.
    charge: f64,
    /// V.
    voltage: f64,
    /// A.
    current: f64,
}

impl BatteryState {
    /// As it is before anything is drawn from it.
    pub fn new(battery: &Battery) -> Self {
        let charge = battery.charge * battery.capacity;
        let mut state = Self { battery: *battery, charge, voltage: 0.0, current: 0.0 };
        state.voltage = state.open_circuit();
        state
    }

    /// Under load, V.
    pub fn voltage(&self) -> f64 {
        self.voltage
    }

    /// A.
    pub fn current(&self) -> f64 {
        self.current
    }

    /// V / V_0.
    pub fn ratio(&self) -> f64 {
        self.voltage / self.battery.nominal_voltage
    }

    /// E, V.
    fn open_circuit(&self) -> f64 {
        let Battery { full_voltage, empty_voltage, capacity, .. } = self.battery;
        if self.charge > 0.0 { empty_voltage + (full_voltage - empty_voltage) * self.charge / capacity } else { 0.0 }
    }

    /// Gives the shafts `power`, W, for `seconds`.
    pub fn draw(&mut self, power: f64, seconds: f64) {
        let Battery { resistance, efficiency, .. } = self.battery;
        let (open, power) = (self.open_circuit(), power / efficiency);
        if open == 0.0 {
            (self.voltage, self.current) = (0.0, 0.0);
            return;
        }
        let square = open * open - 4.0 * resistance * power;
        self.current = if square > 0.0 { 2.0 * power / (open + square.sqrt()) } else { 0.5 * open / resistance };
        self.voltage = open - resistance * self.current;
        self.charge = (self.charge - self.current * seconds).max(0.0);
    }
}

#[cfg(test)]
mod tests;

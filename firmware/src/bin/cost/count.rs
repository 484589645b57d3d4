//! What a kind of call costs: instructions, counted.

use cortex_m_semihosting::hprintln;

/// Clocks of the boards.
pub const CLOCKS_MHZ: [f64; 2] = [168.0, 400.0];

/// Mean and worst of one kind of call.
#[derive(Default)]
pub struct Cost {
    sum: f64,
    count: u32,
    worst: f64,
}

impl Cost {
    /// Counts one more.
    pub fn add(&mut self, instructions: f64) {
        self.sum += instructions;
        self.count += 1;
        self.worst = self.worst.max(instructions);
    }

    /// Instructions of a call, on the mean.
    pub fn mean(&self) -> f64 {
        self.sum / f64::from(self.count)
    }

    /// Instructions of the longest call.
    pub fn worst(&self) -> f64 {
        self.worst
    }

    /// As a line of the table.
    pub fn print(&self, what: &str) {
        let mean = self.mean();
        let [bolt, h743] = CLOCKS_MHZ.map(|clock| mean / clock);
        hprintln!("{:<42} {:>10.1} {:>10.0} {:>9.2} {:>9.2}", what, mean, self.worst, bolt, h743);
    }
}

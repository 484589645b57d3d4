//! The arguments of `tune`, in clap's terms, and their checks.

use clap::Args;
use host_sim::studies::tune::effort::Effort;
use host_sim::studies::tune::requirements::{RECOVERY_MAX_S, RECOVERY_MIN_S, Requirements};
use scenario::stability::LoopMargin;
use std::path::PathBuf;

/// The arguments of a search for gains.
#[derive(Args)]
pub struct TuneArguments {
    /// Scenario file: vehicle, limits, rotors, delay, reference; its constants, or the formulas', are where the search
    /// starts
    pub file: PathBuf,
    /// Scenario file to write [default: <name>-tuned.toml]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Least margin of every inequality, as a fraction
    #[arg(long, default_value_t = Requirements::default().margin)]
    margin: f64,
    /// Least gain margin of every sampled loop, as a factor, 1.5 or more: at the actuators, and of k_p and k_v together
    #[arg(long, default_value_t = Requirements::default().loops.gain)]
    gain_margin: f64,
    /// Least delay margin of every sampled loop, ms, 2 or more
    #[arg(long, default_value_t = 1e3 * Requirements::default().loops.delay)]
    delay_margin: f64,
    /// Greatest position error of the file's own flight in its last quarter, m
    #[arg(long, default_value_t = Requirements::default().position_error)]
    position_error: f64,
    /// Greatest norm of its modified Rodrigues parameters there
    #[arg(long, default_value_t = Requirements::default().mrp_error)]
    mrp_error: f64,
    /// How long a recovery from upside down may take, s, 2 or more; its last quarter must be still
    #[arg(long, default_value_t = Requirements::default().recovery)]
    recovery: f64,
    /// Keep the paper's thrust T = m |u|: no thrust projection
    #[arg(long)]
    no_projection: bool,
    /// Generations
    #[arg(long, default_value_t = Effort::default().generations)]
    pub generations: u32,
    /// Candidates of each generation, 4 to 1000
    #[arg(long, default_value_t = Effort::default().population)]
    pub population: usize,
    /// Seed of the search
    #[arg(long, default_value_t = Effort::default().seed)]
    pub seed: u64,
    /// Also report the largest factor by which the reference bounds could grow with these gains
    #[arg(long)]
    pub widen: bool,
}

/// The end of `tune --help`.
pub const HELP: &str = "\
A search starts from the file's constants, or from those that follow from the
vehicle's numbers, and never ends with worse ones: the start is judged first.
Under the extended law fourteen constants are searched and the others follow
from them, unless the file has them; only constants that do not follow from the
vehicle's numbers are written. Under the paper's law nine gains and the thrust
floor are searched.

Every candidate must meet all of these:
- the certificate holds, each inequality with --margin to spare;
- the sampled loops bear --gain-margin, its inverse, and --delay-margin more
  delay; so do they with k_p and k_v times --gain-margin;
- from upside down it is within 0.1 m of its place for good before three
  quarters of --recovery are over;
- a law that estimates leaves at most 10 mm of a gust;
- no limit cuts a command, in any trial;
- the file's own flight reaches its reference in time, and ends with at most
  --position-error and --mrp-error.

The search minimises the weighted sum of the figures in the table that it
prints, before and after:
the figures of `compare`. Most are flown on four models: the vehicle as the file
says, and with mass, thrust, centre of mass, lag and delay off. The same file
and seed give the same constants. Progress shows on stderr, through a pipe as
well.

Exit status 0: the start or better is written; 1: no candidate met the
requirements, and the line on stderr says which one the closest candidate
failed. Interrupted, a search writes the best it has found so far and says so;
the exit status is then 129, 130 or 143. If it has found nothing yet, it writes
nothing.";

impl TuneArguments {
    /// The requirements on gains.
    ///
    /// # Errors
    /// Names the argument that asks for something impossible, or for less than what may fly.
    pub fn requirements(&self) -> Result<Requirements, String> {
        let least = LoopMargin::FLYABLE_MIN;
        let positive = [("--position-error", self.position_error), ("--mrp-error", self.mrp_error)];
        if let Some((name, value)) = positive.into_iter().find(|(_, value)| !(*value > 0.0 && value.is_finite())) {
            return Err(format!("{name}: must be greater than zero and finite, found {value}"));
        }
        if !(RECOVERY_MIN_S..=RECOVERY_MAX_S).contains(&self.recovery) {
            let allowed = format!("must be from {RECOVERY_MIN_S} to {RECOVERY_MAX_S} s");
            return Err(format!("--recovery: {allowed}, found {}", self.recovery));
        }
        if !(0.0..1.0).contains(&self.margin) {
            return Err(format!("--margin: must be from 0 to below 1, found {}", self.margin));
        }
        let margins = [
            ("--gain-margin", self.gain_margin, least.gain, ""),
            ("--delay-margin", self.delay_margin, 1e3 * least.delay, " ms"),
        ];
        for (name, found, least, unit) in margins {
            if !(found >= least && found.is_finite()) {
                return Err(format!(
                    "{name}: must be at least {least}{unit}, which certify asks for, and finite; found {found}"
                ));
            }
        }
        if self.generations == 0 {
            return Err("--generations: must be at least 1, found 0".to_owned());
        }
        if !(4..=1000).contains(&self.population) {
            return Err(format!("--population: must be from 4 to 1000, found {}", self.population));
        }
        Ok(Requirements {
            margin: self.margin,
            loops: LoopMargin { gain: self.gain_margin, delay: 1e-3 * self.delay_margin },
            position_error: self.position_error,
            mrp_error: self.mrp_error,
            recovery: self.recovery,
            projection: !self.no_projection,
        })
    }
}

//! The arguments of `certify`, in clap's terms, and their checks.

use clap::Args;
use host_sim::studies::recovery::Orders;
use host_sim::studies::recovery::start::Sets;
use std::path::PathBuf;

/// As many as a campaign may have.
const FLIGHTS_MAX: u64 = 1_000_000_000;

/// Which questions about a scenario to answer.
#[derive(Args)]
pub struct CertifyArguments {
    /// Scenario file [default: the paper's, built in]
    pub file: Option<PathBuf>,
    /// Print the law's constants and the reference's bounds instead, as sections to paste into a scenario file
    #[arg(long)]
    pub show: bool,
    /// Work every inequality out once more, each operation rounded outwards, and show both figures
    #[arg(long, conflicts_with = "show")]
    pub rigorous: bool,
    /// Say instead how much height a recovery costs, how long it takes, and how near the vehicle then stays
    #[arg(long, conflicts_with_all = ["show", "rigorous"])]
    pub recovery: bool,
    /// Recoveries from random starts
    #[arg(long, requires = "recovery", default_value_t = Orders::default().flights)]
    flights: u64,
    /// Flights of each search for something worse: one for H, one for T, one for r
    #[arg(long, requires = "recovery", default_value_t = Orders::default().search)]
    search: u64,
    /// Seed of all starts
    #[arg(long, requires = "recovery", default_value_t = Orders::default().seed)]
    seed: u64,
    /// Greatest turning at the start of a recovery, rad/s
    #[arg(long, requires = "recovery", default_value_t = Sets::default().spin)]
    spin: f64,
    /// Greatest speed there, m/s
    #[arg(long, requires = "recovery", default_value_t = Sets::default().speed)]
    speed: f64,
    /// Greatest force per mass during a recovery, along x, y or z, changing at any time, m/s^2
    #[arg(long, requires = "recovery", default_value_t = Sets::default().gust)]
    gust: f64,
    /// By how much the rotors' lag may be off while the law does not know, as a fraction
    #[arg(long, requires = "recovery", default_value_t = Sets::default().lag)]
    lag_error: f64,
    /// By how much each moment of inertia may be off while the law does not know, as a fraction
    #[arg(long, requires = "recovery", default_value_t = Sets::default().inertia)]
    inertia_error: f64,
}

/// What `certify --help` ends with.
pub const HELP: &str = "\
CERTIFIED means two things. The commands are proven to stay within every limit,
whatever the vehicle does: that is the certificate, and it says nothing about
stability. And small motions about hover die out at this rate, delay and rotor
lag: that is an analysis of the sampled loops, each of which must be stable with
1.5 times its gain, with 1 / 1.5 of it, and with 2 ms more delay.
docs/certificate.md and docs/sampled-loop.md explain the tables.

Under the extended law the report ends with the vehicle's abilities, and with
the inequality that limits it or those that fail: their meaning, and which
number to change in which direction. Constants that the file leaves out follow
from the vehicle's numbers; --show prints them all.

--rigorous adds what rounding can have changed, in shares of each figure, and
exits with 1 if that can have decided an inequality: then CERTIFIED rests on the
last digits of double precision.

--recovery says instead what a recovery to a hover costs, from any attitude, in
three lines: H, the height that it may lose; T, the time until the vehicle is
back for good; r, how near it then stays. S is what they are for; --spin to
--inertia-error change it. r is proven, for gusts up to some strength, which it
names. H and T are not proven for every start: each is the worst of random
flights and of a search that climbs from the worst of these, with what the
random flights prove of starts drawn like them. So the exit status is 1, with
the reason on stderr. The same seed gives the same flights, whatever the number
of threads. docs/recovery.md has the proof, and what it does not speak of.

  host-sim certify vehicles/hummingbird.toml --recovery --flights 100000";

impl CertifyArguments {
    /// What recoveries have to bear.
    ///
    /// # Errors
    /// Names the argument that is refused.
    pub fn sets(&self) -> Result<Sets, String> {
        let ranges = [
            ("--spin", self.spin, 1000.0, " rad/s"),
            ("--speed", self.speed, 1000.0, " m/s"),
            ("--gust", self.gust, 100.0, " m/s^2"),
            ("--lag-error", self.lag_error, 0.9, ""),
            ("--inertia-error", self.inertia_error, 0.9, ""),
        ];
        for (name, found, most, unit) in ranges {
            if !(0.0..=most).contains(&found) {
                return Err(format!("{name}: must be from 0 to {most}{unit}, found {found}"));
            }
        }
        let Self { spin, speed, gust, lag_error: lag, inertia_error: inertia, .. } = *self;
        Ok(Sets { spin, speed, gust, lag, inertia })
    }

    /// How many recoveries.
    ///
    /// # Errors
    /// Names the argument that is refused.
    pub fn orders(&self) -> Result<Orders, String> {
        let Self { flights, search, seed, .. } = *self;
        for (name, found, least) in [("--flights", flights, 1), ("--search", search, 0)] {
            if !(least..=FLIGHTS_MAX).contains(&found) {
                return Err(format!("{name}: must be from {least} to {FLIGHTS_MAX}, found {found}"));
            }
        }
        Ok(Orders { flights, search, seed })
    }
}

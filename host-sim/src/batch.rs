//! Flights side by side, one tick of all of them at a time: their bodies move together in the processor's vector
//! registers.
//!
//! ```text
//! each flight   state -> sensors                                one after the other
//! each flight   law -> wrench, clipped                          likewise, on one reference for all
//! all at once   plant steps until the next tick                 plant::rows
//! ```
//!
//! Every flight has the bits that it has alone ([`Flight::brief_tick`]), whatever flies beside it and whatever
//! registers there are.
//!
//! What flies so: vehicles of one model on one reference, without rotors, delay, estimator, or anything else that
//! stands between the wrench and the body. Everything else flies alone.

use crate::flight::{Brief, Flight, FlightError};
use crate::plant::body::Body;
use crate::plant::rows::Rows;
use controller_core::state::{State, Wrench};
use pulp::Arch;

/// Flights under way, side by side.
#[derive(Clone)]
pub struct Batch {
    members: Vec<Member>,
    rows: Rows,
    body: Body,
    steps_per_tick: u32,
}

/// A flight among others.
#[derive(Clone)]
struct Member {
    flight: Flight,
    stage: Stage,
}

/// How far a flight's tick is.
#[derive(Clone, Copy)]
enum Stage {
    /// It waits for the next.
    Waiting,
    /// The law is told this.
    Told(State),
    /// The law has commanded this, of which the limits may have cut something.
    Commanded(Wrench, bool),
    /// The flight could not go on.
    Ended,
}

impl Batch {
    /// These flights side by side, on registers of `processor`.
    ///
    /// # Errors
    /// The flights themselves, if they cannot fly so.
    pub fn new(processor: Arch, flights: Vec<Flight>) -> Result<Self, Vec<Flight>> {
        let alike = |first: &Flight| {
            let bare = first.bare()?;
            let fits = |flight: &Flight| flight.bare() == Some(bare) && flight.shares_reference(first);
            flights.iter().all(fits).then(|| (bare.0.clone(), bare.1))
        };
        let Some((body, steps_per_tick)) = flights.first().and_then(alike) else {
            return Err(flights);
        };
        let mut rows = Rows::new(processor, flights.len());
        flights.iter().enumerate().for_each(|(number, flight)| rows.place(number, flight.state()));
        let members = flights.into_iter().map(|flight| Member { flight, stage: Stage::Waiting }).collect();
        Ok(Self { members, rows, body, steps_per_tick })
    }

    /// One control tick of every flight that goes on, and their motion until the next. `observe` sees each by its
    /// number, as [`Flight::brief_tick`] would give it; of a flight that could not go on it sees nothing after the
    /// error.
    pub fn tick(&mut self, mut observe: impl FnMut(usize, Result<&Brief, FlightError>)) {
        let going_on = |member: &&Member| !matches!(member.stage, Stage::Ended);
        let Some(reference) = self.members.iter().find(going_on).map(|member| member.flight.reference()) else {
            return;
        };
        // By themselves: a processor waits for numbers that it has written one by one, if it is to read two at once
        // right away.
        for (number, Member { flight, stage }) in self.members.iter_mut().enumerate() {
            if matches!(stage, Stage::Waiting) {
                *stage = flight.measured().map_or_else(|error| Stage::ended(error, number, &mut observe), Stage::Told);
            }
        }
        for (number, Member { flight, stage }) in self.members.iter_mut().enumerate() {
            let Stage::Told(told) = stage else { continue };
            *stage = match flight.set_off(told, &reference) {
                Ok((wrench, asked)) => {
                    let (thrust, torque, clipped) = self.body.clipped(&asked);
                    self.rows.command(number, thrust, &torque);
                    Stage::Commanded(wrench, clipped)
                }
                Err(error) => Stage::ended(error, number, &mut observe),
            };
        }
        self.rows.advance(&self.body, self.steps_per_tick);
        for (number, Member { flight, stage }) in self.members.iter_mut().enumerate() {
            if let Stage::Commanded(wrench, clipped) = *stage {
                let brief = flight.arrive(self.rows.state(number), &reference, (wrench, clipped));
                *stage = if brief.is_ok() { Stage::Waiting } else { Stage::Ended };
                observe(number, brief.as_ref().map_err(|error| *error));
            }
        }
    }
}

impl Stage {
    /// The end of flight `number`, which `observe` hears of.
    #[cold]
    fn ended(error: FlightError, number: usize, observe: &mut impl FnMut(usize, Result<&Brief, FlightError>)) -> Self {
        observe(number, Err(error));
        Self::Ended
    }
}

#[cfg(test)]
mod tests;

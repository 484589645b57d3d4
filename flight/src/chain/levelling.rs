//! What the law would do about a lean, of a vehicle that is tilted by hand on the bench; nothing of it is flown.

use super::Chain;
use crate::lean::Lean;
use crate::tilt::heading;
use controller_core::allocation::Thrusts;
use controller_core::heading::Heading;
use controller_core::law::Command;
use controller_core::reference::Reference;
use controller_core::state::State;
use nalgebra::Vector3;

impl Chain<'_> {
    /// The thrusts with which the law, as after a reset, would level the vehicle in hover, each over their mean, in the
    /// rotors' order; none where it cannot. Only between flights: the law is reset by it.
    #[inline(never)] // beside the tick's own path to the law, not on top of it
    pub fn levelling(&mut self, lean: &Lean) -> Option<Thrusts> {
        let Lean { attitude, angular_velocity } = *lean;
        let rest = Vector3::zeros();
        let state = State { position: rest, velocity: rest, attitude, angular_velocity };
        let reference = Reference::resting(rest, heading(&attitude).unwrap_or(Heading::FORWARD));
        self.law.reset();
        let commanded = self.law.command(&state, &reference);
        let own = self.law.commands().cloned();
        self.law.reset();
        let Command { wrench, .. } = commanded.ok()?;
        let mut thrusts = own.or_else(|| Some(self.mixer.allocate(&wrench).ok()?.thrusts))?;
        let mean = thrusts.iter().sum::<f32>() / thrusts.len() as f32;
        thrusts.iter_mut().for_each(|thrust| *thrust /= mean);
        // A sum of no thrust divides to no number.
        thrusts.iter().all(|share| share.is_finite()).then_some(thrusts)
    }
}

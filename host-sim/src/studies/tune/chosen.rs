//! The chosen constants of the extended law: the few from which all others follow by the formulas.

use controller_core::extended::defaults::{self, Airframe, Given, NOTHING_GIVEN};
use controller_core::extended::parameters::ExtendedParameters;

/// A few of `parameters` from which the formulas for `airframe` make all of them, to the bit.
pub fn chosen(airframe: &Airframe, parameters: &ExtendedParameters) -> Given {
    let wanted = parameters.values();
    let differing = |given: &Given| {
        let made = defaults::constants(airframe, given).values();
        let places = (0..wanted.len()).filter(|&place| made[place] != wanted[place]);
        places.collect::<Vec<usize>>()
    };
    let with = |given: &Given, place: usize| {
        let mut more = *given;
        more[place] = Some(wanted[place]);
        more
    };
    let mut given = NOTHING_GIVEN;
    // Each time the constant from which most others follow.
    loop {
        let candidates = differing(&given).into_iter().map(|place| with(&given, place));
        match candidates.min_by_key(|more| differing(more).len()) {
            Some(more) => given = more,
            None => break,
        }
    }
    // Constants that a later choice made superfluous.
    loop {
        let fewer = (0..given.len()).filter(|&place| given[place].is_some()).map(|place| {
            let mut fewer = given;
            fewer[place] = None;
            fewer
        });
        match fewer.into_iter().find(|fewer| differing(fewer).is_empty()) {
            Some(fewer) => given = fewer,
            None => return given,
        }
    }
}

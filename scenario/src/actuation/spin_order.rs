//! Why rotors cannot produce every wrench, in words of where they stand and how they turn.
//!
//! Along a line they give no torque about it. Elsewhere it is the spins: a rotor's drag turns the body about z, and
//! where that turn always comes with thrust, roll or pitch, there is no yaw alone. Round the vehicle neighbours must
//! turn opposite ways.

use crate::section::FieldError;
use controller_core::allocation::{Rotor, Rotors, Spin};

/// The error of rotors that [`Rotors::new`] refused, with spins that it takes if there are any at these positions.
#[must_use]
pub fn refused(list: &[Rotor]) -> FieldError {
    const CANNOT: &str = "cannot produce thrust and all three torques independently";
    let order = round(list);
    let Some(better) = alternating(list, &order) else {
        let problem = format!("{CANNOT}: the rotors stand along one line, or where no spins that alternate can yaw");
        return FieldError::new("rotors.position", problem);
    };
    let next = order.iter().zip(order.iter().cycle().skip(1));
    let alike = next
        .filter(|(one, next)| list[**one].spin == list[**next].spin)
        .map(|(one, next)| (one.min(next) + 1, one.max(next) + 1));
    let (one, next) = alike.min().unwrap_or((1, 2));
    let what = if list.iter().all(|rotor| rotor.spin == list[0].spin) {
        "all rotors turn the same way, so that none turns the vehicle against them".to_owned()
    } else {
        format!(
            "rotors {one} and {next}, which are neighbours, turn the same way, so that yaw comes with roll or pitch"
        )
    };
    let spins = better.iter().map(|spin| if *spin == Spin::Clockwise { "\"cw\"" } else { "\"ccw\"" });
    let spins = spins.collect::<Vec<_>>().join(", ");
    let problem = format!("{CANNOT}: {what}; neighbours must turn opposite ways: at these positions [{spins}] can yaw");
    FieldError::new("rotors.spin", problem)
}

/// The rotors' numbers in order round the vehicle.
fn round(list: &[Rotor]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..list.len()).collect();
    let angle = |rotor: &Rotor| rotor.position.y.atan2(rotor.position.x);
    order.sort_by(|one, other| angle(&list[*one]).total_cmp(&angle(&list[*other])));
    order
}

/// Spins that alternate in this `order`, the first rotor's as it is; none if the rotors cannot do with these either.
fn alternating(list: &[Rotor], order: &[usize]) -> Option<Vec<Spin>> {
    let mut spins = vec![Spin::Clockwise; list.len()];
    for (place, rotor) in order.iter().enumerate() {
        spins[*rotor] = if place % 2 == 0 { Spin::Clockwise } else { Spin::CounterClockwise };
    }
    if spins.first()? != &list.first()?.spin {
        let turned = |spin: &Spin| if *spin == Spin::Clockwise { Spin::CounterClockwise } else { Spin::Clockwise };
        spins = spins.iter().map(turned).collect();
    }
    let better: Vec<Rotor> = list.iter().zip(&spins).map(|(rotor, spin)| Rotor { spin: *spin, ..*rotor }).collect();
    Rotors::new(&better).is_ok().then_some(spins)
}

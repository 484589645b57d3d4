//! `[reference_bounds]`: Omega_r, the references a certificate is to cover. Left out, they are under the extended law
//! those that the vehicle can fly ([`controller_core::certificate::airframe::flyable`]): the bounds of streams and
//! missions, since what `[reference]` has is judged [along itself](crate::along). Under the paper's law they are the
//! bounds of `[reference]`.
//!
//! ```toml
//! [reference_bounds]
//! horizontal_speed = 5.0             # K_v12, m/s
//! horizontal_acceleration = 2.5      # K_a12, m/s^2, Euclidean
//! vertical_acceleration = 0.5        # K_a3, m/s^2
//! jerk = 4.0                         # K_j, m/s^3, Euclidean
//! snap = 7.0                         # K_s, m/s^4, Euclidean
//! heading_rate = 1.4                 # K_nu', rad/s
//! heading_second_derivative = 2.0    # K_nu'', 1/s^2: sqrt(psi''^2 + psi'^4)
//! ```
//!
//! Keys that are left out follow likewise, unless that were zero. Under the paper's law none may be less than the
//! scenario's own reference takes, and `horizontal_speed` is 5 m/s where that is more.

use crate::constants;
use crate::section::{FieldError, Section};
use crate::trajectory::stretch::stretch;
use controller_core::constants::Constant;
use controller_core::reference::ReferenceBounds;

/// The least K_v12 where the file leaves it out, m/s: what the governor allows.
pub const DEFAULT_SPEED_M_PER_S: f32 = 5.0;

/// Reads `[reference_bounds]`, which must be no less than `own`; `default` gives the bounds if the section is left out.
///
/// # Errors
/// Names the bound that is missing, negative, or below what the reference takes.
pub fn read_bounds(
    root: &Section,
    own: &ReferenceBounds,
    default: impl Fn() -> ReferenceBounds,
) -> Result<ReferenceBounds, FieldError> {
    let Some(section) = root.optional_section("reference_bounds")? else {
        return Ok(default());
    };
    section.allow(&constants::keys(&ReferenceBounds::TABLE, "reference_bounds"))?;
    let mut values = default().values();
    for (value, (Constant { key, .. }, taken)) in values.iter_mut().zip(own.entries()) {
        // A bound of zero would let nothing fly that only this file knows.
        let followed = *value > 0.0 && !section.has(key);
        *value = if followed { *value } else { section.number(key)? as f32 };
        if *value < taken {
            let slower = stretch(own, &given(&section)?);
            let remedy = format!("; {slower:.2} times as slowly it fits");
            let problem = format!("must be at least {taken}, which [reference] takes, found {value}{remedy}");
            return Err(FieldError::new(section.path_of(key), problem));
        }
    }
    ReferenceBounds::from_values(values).validated().map_err(|error| root.refused(&error))
}

/// All bounds that the section has; the others bound nothing.
fn given(section: &Section) -> Result<ReferenceBounds, FieldError> {
    let mut values = [f32::INFINITY; ReferenceBounds::COUNT];
    for (value, Constant { key, .. }) in values.iter_mut().zip(ReferenceBounds::TABLE) {
        if section.has(key) {
            *value = section.number(key)? as f32;
        }
    }
    Ok(ReferenceBounds::from_values(values))
}

#[cfg(test)]
mod tests;

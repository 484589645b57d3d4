//! `[ground]`: level ground under a flight.
//!
//! ```toml
//! [ground]
//! height = 0.0                         # m, of the vehicle's origin when it stands; left out: 0
//! ```
//!
//! A flight that starts at that height and does not rise starts standing. `hil` has its own ground, always at zero.

use super::numbers::Allowed;
use crate::body::BodyState;
use crate::section::{FieldError, Section};

/// Level ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Of the vehicle's origin when it stands, m.
    pub height: f64,
}

/// Reads `[ground]` under a flight from `initial`.
///
/// # Errors
/// Names the field that is refused; `initial.position` if the flight starts below the ground.
pub fn read(root: &Section, initial: &BodyState) -> Result<Option<Ground>, FieldError> {
    let Some(section) = root.optional_section("ground")? else {
        return Ok(None);
    };
    section.allow(&["height"])?;
    let height = Allowed::new(-1e4..=1e4, "m").number_or(&section, "height", 0.0)?;
    let start = initial.position.z;
    if start < height {
        let problem = format!("must not be below ground.height = {height} m, found {start} m of height");
        return Err(FieldError::new("initial.position", problem));
    }
    Ok(Some(Ground { height }))
}

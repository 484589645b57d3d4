//! `[ground]`: level ground under a flight.
//!
//! A flight that starts at that height and does not rise starts standing. `hil` has its own ground, always at zero.

use crate::body::BodyState;
use crate::key::{Bounds, Key, Layout};
use crate::section::{FieldError, Section};

/// Level ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Of the vehicle's origin when it stands, m.
    pub height: f64,
}

/// The keys of `[ground]`.
pub const LAYOUT: Layout = Layout {
    name: "ground",
    about: "Level ground.",
    keys: &[Key::number("height", Bounds::between(-1e4, 1e4, "m"), "Of the vehicle's origin when it stands.").or(0.0)],
};

/// Reads `[ground]` under a flight from `initial`.
///
/// # Errors
/// Names the field that is refused; `initial.position` if the flight starts below the ground.
pub fn read(root: &Section, initial: &BodyState) -> Result<Option<Ground>, FieldError> {
    let Some(section) = root.open(&LAYOUT)? else {
        return Ok(None);
    };
    let height = section.number("height")?;
    let start = initial.position.z;
    if start < height {
        let problem = format!("must not be below ground.height = {height} m, found {start} m of height");
        return Err(FieldError::new("initial.position", problem));
    }
    Ok(Some(Ground { height }))
}

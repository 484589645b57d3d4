//! Frames of SDF: links, joints, frames and models by their names, and where they stand.
//!
//! A name counts within its model; those of a nested model have its name before them, `a::b::link`. A pose is relative
//! to its model's frame, a joint's to its child link's, a frame's to what it is attached to; `relative_to` says
//! otherwise, whether that stands before or behind in the file. `placement_frame` is the frame of a model that its pose
//! is of. Where a name leaves models out, as older files do, it must be clear without them.

use nalgebra::Isometry3;
use std::collections::BTreeMap;

/// Between the names of models.
const SCOPE_SEPARATOR: &str = "::";
/// The most frames of a vehicle.
const FRAMES_MAX: usize = 2000;
/// The longest chain of frames that are relative to each other.
const CHAIN_MAX: usize = 64;

/// Where something stands.
pub struct Stands {
    /// In the frame that it is relative to.
    pub pose: Isometry3<f64>,
    /// The name of that frame in the file; none for [`frame`](Self::frame).
    pub relative_to: Option<String>,
    /// The whole name of the model in which that name counts.
    pub model: String,
    /// The whole name of the frame that is meant without it: the model's own, or that of what is merged into it.
    pub frame: String,
    /// The frame of a model that the pose is of, if not the model's own.
    pub placement_frame: Option<String>,
}

/// Every frame by its whole name. The vehicle's own has an empty one.
#[derive(Default)]
pub struct Frames(BTreeMap<String, Stands>);

impl Frames {
    /// The whole name of what is called `name` in `model`.
    #[must_use]
    pub fn whole_name(model: &str, name: &str) -> String {
        if model.is_empty() { name.to_owned() } else { format!("{model}{SCOPE_SEPARATOR}{name}") }
    }

    /// Adds a frame by its whole name.
    ///
    /// # Errors
    /// If there is one of this name, or too many.
    pub fn add(&mut self, whole_name: String, stands: Stands) -> Result<(), String> {
        if self.0.len() >= FRAMES_MAX {
            return Err(format!("more than {FRAMES_MAX} links, joints, frames and models"));
        }
        match self.0.insert(whole_name, stands) {
            None => Ok(()),
            Some(_) => Err("there is another link, joint, frame or model of this name".to_owned()),
        }
    }

    /// Whether there is a frame of this whole name.
    #[must_use]
    pub fn contains(&self, whole_name: &str) -> bool {
        self.0.contains_key(whole_name)
    }

    /// The whole name of what `model` calls `name`; `kind` is what errors call it.
    ///
    /// # Errors
    /// If nothing is called that, or several are where the name leaves models out.
    pub fn find(&self, model: &str, name: &str, kind: &str) -> Result<&str, String> {
        let whole = Self::whole_name(model, name);
        if let Some((found, _)) = self.0.get_key_value(&whole) {
            return Ok(found);
        }
        // LINK from outside its model, or MODEL::LINK from within.
        let mut rest = Some(name);
        while let Some(ending) = rest {
            let within = format!("{SCOPE_SEPARATOR}{ending}");
            let mut candidates = self.0.keys().filter(|whole| *whole == ending || whole.ends_with(&within));
            match (candidates.next(), candidates.next()) {
                (Some(one), None) => return Ok(one),
                (Some(one), Some(other)) => return Err(format!("{name:?} may be {one} or {other}: write which")),
                (None, _) => rest = ending.split_once(SCOPE_SEPARATOR).map(|(_, rest)| rest),
            }
        }
        Err(format!("there is no {kind} {name:?} in the model, nor in what it includes"))
    }

    /// Where the frame of this whole name stands in the vehicle's.
    ///
    /// # Errors
    /// Names the frame that is missing, or frames that are relative to each other in a circle.
    pub fn pose(&self, whole_name: &str) -> Result<Isometry3<f64>, String> {
        self.pose_in(whole_name, "", CHAIN_MAX)
    }

    /// Where `frame` stands in `outer`.
    fn pose_in(&self, frame: &str, outer: &str, left: usize) -> Result<Isometry3<f64>, String> {
        if frame == outer {
            return Ok(Isometry3::identity());
        }
        let stands = self.0.get(frame).ok_or_else(|| format!("{outer:?} is not relative to the frames in it"))?;
        let left = left.checked_sub(1).ok_or_else(|| {
            format!("{frame:?} is relative to more than {CHAIN_MAX} frames, or to itself in a circle")
        })?;
        let base = match stands.relative_to.as_deref() {
            None => stands.frame.as_str(),
            Some(name) => {
                self.find(&stands.model, name, "frame").map_err(|what| format!("relative_to={name:?}: {what}"))?
            }
        };
        let pose = self.pose_in(base, outer, left)? * stands.pose;
        match stands.placement_frame.as_deref() {
            None | Some("") => Ok(pose),
            Some(name) => {
                let placed = self.find(frame, name, "frame").map_err(|what| format!("placement_frame: {what}"))?;
                Ok(pose * self.pose_in(placed, frame, left)?.inverse())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stands(x: f64, relative_to: Option<&str>, model: &str) -> Stands {
        let (pose, relative_to) = (Isometry3::translation(x, 0.0, 0.0), relative_to.map(str::to_owned));
        Stands { pose, relative_to, model: model.to_owned(), frame: model.to_owned(), placement_frame: None }
    }

    fn frames(all: Vec<(&str, Stands)>) -> Frames {
        let mut frames = Frames::default();
        all.into_iter().for_each(|(name, stands)| frames.add(name.to_owned(), stands).unwrap());
        frames
    }

    fn x(frames: &Frames, name: &str) -> f64 {
        frames.pose(name).unwrap().translation.x
    }

    #[test]
    fn frames_stand_relative_to_others_whatever_their_order() {
        let frames = frames(vec![
            ("behind", stands(1.0, Some("arm::tip"), "")),
            ("arm", stands(10.0, None, "")),
            ("arm::tip", stands(0.5, Some("root"), "arm")),
            ("arm::root", stands(0.25, None, "arm")),
        ]);
        assert_eq!([x(&frames, "arm::root"), x(&frames, "arm::tip"), x(&frames, "behind")], [10.25, 10.75, 11.75]);
    }

    #[test]
    fn a_model_stands_by_its_placement_frame() {
        let placed = Stands { placement_frame: Some("mount".to_owned()), ..stands(10.0, None, "") };
        let frames = frames(vec![("arm", placed), ("arm::mount", stands(3.0, None, "arm"))]);
        assert_eq!([x(&frames, "arm"), x(&frames, "arm::mount")], [7.0, 10.0]);
    }

    #[test]
    fn a_name_without_its_models_must_be_clear() {
        let both = frames(vec![
            ("imu", stands(0.0, None, "")),
            ("imu::link", stands(0.0, None, "imu")),
            ("mag", stands(0.0, None, "")),
            ("mag::link", stands(0.0, None, "mag")),
            ("mag::coil", stands(0.0, None, "mag")),
        ]);
        assert_eq!(both.find("imu", "link", "link"), Ok("imu::link"));
        assert_eq!(both.find("", "coil", "link"), Ok("mag::coil"));
        assert_eq!(both.find("", "vehicle::mag::link", "link"), Ok("mag::link"));
        assert_eq!(both.find("", "link", "link").unwrap_err(), "\"link\" may be imu::link or mag::link: write which");
        assert!(both.find("", "rotor", "link").unwrap_err().starts_with("there is no link \"rotor\""));
    }

    #[test]
    fn circles_and_second_names_are_refused() {
        let mut circle = frames(vec![("a", stands(0.0, Some("b"), "")), ("b", stands(0.0, Some("a"), ""))]);
        assert!(circle.pose("a").unwrap_err().contains("in a circle"));
        assert!(circle.add("a".to_owned(), stands(0.0, None, "")).unwrap_err().contains("of this name"));
    }
}

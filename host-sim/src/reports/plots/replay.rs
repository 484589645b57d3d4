//! A flight as a moving picture: a GIF that needs no browser.
//!
//! Every picture but the first holds only the pixels that changed, and all share one table of colours: those of the
//! lines, and their mixtures with the ground at their rims.

use super::drawing::{Drawing, channels};
use super::path::{Pose, View, poses};
use crate::reports::report::plot::Color;
use crate::reports::report::track::Track;
use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};
use nalgebra::{UnitQuaternion, Vector3};
use std::borrow::Cow;
use std::collections::HashMap;

/// Width and height.
const SIZE_PIXELS: (u32, u32) = (480, 420);
const PICTURE_RATE_HZ: f64 = 20.0;
/// Each picture stands for this time.
const PICTURE_CENTISECONDS: u16 = 5;
const LAST_PICTURE_CENTISECONDS: u16 = 150;
/// Half the drawn vehicle's diagonal, as a share of the path's extent.
const DRAWN_ARM_SHARE: f64 = 0.055;
const DRAWN_COLORS: [Color; 7] =
    [Color::Ink, Color::Blue, Color::Vermilion, Color::Orange, Color::Shadow, Color::Grid, Color::Axis];
/// Steps from the ground to each colour.
const COLOR_STEPS: usize = 36;
/// The place in the table of a pixel that has not changed.
const UNCHANGED_ENTRY: u8 = 255;

/// What of a flight is shown, and how fast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// The first moment, s.
    pub from: f64,
    /// The last, s.
    pub to: f64,
    /// Seconds of flight in a second.
    pub speed: f64,
}

/// The track's vehicle in motion past `things`, lines in the world, as the bytes of a GIF.
///
/// # Errors
/// If the library refuses, which it does for no picture of this size.
pub fn gif(track: &Track, things: &[Vec<Vector3<f64>>], stretch: Stretch) -> Result<Vec<u8>, EncodingError> {
    let poses = poses(track);
    let row = |time: f64| ((time / track.step).max(0.0) as usize).min(poses.len().saturating_sub(1));
    let shown = poses.get(row(stretch.from)..=row(stretch.to)).unwrap_or_default();
    let view = view(shown, things);
    let mut bytes = Vec::new();
    let mut table = Table::new();
    let mut encoder = Encoder::new(&mut bytes, SIZE_PIXELS.0 as u16, SIZE_PIXELS.1 as u16, &table.colors())?;
    encoder.set_repeat(Repeat::Infinite)?;
    let pictures = (((stretch.to - stretch.from) / stretch.speed * PICTURE_RATE_HZ).ceil() as usize).max(1);
    let mut before: Option<Vec<u8>> = None;
    for number in 0..=pictures {
        let time = stretch.from + (stretch.to - stretch.from) * number as f64 / pictures as f64;
        let flown = row(time).saturating_sub(row(stretch.from)).min(shown.len().saturating_sub(1));
        let pixels = table.places(&picture(&view, things, shown, flown, number as f64 / pictures as f64));
        let mut frame = changed(&pixels, before.as_deref());
        frame.delay = if number == pictures { LAST_PICTURE_CENTISECONDS } else { PICTURE_CENTISECONDS };
        encoder.write_frame(&frame)?;
        before = Some(pixels);
    }
    drop(encoder);
    Ok(bytes)
}

/// The last of the poses, the path up to it and `things`, in a picture that also holds `around`.
#[must_use]
pub fn still(flown: &[Pose], things: &[Vec<Vector3<f64>>], around: &[Vector3<f64>]) -> Drawing {
    let held = [things.concat(), around.to_vec()];
    let mut drawing = Drawing::new(SIZE_PIXELS);
    draw(&mut drawing, &view(flown, &held), things, flown, flown.len().saturating_sub(1));
    drawing
}

/// A view of all poses and of all `things`.
fn view(poses: &[Pose], things: &[Vec<Vector3<f64>>]) -> View {
    let points = things.iter().flatten().map(|point| Pose {
        position: *point,
        asked: *point,
        attitude: UnitQuaternion::identity(),
    });
    let held: Vec<Pose> = poses.iter().copied().chain(points).collect();
    View::new(&held, SIZE_PIXELS, DRAWN_ARM_SHARE)
}

/// `things` and the flight up to one of the rows shown.
fn draw(drawing: &mut Drawing, view: &View, things: &[Vec<Vector3<f64>>], shown: &[Pose], row: usize) {
    view.draw_floor(drawing);
    view.draw_things(drawing, things);
    view.draw_paths(drawing, shown.get(..=row).unwrap_or_default(), shown);
    if let Some(pose) = shown.get(row) {
        view.draw_vehicle(drawing, pose);
    }
}

/// The flight up to one of the rows shown, and below it the share of the flight that is over.
fn picture(view: &View, things: &[Vec<Vector3<f64>>], shown: &[Pose], row: usize, over: f64) -> Drawing {
    let mut drawing = Drawing::new(SIZE_PIXELS);
    draw(&mut drawing, view, things, shown, row);
    let (left, right, y) = (20.0, f64::from(SIZE_PIXELS.0) - 20.0, f64::from(SIZE_PIXELS.1) - 12.0);
    drawing.stroke(vec![(left, y), (right, y)], Color::Grid, 3.0);
    drawing.stroke(vec![(left, y), (left + over * (right - left), y)], Color::Axis, 3.0);
    drawing
}

/// The smallest rectangle that holds what changed; within it what did not is left as it was.
fn changed(pixels: &[u8], before: Option<&[u8]>) -> Frame<'static> {
    let (width, height) = (SIZE_PIXELS.0 as usize, SIZE_PIXELS.1 as usize);
    let same = |place: usize| before.is_some_and(|before| before.get(place) == pixels.get(place));
    let different = |x: usize, y: usize| !same(y * width + x);
    let rows: Vec<usize> = (0..height).filter(|y| (0..width).any(|x| different(x, *y))).collect();
    let columns: Vec<usize> = (0..width).filter(|x| rows.iter().any(|y| different(*x, *y))).collect();
    // Where nothing changed one pixel says so.
    let (left, right) = (columns.first().copied().unwrap_or(0), columns.last().copied().unwrap_or(0));
    let (top, bottom) = (rows.first().copied().unwrap_or(0), rows.last().copied().unwrap_or(0));
    let places = (top..=bottom).flat_map(|y| (left..=right).map(move |x| y * width + x));
    let buffer: Vec<u8> = places.map(|place| if same(place) { UNCHANGED_ENTRY } else { pixels[place] }).collect();
    Frame {
        left: left as u16,
        top: top as u16,
        width: (right - left + 1) as u16,
        height: (bottom - top + 1) as u16,
        dispose: DisposalMethod::Keep,
        transparent: Some(UNCHANGED_ENTRY),
        buffer: Cow::Owned(buffer),
        ..Frame::default()
    }
}

/// The table of colours, and the place in it of each colour met so far.
struct Table {
    colors: Vec<[u8; 3]>,
    places: HashMap<[u8; 3], u8>,
}

impl Table {
    fn new() -> Self {
        let ground = channels(Color::Card);
        let mixed = |color: Color, step: usize| {
            let channels = channels(color);
            [0, 1, 2].map(|c| {
                let (from, to) = (usize::from(ground[c]), usize::from(channels[c]));
                ((from * (COLOR_STEPS - step) + to * step) / COLOR_STEPS) as u8
            })
        };
        let colors = DRAWN_COLORS.into_iter().flat_map(|color| (1..=COLOR_STEPS).map(move |step| mixed(color, step)));
        Self { colors: std::iter::once(ground).chain(colors).collect(), places: HashMap::new() }
    }

    fn colors(&self) -> Vec<u8> {
        let mut colors = self.colors.concat();
        colors.resize(3 * 256, 0);
        colors
    }

    /// Of each pixel the place of the nearest colour.
    fn places(&mut self, drawing: &Drawing) -> Vec<u8> {
        let Some(pixels) = drawing.pixels() else { return Vec::new() };
        let mut places = Vec::with_capacity(pixels.pixels().len());
        for pixel in pixels.pixels() {
            let color = [pixel.red(), pixel.green(), pixel.blue()];
            let colors = &self.colors;
            places.push(*self.places.entry(color).or_insert_with(|| {
                let distance =
                    |other: &[u8; 3]| (0..3).map(|c| u32::from(color[c].abs_diff(other[c])).pow(2)).sum::<u32>();
                let nearest = (0..colors.len()).min_by_key(|place| distance(&colors[*place]));
                nearest.and_then(|place| u8::try_from(place).ok()).unwrap_or(0)
            }));
        }
        places
    }
}

#[cfg(test)]
mod tests;

//! A picture of the path in space: the flown path, the reference, and the vehicle's attitude along the way.
//!
//! Parallel projection, the same scale along every axis. The floor's
//! squares and the path's shadow on it give the depth. The vehicle is drawn larger than life.

use super::canvas::{DrawingResult, FINE, PlotError, draw};
use super::panel::{BLUE, INK, VERMILION};
use super::record::Sample;
use nalgebra::{UnitQuaternion, Vector3};
use plotters::coord::Shift;
use plotters::prelude::*;

/// Width and height, pixels.
const SIZE: (u32, u32) = (1000, 760);
/// Margins around the projected path, pixels: left, top, right, bottom.
const MARGINS: [f64; 4] = [40.0, 70.0, 40.0, 40.0];
/// Direction of sight: degrees from world x, and above the horizon.
const SIGHT: (f64, f64) = (150.0, 24.0);
const FLOOR: RGBColor = RGBColor(222, 222, 222);
const SHADOW: RGBColor = RGBColor(178, 178, 178);
/// The reference, broad beneath the path.
const ORANGE: RGBColor = RGBColor(230, 159, 0);

/// A line `width` pixels wide.
fn stroke(color: RGBColor, width: u32) -> ShapeStyle {
    color.stroke_width(width * FINE as u32)
}

/// From metres in the world to pixels.
struct View {
    right: Vector3<f64>,
    up: Vector3<f64>,
    scale: f64,
    origin: (f64, f64),
    /// The floor's squares, m, and its extent in whole squares.
    square: f64,
    floor: f64,
    low: (i32, i32),
    high: (i32, i32),
    /// Half the drawn vehicle's diagonal, m.
    arm: f64,
}

/// Draws the whole flight.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses.
pub fn picture(samples: &[Sample]) -> Result<String, PlotError> {
    let view = View::new(samples);
    draw(SIZE, |root| {
        view.draw_floor(root)?;
        let shadow = |sample: &Sample| Vector3::new(sample.position.x, sample.position.y, view.floor);
        root.draw(&view.line(samples.iter().map(shadow), stroke(SHADOW, 2)))?;
        root.draw(&view.line(samples.iter().map(|sample| sample.desired_position), stroke(ORANGE, 7)))?;
        root.draw(&view.line(samples.iter().map(|sample| sample.position), stroke(BLUE, 3)))?;
        for sample in poses(samples, 4.0 * view.arm) {
            view.draw_vehicle(root, sample)?;
        }
        if let Some(first) = samples.first() {
            view.draw_start(root, first)?;
        }
        view.draw_legend(root, samples)
    })
}

/// The samples at which the vehicle is drawn: the first, and then whenever it has moved by `distance` metres, up to the
/// number a picture can hold.
fn poses(samples: &[Sample], distance: f64) -> Vec<&Sample> {
    const MOST: usize = 28;
    let mut poses: Vec<&Sample> = Vec::new();
    for sample in samples {
        // Where the flight returns to a place already drawn, another vehicle would only cover the first.
        let apart = poses.iter().all(|pose| (pose.position - sample.position).norm() >= distance);
        if apart && poses.len() < MOST {
            poses.push(sample);
        }
    }
    poses
}

impl View {
    fn new(samples: &[Sample]) -> Self {
        let (azimuth, elevation) = (SIGHT.0.to_radians(), SIGHT.1.to_radians());
        let right = Vector3::new(-azimuth.sin(), azimuth.cos(), 0.0);
        let up = Vector3::new(-elevation.sin() * azimuth.cos(), -elevation.sin() * azimuth.sin(), elevation.cos());
        let points = samples.iter().flat_map(|sample| [sample.position, sample.desired_position]);
        let huge = Vector3::repeat(f64::MAX);
        let (least, greatest) = points.fold((huge, -huge), |(l, g), point| (l.inf(&point), g.sup(&point)));
        let extent = (greatest - least).max().max(1.0);
        let square =
            [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0].into_iter().find(|s| extent / s < 14.0).unwrap_or(extent / 10.0);
        let low = (((least.x / square).floor() as i32) - 1, ((least.y / square).floor() as i32) - 1);
        let high = (((greatest.x / square).ceil() as i32) + 1, ((greatest.y / square).ceil() as i32) + 1);
        let floor = (least.z / square).floor() * square;
        let mut view =
            Self { right, up, scale: 1.0, origin: (0.0, 0.0), square, floor, low, high, arm: 0.032 * extent };
        view.fit(samples);
        view
    }

    /// Chooses scale and origin so that floor, path and reference fit the picture, with room for a vehicle around each.
    fn fit(&mut self, samples: &[Sample]) {
        let corner = |x: i32, y: i32| Vector3::new(f64::from(x) * self.square, f64::from(y) * self.square, self.floor);
        let (low, high) = (self.low, self.high);
        let corners = [corner(low.0, low.1), corner(low.0, high.1), corner(high.0, low.1), corner(high.0, high.1)];
        let points = samples.iter().flat_map(|sample| [sample.position, sample.desired_position]).chain(corners);
        let (mut least, mut greatest) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
        for point in points {
            let (h, v) = (self.right.dot(&point), self.up.dot(&point));
            least = (least.0.min(h - self.arm), least.1.min(v - self.arm));
            greatest = (greatest.0.max(h + self.arm), greatest.1.max(v + self.arm));
        }
        let [left, above, right, below] = MARGINS;
        let (width, height) = (f64::from(SIZE.0) - left - right, f64::from(SIZE.1) - above - below);
        self.scale = (width / (greatest.0 - least.0)).min(height / (greatest.1 - least.1));
        let center = (0.5 * (least.0 + greatest.0), 0.5 * (least.1 + greatest.1));
        self.origin = (left + 0.5 * width - self.scale * center.0, above + 0.5 * height + self.scale * center.1);
    }

    fn pixel(&self, point: &Vector3<f64>) -> (i32, i32) {
        let horizontal = f64::from(FINE) * (self.origin.0 + self.scale * self.right.dot(point));
        let vertical = f64::from(FINE) * (self.origin.1 - self.scale * self.up.dot(point));
        (horizontal.round() as i32, vertical.round() as i32)
    }

    /// A polyline without the points that fall on the same pixel as the one before.
    fn line(&self, points: impl Iterator<Item = Vector3<f64>>, style: ShapeStyle) -> PathElement<(i32, i32)> {
        let mut pixels: Vec<(i32, i32)> = points.map(|point| self.pixel(&point)).collect();
        pixels.dedup();
        PathElement::new(pixels, style)
    }

    fn draw_floor<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>) -> DrawingResult<DB> {
        let at = |x: i32, y: i32| Vector3::new(f64::from(x) * self.square, f64::from(y) * self.square, self.floor);
        for x in self.low.0..=self.high.0 {
            root.draw(&self.line([at(x, self.low.1), at(x, self.high.1)].into_iter(), stroke(FLOOR, 1)))?;
        }
        for y in self.low.1..=self.high.1 {
            root.draw(&self.line([at(self.low.0, y), at(self.high.0, y)].into_iter(), stroke(FLOOR, 1)))?;
        }
        let axis = |name: &str, direction: Vector3<f64>| {
            let origin = at(self.low.0, self.low.1);
            (name.to_owned(), origin, origin + direction * self.square)
        };
        for (name, from, to) in [axis("x", Vector3::x()), axis("y", Vector3::y()), axis("z", Vector3::z())] {
            root.draw(&self.line([from, to].into_iter(), stroke(INK, 2)))?;
            let (x, y) = self.pixel(&(to + (to - from) * 0.25));
            root.draw(&Text::new(
                name,
                (x - 4 * FINE, y - 8 * FINE),
                ("sans-serif", 15 * FINE).into_font().color(&INK),
            ))?;
        }
        Ok(())
    }

    /// Two crossed arms with rotors, and the thrust axis.
    fn draw_vehicle<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, sample: &Sample) -> DrawingResult<DB> {
        let attitude = UnitQuaternion::from_quaternion(sample.attitude);
        let at = |x: f64, y: f64, z: f64| sample.position + attitude * (Vector3::new(x, y, z) * self.arm);
        for (x, y) in [(0.7, 0.7), (-0.7, 0.7)] {
            root.draw(&self.line([at(x, y, 0.0), at(-x, -y, 0.0)].into_iter(), stroke(INK, 2)))?;
            for sign in [1.0, -1.0] {
                let rotor = (0..=16).map(|i| {
                    let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 16.0).sin_cos();
                    at(sign * x + 0.42 * cos, sign * y + 0.42 * sin, 0.08)
                });
                root.draw(&self.line(rotor, stroke(INK, 1)))?;
            }
        }
        root.draw(&self.line([at(0.0, 0.0, 0.0), at(0.0, 0.0, 1.5)].into_iter(), stroke(VERMILION, 3)))
    }

    /// A word beside the first vehicle.
    fn draw_start<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, first: &Sample) -> DrawingResult<DB> {
        let (x, y) = self.pixel(&first.position);
        let beside = (1.2 * self.arm * self.scale) as i32 + 6;
        let font = ("sans-serif", 19 * FINE).into_font().style(FontStyle::Bold).color(&INK);
        root.draw(&Text::new("start", (x + beside * FINE, y - 8 * FINE), font))
    }

    fn draw_legend<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, samples: &[Sample]) -> DrawingResult<DB> {
        let duration = samples.last().map_or(0.0, |sample| sample.time);
        let entries = [
            (format!("flown, {duration:.0} s"), BLUE, 3),
            ("reference".to_owned(), ORANGE, 7),
            ("thrust axis".to_owned(), VERMILION, 3),
            (format!("shadow on a floor of {} m squares", self.square), SHADOW, 2),
        ];
        let mut x = 40;
        for (text, color, width) in entries {
            let line = vec![(x * FINE, 34 * FINE), ((x + 24) * FINE, 34 * FINE)];
            root.draw(&PathElement::new(line, stroke(color, width)))?;
            let font = ("sans-serif", 15 * FINE).into_font().color(&INK);
            root.draw(&Text::new(text.clone(), ((x + 32) * FINE, 26 * FINE), font))?;
            x += 32 + 8 * text.chars().count() as i32 + 26;
        }
        Ok(())
    }
}

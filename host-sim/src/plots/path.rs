//! A picture of the path in space: what was flown, what was asked for, and how the vehicle stood along the way.
//!
//! Parallel projection from above the corner of the first octant's neighbour; the same scale along every axis. The floor's
//! squares and the path's shadow on it give the depth. The vehicle is drawn larger than life.

use super::panel::{BLUE, DrawingResult, INK, VERMILION};
use super::record::Sample;
use super::{PlotError, draw};
use nalgebra::{UnitQuaternion, Vector3};
use plotters::coord::Shift;
use plotters::prelude::*;

/// Width and height, pixels.
const SIZE: (u32, u32) = (1000, 760);
/// Margins around the projected path, pixels: left, top, right, bottom.
const MARGINS: [f64; 4] = [40.0, 70.0, 40.0, 40.0];
/// Direction of sight: degrees from world x, and above the horizon.
const SIGHT: (f64, f64) = (-52.0, 22.0);
const FLOOR: RGBColor = RGBColor(222, 222, 222);
const SHADOW: RGBColor = RGBColor(178, 178, 178);

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
        root.draw(&view.line(samples.iter().map(shadow), SHADOW.stroke_width(2)))?;
        view.draw_dashed(root, samples)?;
        root.draw(&view.line(samples.iter().map(|sample| sample.position), BLUE.stroke_width(2)))?;
        for sample in poses(samples, 3.2 * view.arm) {
            view.draw_vehicle(root, sample)?;
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
        let square = [0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0]
            .into_iter()
            .find(|s| extent / s < 14.0)
            .unwrap_or(extent / 10.0);
        let low = (((least.x / square).floor() as i32) - 1, ((least.y / square).floor() as i32) - 1);
        let high = (((greatest.x / square).ceil() as i32) + 1, ((greatest.y / square).ceil() as i32) + 1);
        let floor = (least.z / square).floor() * square;
        let mut view =
            Self { right, up, scale: 1.0, origin: (0.0, 0.0), square, floor, low, high, arm: 0.028 * extent };
        view.fit(greatest.z);
        view
    }

    /// Chooses scale and origin so that the floor and the highest point fit the picture.
    fn fit(&mut self, top: f64) {
        let corner = |x: i32, y: i32, z: f64| Vector3::new(f64::from(x) * self.square, f64::from(y) * self.square, z);
        let (mut least, mut greatest) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
        for x in [self.low.0, self.high.0] {
            for y in [self.low.1, self.high.1] {
                for z in [self.floor, top + 2.0 * self.arm] {
                    let (h, v) = (self.right.dot(&corner(x, y, z)), self.up.dot(&corner(x, y, z)));
                    least = (least.0.min(h), least.1.min(v));
                    greatest = (greatest.0.max(h), greatest.1.max(v));
                }
            }
        }
        let [left, above, right, below] = MARGINS;
        let (width, height) = (f64::from(SIZE.0) - left - right, f64::from(SIZE.1) - above - below);
        self.scale = (width / (greatest.0 - least.0)).min(height / (greatest.1 - least.1));
        let center = (0.5 * (least.0 + greatest.0), 0.5 * (least.1 + greatest.1));
        self.origin = (left + 0.5 * width - self.scale * center.0, above + 0.5 * height + self.scale * center.1);
    }

    fn pixel(&self, point: &Vector3<f64>) -> (i32, i32) {
        let horizontal = self.origin.0 + self.scale * self.right.dot(point);
        let vertical = self.origin.1 - self.scale * self.up.dot(point);
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
            root.draw(&self.line([at(x, self.low.1), at(x, self.high.1)].into_iter(), FLOOR.stroke_width(1)))?;
        }
        for y in self.low.1..=self.high.1 {
            root.draw(&self.line([at(self.low.0, y), at(self.high.0, y)].into_iter(), FLOOR.stroke_width(1)))?;
        }
        let axis = |name: &str, direction: Vector3<f64>| {
            let origin = at(self.low.0, self.low.1);
            (name.to_owned(), origin, origin + direction * self.square)
        };
        for (name, from, to) in [axis("x", Vector3::x()), axis("y", Vector3::y()), axis("z", Vector3::z())] {
            root.draw(&self.line([from, to].into_iter(), INK.stroke_width(2)))?;
            let (x, y) = self.pixel(&(to + (to - from) * 0.25));
            root.draw(&Text::new(name, (x - 4, y - 8), ("sans-serif", 15).into_font().color(&INK)))?;
        }
        Ok(())
    }

    /// The reference, dashed by leaving out every other stretch of pixels.
    fn draw_dashed<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, samples: &[Sample]) -> DrawingResult<DB> {
        const DASH: f64 = 7.0;
        let (mut run, mut length, mut last) = (Vec::new(), 0.0, None);
        for sample in samples {
            let pixel = self.pixel(&sample.desired_position);
            if let Some((x, y)) = last {
                length += f64::from(pixel.0 - x).hypot(f64::from(pixel.1 - y));
            }
            last = Some(pixel);
            if length % (2.0 * DASH) < DASH {
                run.push(pixel);
            } else if run.len() > 1 {
                root.draw(&PathElement::new(std::mem::take(&mut run), INK.stroke_width(2)))?;
            } else {
                run.clear();
            }
            // Once around is enough: further rounds would fill the gaps.
            if length > 1.0 && sample.time > 0.0 && length > 6.0 * f64::from(SIZE.0) {
                break;
            }
        }
        Ok(())
    }

    /// Two crossed arms with rotors, and the thrust axis.
    fn draw_vehicle<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, sample: &Sample) -> DrawingResult<DB> {
        let attitude = UnitQuaternion::from_quaternion(sample.attitude);
        let at = |x: f64, y: f64, z: f64| sample.position + attitude * (Vector3::new(x, y, z) * self.arm);
        for (x, y) in [(0.7, 0.7), (-0.7, 0.7)] {
            root.draw(&self.line([at(x, y, 0.0), at(-x, -y, 0.0)].into_iter(), INK.stroke_width(2)))?;
            for sign in [1.0, -1.0] {
                let rotor = (0..=16).map(|i| {
                    let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 16.0).sin_cos();
                    at(sign * x + 0.42 * cos, sign * y + 0.42 * sin, 0.08)
                });
                root.draw(&self.line(rotor, INK.stroke_width(1)))?;
            }
        }
        root.draw(&self.line([at(0.0, 0.0, 0.0), at(0.0, 0.0, 1.5)].into_iter(), VERMILION.stroke_width(3)))
    }

    fn draw_legend<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, samples: &[Sample]) -> DrawingResult<DB> {
        let duration = samples.last().map_or(0.0, |sample| sample.time);
        let entries = [
            (format!("flown, {duration:.0} s"), BLUE, false),
            ("reference".to_owned(), INK, true),
            ("thrust axis".to_owned(), VERMILION, false),
            (format!("shadow on a floor of {} m squares", self.square), SHADOW, false),
        ];
        let mut x = 40;
        for (text, color, dashed) in entries {
            let strokes = if dashed { vec![(x, x + 7), (x + 14, x + 21)] } else { vec![(x, x + 24)] };
            for (from, to) in strokes {
                root.draw(&PathElement::new(vec![(from, 34), (to, 34)], color.stroke_width(3)))?;
            }
            root.draw(&Text::new(text.clone(), (x + 32, 26), ("sans-serif", 15).into_font().color(&INK)))?;
            x += 32 + 8 * text.chars().count() as i32 + 26;
        }
        Ok(())
    }
}

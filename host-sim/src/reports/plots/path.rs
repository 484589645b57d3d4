//! A picture of the path in space: the flown path, the reference, and the vehicle's attitude along the way.
//!
//! Parallel projection, the same scale along every axis. The floor's squares and the path's shadow on it give the
//! depth. The vehicle is drawn larger than life.

use super::drawing::{Drawing, Point, Side};
use crate::reports::report::plot::Color;
use crate::reports::report::track::Track;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Width and height.
const SIZE_PIXELS: (u32, u32) = (700, 560);
const TYPE_HEIGHT_PIXELS: f64 = 14.0;
/// Around the projected path: left, top, right, bottom.
const MARGINS_PIXELS: [f64; 4] = [24.0, 50.0, 24.0, 24.0];
/// From world x, and above the horizon.
const VIEW_DIRECTION_DEG: (f64, f64) = (150.0, 24.0);
/// Half the drawn vehicle's diagonal, as a share of the path's extent.
const STILL_ARM_SHARE: f64 = 0.032;

/// Where the vehicle is at one row of its track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// p, m.
    pub position: Vector3<f64>,
    /// p_d, m.
    pub asked: Vector3<f64>,
    /// q, body to world.
    pub attitude: UnitQuaternion<f64>,
}

/// The poses of a track that has log.csv's columns; none of any other.
#[must_use]
pub fn poses(track: &Track) -> Vec<Pose> {
    let names = ["px", "py", "pz", "pdx", "pdy", "pdz", "qw", "qx", "qy", "qz"];
    let columns = names.map(|name| track.column(name).unwrap_or_default());
    let rows = columns.iter().map(|column| column.len()).min().unwrap_or(0);
    let pose = |row: usize| {
        let [px, py, pz, pdx, pdy, pdz, qw, qx, qy, qz] = columns.map(|column| f64::from(column[row]));
        Pose {
            position: Vector3::new(px, py, pz),
            asked: Vector3::new(pdx, pdy, pdz),
            attitude: UnitQuaternion::from_quaternion(Quaternion::new(qw, qx, qy, qz)),
        }
    };
    (0..rows).map(pose).collect()
}

/// From metres in the world to pixels.
pub struct View {
    size: (u32, u32),
    right: Vector3<f64>,
    up: Vector3<f64>,
    scale: f64,
    origin: Point,
    /// The floor's squares, m, and its extent in whole squares.
    square: f64,
    floor: f64,
    low: (i32, i32),
    high: (i32, i32),
    /// Half the drawn vehicle's diagonal, m.
    arm: f64,
}

/// Draws the whole flight.
#[must_use]
pub fn picture(track: &Track) -> Drawing {
    let poses = poses(track);
    let view = View::new(&poses, SIZE_PIXELS, STILL_ARM_SHARE);
    let mut drawing = Drawing::new(SIZE_PIXELS);
    view.draw_floor(&mut drawing);
    view.draw_axes(&mut drawing);
    view.draw_paths(&mut drawing, &poses, &poses);
    for pose in apart(&poses, 4.0 * view.arm) {
        view.draw_vehicle(&mut drawing, pose);
    }
    if let Some(first) = poses.first() {
        let (x, y) = view.pixel(&first.position);
        let beside = 1.2 * view.arm * view.scale + 4.0;
        drawing.words(
            "start",
            (x + beside, y + 0.35 * TYPE_HEIGHT_PIXELS),
            Side::Start,
            TYPE_HEIGHT_PIXELS,
            Color::Ink,
        );
    }
    view.draw_legend(&mut drawing, track.end());
    drawing
}

/// The poses at which the vehicle is drawn: the first, and then whenever it has moved by `distance` metres, up to the
/// number a picture can hold.
fn apart(all: &[Pose], distance: f64) -> Vec<&Pose> {
    const POSES_MAX: usize = 28;
    let mut poses: Vec<&Pose> = Vec::new();
    for pose in all {
        // Where the flight returns to a place already drawn, another vehicle would only cover the first.
        let apart = poses.iter().all(|other| (other.position - pose.position).norm() >= distance);
        if apart && poses.len() < POSES_MAX {
            poses.push(pose);
        }
    }
    poses
}

impl View {
    /// A view of `size` pixels that holds all of `poses`, the vehicle's half diagonal that share of their extent.
    #[must_use]
    pub fn new(poses: &[Pose], size: (u32, u32), arm: f64) -> Self {
        let (azimuth, elevation) = (VIEW_DIRECTION_DEG.0.to_radians(), VIEW_DIRECTION_DEG.1.to_radians());
        let right = Vector3::new(-azimuth.sin(), azimuth.cos(), 0.0);
        let up = Vector3::new(-elevation.sin() * azimuth.cos(), -elevation.sin() * azimuth.sin(), elevation.cos());
        let (mut least, mut greatest) = (Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN));
        for point in poses.iter().flat_map(|pose| [pose.position, pose.asked]) {
            (least, greatest) = (least.inf(&point), greatest.sup(&point));
        }
        if poses.is_empty() {
            (least, greatest) = (Vector3::zeros(), Vector3::zeros());
        }
        let extent = (greatest - least).max().max(1.0);
        let square =
            [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0].into_iter().find(|s| extent / s < 14.0).unwrap_or(extent / 10.0);
        let low = (((least.x / square).floor() as i32) - 1, ((least.y / square).floor() as i32) - 1);
        let high = (((greatest.x / square).ceil() as i32) + 1, ((greatest.y / square).ceil() as i32) + 1);
        let floor = (least.z / square).floor() * square;
        let (scale, origin, arm) = (1.0, (0.0, 0.0), arm * extent);
        let mut view = Self { size, right, up, scale, origin, square, floor, low, high, arm };
        view.fit(poses);
        view
    }

    /// Chooses scale and origin so that floor, path and reference fit the picture, with room for a vehicle around each.
    fn fit(&mut self, poses: &[Pose]) {
        let (low, high) = (self.low, self.high);
        let corners = [(low.0, low.1), (low.0, high.1), (high.0, low.1), (high.0, high.1)].map(|(x, y)| self.at(x, y));
        let points = poses.iter().flat_map(|pose| [pose.position, pose.asked]).chain(corners);
        let (mut least, mut greatest) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
        for point in points {
            let (h, v) = (self.right.dot(&point), self.up.dot(&point));
            least = (least.0.min(h - self.arm), least.1.min(v - self.arm));
            greatest = (greatest.0.max(h + self.arm), greatest.1.max(v + self.arm));
        }
        let [left, above, right, below] = MARGINS_PIXELS;
        let (width, height) = (f64::from(self.size.0) - left - right, f64::from(self.size.1) - above - below);
        self.scale = (width / (greatest.0 - least.0)).min(height / (greatest.1 - least.1));
        let center = (0.5 * (least.0 + greatest.0), 0.5 * (least.1 + greatest.1));
        self.origin = (left + 0.5 * width - self.scale * center.0, above + 0.5 * height + self.scale * center.1);
    }

    /// A corner of the floor's squares.
    fn at(&self, x: i32, y: i32) -> Vector3<f64> {
        Vector3::new(f64::from(x) * self.square, f64::from(y) * self.square, self.floor)
    }

    fn pixel(&self, point: &Vector3<f64>) -> Point {
        (self.origin.0 + self.scale * self.right.dot(point), self.origin.1 - self.scale * self.up.dot(point))
    }

    /// A line without the points that lie less than a pixel from the one before.
    fn stroke(
        &self,
        drawing: &mut Drawing,
        points: impl IntoIterator<Item = Vector3<f64>>,
        (color, width): (Color, f64),
    ) {
        let mut pixels: Vec<Point> = points.into_iter().map(|point| self.pixel(&point)).collect();
        pixels.dedup_by(|next, before| (next.0 - before.0).hypot(next.1 - before.1) < 1.0);
        drawing.stroke(pixels, color, width);
    }

    /// The floor, in squares.
    pub fn draw_floor(&self, drawing: &mut Drawing) {
        for x in self.low.0..=self.high.0 {
            self.stroke(drawing, [self.at(x, self.low.1), self.at(x, self.high.1)], (Color::Grid, 1.0));
        }
        for y in self.low.1..=self.high.1 {
            self.stroke(drawing, [self.at(self.low.0, y), self.at(self.high.0, y)], (Color::Grid, 1.0));
        }
    }

    fn draw_axes(&self, drawing: &mut Drawing) {
        let from = self.at(self.low.0, self.low.1);
        for (name, direction) in [("x", Vector3::x()), ("y", Vector3::y()), ("z", Vector3::z())] {
            let to = from + direction * self.square;
            self.stroke(drawing, [from, to], (Color::Ink, 1.5));
            let (x, y) = self.pixel(&(to + (to - from) * 0.25));
            drawing.words(name, (x, y + 0.3 * TYPE_HEIGHT_PIXELS), Side::Middle, TYPE_HEIGHT_PIXELS, Color::Ink);
        }
    }

    /// The shadow of the path `flown`, the reference of `all` the flight, and the path itself.
    pub fn draw_paths(&self, drawing: &mut Drawing, flown: &[Pose], all: &[Pose]) {
        let shadow = |pose: &Pose| Vector3::new(pose.position.x, pose.position.y, self.floor);
        self.stroke(drawing, flown.iter().map(shadow), (Color::Shadow, 1.5));
        self.stroke(drawing, all.iter().map(|pose| pose.asked), (Color::Orange, 5.0));
        self.stroke(drawing, flown.iter().map(|pose| pose.position), (Color::Blue, 2.2));
    }

    /// Lines that stand in the world: a gate, an edge.
    pub fn draw_things(&self, drawing: &mut Drawing, things: &[Vec<Vector3<f64>>]) {
        things.iter().for_each(|thing| self.stroke(drawing, thing.iter().copied(), (Color::Axis, 4.0)));
    }

    /// Two crossed arms with rotors, and the thrust axis.
    pub fn draw_vehicle(&self, drawing: &mut Drawing, pose: &Pose) {
        let at = |x: f64, y: f64, z: f64| pose.position + pose.attitude * (Vector3::new(x, y, z) * self.arm);
        for (x, y) in [(0.7, 0.7), (-0.7, 0.7)] {
            self.stroke(drawing, [at(x, y, 0.0), at(-x, -y, 0.0)], (Color::Ink, 1.6));
            for sign in [1.0, -1.0] {
                let rotor = (0..=16).map(|i| {
                    let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 16.0).sin_cos();
                    at(sign * x + 0.42 * cos, sign * y + 0.42 * sin, 0.08)
                });
                self.stroke(drawing, rotor, (Color::Ink, 0.8));
            }
        }
        self.stroke(drawing, [at(0.0, 0.0, 0.0), at(0.0, 0.0, 1.5)], (Color::Vermilion, 2.2));
    }

    fn draw_legend(&self, drawing: &mut Drawing, duration: f64) {
        let entries = [
            (format!("flown, {duration:.0} s"), Color::Blue, 2.2),
            ("reference".to_owned(), Color::Orange, 5.0),
            ("thrust axis".to_owned(), Color::Vermilion, 2.2),
            (format!("shadow; squares of {} m", self.square), Color::Shadow, 1.5),
        ];
        let mut x = MARGINS_PIXELS[0];
        for (text, color, width) in entries {
            drawing.stroke(vec![(x, 26.0), (x + 1.6 * TYPE_HEIGHT_PIXELS, 26.0)], color, width);
            let letters = text.chars().count() as f64;
            drawing.words(
                text,
                (x + 2.1 * TYPE_HEIGHT_PIXELS, 26.0 + 0.35 * TYPE_HEIGHT_PIXELS),
                Side::Start,
                TYPE_HEIGHT_PIXELS,
                Color::Ink,
            );
            x += (2.1 + 0.56 * letters + 1.4) * TYPE_HEIGHT_PIXELS;
        }
    }
}

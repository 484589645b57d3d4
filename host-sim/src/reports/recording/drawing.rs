//! Times, vectors, poses and the vehicle's picture, as the messages have them.

use nalgebra::{Quaternion, Vector3};
use serde_json::{Value, json};

pub fn stamp(time_us: u64) -> Value {
    json!({ "sec": time_us / 1_000_000, "nsec": time_us % 1_000_000 * 1_000 })
}

/// Three numbers.
pub fn vector(v: &Vector3<f64>) -> Value {
    json!({ "x": v.x, "y": v.y, "z": v.z })
}

/// A rotation, body to world.
pub fn quaternion(q: &Quaternion<f64>) -> Value {
    json!({ "x": q.i, "y": q.j, "z": q.k, "w": q.w })
}

/// Where something is, in the world.
pub fn pose(time_us: u64, position: &Vector3<f64>, attitude: &Quaternion<f64>) -> Value {
    json!({
        "timestamp": stamp(time_us),
        "frame_id": "world",
        "pose": { "position": vector(position), "orientation": quaternion(attitude) },
    })
}

/// Where the body is, in the world.
pub fn transform(time_us: u64, position: &Vector3<f64>, attitude: &Quaternion<f64>) -> Value {
    json!({
        "timestamp": stamp(time_us),
        "parent_frame_id": "world",
        "child_frame_id": "body",
        "translation": vector(position),
        "rotation": quaternion(attitude),
    })
}

/// A line from the body's origin to each rotor, m, and one ahead.
pub fn scene(rotors: &[[f64; 3]]) -> Value {
    let still = json!({ "position": vector(&Vector3::zeros()), "orientation": quaternion(&Quaternion::identity()) });
    let line = |end: &[f64; 3], colour: Value, thickness: f64| {
        json!({
            "type": 0,
            "pose": still,
            "thickness": thickness,
            "scale_invariant": false,
            "points": [vector(&Vector3::zeros()), vector(&Vector3::from(*end))],
            "color": colour,
            "colors": [],
            "indices": [],
        })
    };
    let arm = rotors.iter().map(|rotor| rotor.iter().map(|x| x * x).sum::<f64>().sqrt()).fold(0.15, f64::max);
    // Blue and orange: distinct for the colour-blind too.
    let blue = json!({ "r": 0.0, "g": 0.447, "b": 0.698, "a": 1.0 });
    let orange = json!({ "r": 0.835, "g": 0.369, "b": 0.0, "a": 1.0 });
    let arms = rotors.iter().map(|rotor| line(rotor, blue.clone(), 0.02));
    let lines: Vec<Value> = arms.chain([line(&[arm, 0.0, 0.0], orange, 0.03)]).collect();
    json!({
        "deletions": [],
        "entities": [{
            "timestamp": stamp(0),
            "frame_id": "body",
            "id": "vehicle",
            "lifetime": stamp(0),
            "frame_locked": true,
            "metadata": [],
            "arrows": [],
            "cubes": [],
            "spheres": [],
            "cylinders": [],
            "lines": lines,
            "triangles": [],
            "texts": [],
            "models": [],
        }],
    })
}

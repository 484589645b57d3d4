//! flight.mcap: a flight for [Foxglove](https://foxglove.dev) and whatever else reads MCAP.
//!
//! | topic | schema | what |
//! |---|---|---|
//! | /vehicle, /reference, /told | foxglove.PoseInFrame | where it is; where it is to be; where the law was told that it is |
//! | /tf | foxglove.FrameTransform | world to body |
//! | /scene | foxglove.SceneUpdate, once | arms and nose, in the body's frame |
//! | /law | host_sim.Law | wrench, errors, saturated feedback |
//! | /rotors | host_sim.Rotors | thrust of each, N, after lag |
//! | /estimates | host_sim.Estimates | force, torque and thrust scale, where the law estimates |
//!
//! Frames are the law's: world z up, body x ahead, y left, z up; SI units. Messages are JSON, one of each for every control tick,
//! at the flight's own time. The scenario is attached as it was read.

mod schemas;

use crate::flight::Tick;
use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{Attachment, McapError, WriteOptions, Writer};
use nalgebra::{Quaternion, Vector3};
use schemas::{ESTIMATES, FRAME_TRANSFORM, LAW, POSE_IN_FRAME, ROTORS, SCENE_UPDATE, Schema};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};

/// A recording that grows tick by tick.
pub struct Recording<W: Write> {
    writer: Writer<NoSeek<W>>,
    /// Channel and messages written, by topic.
    channels: BTreeMap<&'static str, (u16, u32)>,
}

impl<W: Write> Recording<W> {
    /// Begins one, with the scenario's text attached and the vehicle's arms drawn.
    ///
    /// # Errors
    /// As the writer's.
    pub fn begin(out: W, name: &str, scenario: &str, rotors: &[[f64; 3]]) -> io::Result<Self> {
        let options = WriteOptions::new().compression(None).disable_seeking(true).library("host-sim");
        let mut recording =
            Self { writer: options.create(NoSeek::new(out)).map_err(failed)?, channels: BTreeMap::new() };
        for (topic, schema) in [
            ("/vehicle", POSE_IN_FRAME),
            ("/reference", POSE_IN_FRAME),
            ("/told", POSE_IN_FRAME),
            ("/tf", FRAME_TRANSFORM),
            ("/scene", SCENE_UPDATE),
            ("/law", LAW),
            ("/rotors", ROTORS),
            ("/estimates", ESTIMATES),
        ] {
            recording.channel(topic, &schema)?;
        }
        let attachment = Attachment {
            log_time: 0,
            create_time: 0,
            name: format!("{name}.toml"),
            media_type: "application/toml".to_owned(),
            data: Cow::Borrowed(scenario.as_bytes()),
        };
        recording.writer.attach(&attachment).map_err(failed)?;
        recording.message("/scene", 0, &scene(rotors))?;
        Ok(recording)
    }

    fn channel(&mut self, topic: &'static str, schema: &Schema) -> io::Result<()> {
        let id = self.writer.add_schema(schema.name, "jsonschema", schema.text.as_bytes()).map_err(failed)?;
        let channel = self.writer.add_channel(id, topic, "json", &BTreeMap::new()).map_err(failed)?;
        self.channels.insert(topic, (channel, 0));
        Ok(())
    }

    fn message(&mut self, topic: &'static str, time_us: u64, value: &Value) -> io::Result<()> {
        let Some((channel_id, count)) = self.channels.get_mut(topic) else {
            return Err(io::Error::other(format!("no topic {topic}")));
        };
        let time = time_us * 1_000;
        let header = MessageHeader { channel_id: *channel_id, sequence: *count, log_time: time, publish_time: time };
        *count += 1;
        self.writer.write_to_known_channel(&header, value.to_string().as_bytes()).map_err(failed)
    }

    /// Adds a tick.
    ///
    /// # Errors
    /// As the writer's.
    pub fn take(&mut self, tick: &Tick) -> io::Result<()> {
        let (now, s, d) = (tick.time_us, &tick.state, &tick.diagnostics);
        self.message("/vehicle", now, &pose(now, &s.position, &s.attitude))?;
        self.message("/tf", now, &transform(now, &s.position, &s.attitude))?;
        self.message("/reference", now, &pose(now, &tick.reference.position.cast(), &d.desired_attitude.cast()))?;
        if let Some(told) = &tick.measured {
            self.message("/told", now, &pose(now, &told.position.cast(), &told.attitude.cast()))?;
        }
        let law = json!({
            "thrust": tick.wrench.thrust,
            "torque": vector(&tick.wrench.torque.cast()),
            "position_error": d.position_error.norm(),
            "attitude_error": d.mrp.norm(),
            "lift_sign": d.lift_sign,
            "feedback": vector(&d.feedback.cast()),
            "clipped": tick.clipped,
        });
        self.message("/law", now, &law)?;
        if !tick.rotors.is_empty() {
            self.message("/rotors", now, &json!({ "thrust": tick.rotors }))?;
        }
        if let Some(estimates) = &tick.estimates {
            let estimates = json!({
                "force": vector(&estimates.force.value.cast()),
                "torque": vector(&estimates.torque.cast()),
                "thrust_scale": estimates.scale,
            });
            self.message("/estimates", now, &estimates)?;
        }
        Ok(())
    }

    /// Ends it, and gives back what it was written to.
    ///
    /// # Errors
    /// As the writer's.
    pub fn finish(mut self) -> io::Result<W> {
        self.writer.finish().map_err(failed)?;
        Ok(self.writer.into_inner().into_inner())
    }
}

fn failed(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}

fn stamp(time_us: u64) -> Value {
    json!({ "sec": time_us / 1_000_000, "nsec": time_us % 1_000_000 * 1_000 })
}

fn vector(v: &Vector3<f64>) -> Value {
    json!({ "x": v.x, "y": v.y, "z": v.z })
}

fn quaternion(q: &Quaternion<f64>) -> Value {
    json!({ "x": q.i, "y": q.j, "z": q.k, "w": q.w })
}

fn pose(time_us: u64, position: &Vector3<f64>, attitude: &Quaternion<f64>) -> Value {
    json!({
        "timestamp": stamp(time_us),
        "frame_id": "world",
        "pose": { "position": vector(position), "orientation": quaternion(attitude) },
    })
}

fn transform(time_us: u64, position: &Vector3<f64>, attitude: &Quaternion<f64>) -> Value {
    json!({
        "timestamp": stamp(time_us),
        "parent_frame_id": "world",
        "child_frame_id": "body",
        "translation": vector(position),
        "rotation": quaternion(attitude),
    })
}

/// A line from the body's origin to each rotor, m, and one ahead.
fn scene(rotors: &[[f64; 3]]) -> Value {
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
    // Blue and orange, which everybody tells apart.
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

#[cfg(test)]
mod tests;

//! MCAP: a flight, or a session with the firmware, for [Foxglove](https://foxglove.dev) and other readers of MCAP.
//!
//! | topic | schema | what |
//! |---|---|---|
//! | /vehicle, /reference, /told | foxglove.PoseInFrame | true pose; reference; the measured pose that the law got |
//! | /tf | foxglove.FrameTransform | world to body |
//! | /scene | foxglove.SceneUpdate, once | arms and nose, in the body's frame |
//! | /law | host_sim.Law | wrench, errors, saturated feedback |
//! | /rotors | host_sim.Rotors | thrust of each, N, after lag |
//! | /estimates | host_sim.Estimates | force, torque and thrust scale, where the law estimates |
//! | /state, /log | host_sim.State, foxglove.Log | the firmware's mode and texts: sessions of `sitl` only |
//!
//! A [flight] is recorded with all but the last two, a [session] with all but /estimates. Frames are the law's: world z
//! up, body x ahead, y left, z up; SI units. Messages are JSON, one of each for every control tick, at the vehicle's
//! own time. The scenario is attached as it was read.

mod drawing;
pub mod flight;
mod schemas;
pub mod session;

use drawing::{pose, transform};
use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{Attachment, McapError, WriteOptions, Writer};
use scenario::Scenario;
use scenario::body::BodyState;
use schemas::{FRAME_TRANSFORM, LAW_SCHEMA, POSE_IN_FRAME, ROTORS_SCHEMA, SCENE_UPDATE, Schema};
use serde_json::Value;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};

/// A topic, and what its messages look like.
pub type Topic = (&'static str, Schema);

const COMMON_TOPICS: [Topic; 7] = [
    ("/vehicle", POSE_IN_FRAME),
    ("/reference", POSE_IN_FRAME),
    ("/told", POSE_IN_FRAME),
    ("/tf", FRAME_TRANSFORM),
    ("/scene", SCENE_UPDATE),
    ("/law", LAW_SCHEMA),
    ("/rotors", ROTORS_SCHEMA),
];

/// A recording that grows tick by tick.
pub struct Recording<W: Write> {
    writer: Writer<NoSeek<W>>,
    /// Channel and messages written, by topic.
    channels: BTreeMap<&'static str, (u16, u32)>,
}

impl<W: Write> Recording<W> {
    /// Begins one of `scenario` with these topics beside those that every one has: its `text` attached, the vehicle's
    /// arms drawn.
    ///
    /// # Errors
    /// As the writer's.
    pub fn begin(out: W, scenario: &Scenario, text: &str, topics: &[Topic]) -> io::Result<Self> {
        let options = WriteOptions::new().compression(None).disable_seeking(true).library("host-sim");
        let mut recording =
            Self { writer: options.create(NoSeek::new(out)).map_err(failed)?, channels: BTreeMap::new() };
        for (topic, schema) in COMMON_TOPICS.iter().chain(topics) {
            recording.channel(topic, schema)?;
        }
        let attachment = Attachment {
            log_time: 0,
            create_time: 0,
            name: format!("{}.toml", scenario.name),
            media_type: "application/toml".to_owned(),
            data: Cow::Borrowed(text.as_bytes()),
        };
        recording.writer.attach(&attachment).map_err(failed)?;
        let rotors = scenario.configuration.rotors();
        let places: Vec<[f64; 3]> =
            rotors.into_iter().flat_map(|rotors| rotors.iter()).map(|rotor| rotor.position.cast().into()).collect();
        recording.message("/scene", 0, &drawing::scene(&places))?;
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

    /// Where the vehicle really is at `time_us`.
    fn truth(&mut self, time_us: u64, state: &BodyState) -> io::Result<()> {
        self.message("/vehicle", time_us, &pose(time_us, &state.position, &state.attitude))?;
        self.message("/tf", time_us, &transform(time_us, &state.position, &state.attitude))
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

#[cfg(test)]
mod tests;

use super::*;
use crate::flight::{Flight, Tick};
use scenario::Scenario;
use std::collections::HashMap;

/// A recording of a second of a flight, and the ticks in it.
fn recorded() -> (Vec<u8>, Vec<Tick>) {
    let text = include_str!("../../../../vehicles/hummingbird.toml");
    let scenario = Scenario::parse(text, "hummingbird.toml").unwrap();
    let mut flight = Flight::uncertified(&scenario).unwrap();
    let mut recording = Recording::begin(Vec::new(), &scenario, text, flight::FLIGHT_TOPICS).unwrap();
    let ticks: Vec<Tick> = (0..100).map(|_| flight.tick().unwrap()).collect();
    ticks.iter().for_each(|tick| recording.take(tick).unwrap());
    (recording.finish().unwrap(), ticks)
}

#[test]
fn what_was_flown_is_read_back_topic_by_topic_at_its_time() {
    let (bytes, ticks) = recorded();
    let mut counts: HashMap<String, usize> = HashMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let value: Value = serde_json::from_slice(&message.data).unwrap();
        let count = counts.entry(message.channel.topic.clone()).or_default();
        if message.channel.topic == "/vehicle" {
            let tick = &ticks[*count];
            assert_eq!(message.log_time, tick.time_us * 1_000);
            assert_eq!(value["pose"]["position"]["z"].as_f64(), Some(tick.state.position.z));
            assert_eq!(value["pose"]["orientation"]["w"].as_f64(), Some(tick.state.attitude.w));
        }
        *count += 1;
    }
    for (topic, count) in [("/vehicle", 100), ("/tf", 100), ("/law", 100), ("/rotors", 100), ("/scene", 1)] {
        assert_eq!(counts.get(topic), Some(&count), "{topic}");
    }
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    assert_eq!(summary.attachment_indexes.first().map(|attachment| attachment.name.as_str()), Some("hummingbird.toml"));
}

#[test]
fn every_schema_is_json_and_names_the_fields_that_its_messages_have() {
    let (bytes, _) = recorded();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.as_ref().unwrap();
        let described: Value = serde_json::from_slice(&schema.data).unwrap();
        let value: Value = serde_json::from_slice(&message.data).unwrap();
        for field in value.as_object().unwrap().keys() {
            assert!(described["properties"].get(field).is_some(), "{}: {field}", schema.name);
        }
    }
}

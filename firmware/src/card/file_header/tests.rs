use super::*;
use crate::parameters::table::Name;
use crate::shared::Shared;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;

#[test]
fn it_is_whole_messages_with_every_number_before_the_subscriptions() {
    let shared = Shared::<NoopRawMutex>::new();
    shared.parameters.set(Name::LandingSpeed, 0.625).unwrap();
    let beginning = FileHeader { vehicle: "mine", parameters: shared.for_card().parameters() };
    let time = 0x0123_4567_89AB_CDEF;
    let bytes: Vec<u8> = (0..HEAD_SECTORS).flat_map(|place| beginning.sector(place, time)).collect();
    assert_eq!((&bytes[8..16], bytes.len()), (&time.to_le_bytes()[..], HEAD_SECTORS * SECTOR_BYTES));
    let (mut at, mut kinds, mut speed) = (16, String::new(), None);
    while at < bytes.len() {
        let length = usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
        let body = &bytes[at + MESSAGE_HEAD_BYTES..at + MESSAGE_HEAD_BYTES + length];
        kinds.push(char::from(bytes[at + 2]));
        if body.starts_with(b"\x10float LAND_SPEED") {
            speed = body[17..].try_into().ok().map(f32::from_le_bytes);
        }
        at += MESSAGE_HEAD_BYTES + length;
    }
    assert_eq!((at, speed), (bytes.len(), Some(0.625)));
    let count = PARAMETERS.len() + CONSTANTS.len();
    assert_eq!(kinds.replace('Z', ""), format!("BIIIIIF{}FAA", "P".repeat(count)));
}

#[test]
fn no_name_is_too_long() {
    let names = PARAMETERS.iter().map(|row| row.name).chain(CONSTANTS.map(|(name, _)| name));
    names.for_each(|name| assert!(name.len() <= NAME_MAX, "{name}"));
}

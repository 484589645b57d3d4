//! The key: how it comes in, where it is kept, and what a restart may not open.

use super::*;

/// The order to take a key.
fn setup(secret_key: [u8; 32], initial_timestamp: Stamp) -> SETUP_SIGNING_DATA {
    SETUP_SIGNING_DATA { initial_timestamp, target_system: 1, target_component: 1, secret_key }
}

#[test]
fn a_key_is_taken_over_usb_while_disarmed_and_nowhere_else() {
    let own = core::array::from_fn(|index| index as u8);
    let taken = |on_port: bool, mode, message: &SETUP_SIGNING_DATA| {
        let shared = Local::new();
        report(&shared, mode, 0);
        if on_port {
            shared.on_port.raise();
        }
        Fed::new(&shared).message(message, NOW_US);
        shared.on_port.lower();
        report(&shared, Mode::Ready, NOW_US);
        let said = texts(&shared);
        // With the key, a frame that is not signed counts no more.
        Fed::new(&shared).message(&disarm(), NOW_US);
        (!is_stopped(&shared), said)
    };
    let said = |words: &str| vec![words.to_owned()];
    assert_eq!(taken(true, Mode::Ready, &setup(own, 5)), (true, said("Signing: on, with a new key")));
    assert_eq!(taken(false, Mode::Ready, &setup(own, 5)), (false, said("Signing: a key is taken over USB only")));
    assert_eq!(
        taken(true, Mode::Flying, &setup(own, 5)),
        (false, said("Signing: only disarmed, and no motor turning"))
    );
    assert_eq!(taken(true, Mode::Ready, &SETUP_SIGNING_DATA { target_system: 2, ..setup(own, 5) }), (false, vec![]));
    assert_eq!(taken(true, Mode::Ready, &setup([0; 32], 0)), (false, said("Signing: off")));
}

#[test]
fn over_usb_frames_need_no_signature_and_a_lost_key_is_replaced() {
    let shared = keyed();
    shared.on_port.raise();
    let mut fed = Fed::new(&shared);
    fed.message(&disarm(), NOW_US);
    assert!(is_stopped(&shared));
    // Also by a station that has signed with its new key already.
    fed.bytes(&Sender::new(255, Key::new([7; 32]), 0).say(&setup([7; 32], FIRST_STAMP), 0), NOW_US);
    shared.on_port.lower();
    fed.bytes(&Sender::new(255, Key::new([7; 32]), FIRST_STAMP + 1).say(&disarm(), 0), NOW_US);
    assert!(is_stopped(&shared));
}

#[test]
fn the_same_key_again_makes_nothing_new_that_is_old() {
    let shared = keyed();
    let mut fed = Fed::new(&shared);
    fed.bytes(&bytes(STOP), NOW_US);
    assert!(is_stopped(&shared));
    shared.set_signing(key(), 0, NOW_US);
    fed.bytes(&bytes(STOP), NOW_US);
    assert!(!is_stopped(&shared));
}

#[test]
fn a_key_is_shown_nowhere() {
    let shared = Local::new();
    report(&shared, Mode::Ready, 0);
    shared.on_port.raise();
    let secret: [u8; 32] = core::array::from_fn(|index| 0xA0 + index as u8);
    let mut fed = Fed::new(&shared);
    fed.message(&setup(secret, 5), NOW_US);
    fed.message(&command(MavCmd::MAV_CMD_REQUEST_MESSAGE, [SETUP_SIGNING_DATA::ID as f32, 0.0, 0.0, 0.0, 0.0]), NOW_US);
    shared.reply(Reply::AllParameters);
    assert_eq!(format!("{:?}", Key::new(secret)), "Some(Key)");
    let (clock, written) = (Simulated::default(), RefCell::new(Vec::new()));
    clock.run(3_000_000, transmit(Outgoing { written: &written, at_once: 300 }, &clock, shared.for_transmit()), |_| ());
    let written = written.borrow();
    assert!(written.len() > 3_000);
    for part in secret.windows(4) {
        assert!(written.windows(4).all(|four| four != part));
    }
}

/// Runs storage on a chip for some time, us.
fn kept(chip: &RefCell<Chip>, shared: &Local, clock: &Simulated, duration: u64) {
    let mut storage = Storage::load(Words::<32>(chip), shared.for_storage());
    clock.run(duration, storage.keep(clock, shared.for_storage()), |now| {
        if now.is_multiple_of(1_000_000) {
            let mode = shared.report.get().map_or(Mode::Ready, |report| report.value.mode);
            report(shared, mode, now);
        }
    });
}

#[test]
fn a_restart_keeps_the_key_and_opens_nothing_to_replays() {
    let (chip, shared, clock) = (Chip::erased(), Local::new(), Simulated::default());
    let mut storage = Storage::load(Words::<32>(&chip), shared.for_storage());
    shared.set_signing(key(), FIRST_STAMP - 1, 0);
    clock.run(100_000, storage.keep(&clock, shared.for_storage()), |_| ());
    let mut station = Sender::new(255, key(), FIRST_STAMP);
    let mut vehicle = shared;
    // Restarted in flight, twice: the second time it had taken off at once. Nothing can be kept in a flight, which
    // lasts as long as what was kept before it.
    let flight = KEPT_AHEAD * 10 - 1_000_000;
    for _ in 0..2 {
        let frames: Vec<_> = (0..=4).map(|part| station.say(&disarm(), part * flight / 4)).collect();
        for (part, frame) in frames.iter().enumerate() {
            assert_eq!(judged(&vehicle.signing, frame, part as u64 * flight / 4), Ok(()));
        }
        vehicle = Local::new();
        let clock = Simulated::default();
        let mut storage = Storage::load(Words::<32>(&chip), vehicle.for_storage());
        clock.run(100_000, storage.keep(&clock, vehicle.for_storage()), |_| ());
        for frame in &frames {
            assert_eq!(judged(&vehicle.signing, frame, 0), Err(Refusal::Replayed));
        }
        // The station receives the vehicle's stamps and goes on from there, on a clock that begins anew.
        let mut said = MAVLinkV2MessageRaw::new();
        said.serialize_message_data(MavHeader { system_id: 1, component_id: 1, sequence: 0 }, &HEARTBEAT_DATA::DEFAULT);
        vehicle.signing.sign(&mut said, 0);
        assert_eq!(judged(&station.signing, said.raw_bytes(), flight), Ok(()));
        station = Sender::new(255, key(), 0);
        Parser::new().feed(said.raw_bytes(), 0, &mut |frame| station.signing.follow(frame, 0));
    }
}

#[test]
fn stamps_are_kept_twice_an_hour_at_most_and_never_while_a_motor_turns() {
    let (chip, shared, clock) = (Chip::erased(), Local::new(), Simulated::default());
    shared.signing.set(key(), FIRST_STAMP, 0);
    let hour = 3_600_000_000;
    kept(&chip, &shared, &clock, hour / 2);
    let ready = chip.borrow().writes;
    assert!((1..=2).contains(&ready), "{ready}");
    report(&shared, Mode::Flying, clock.0.get());
    let mut storage = Storage::load(Words::<32>(&chip), Local::new().for_storage());
    clock.run(hour, storage.keep(&clock, shared.for_storage()), |now| {
        if now.is_multiple_of(1_000_000) {
            report(&shared, Mode::Flying, now);
        }
    });
    assert_eq!(chip.borrow().writes, ready);
    assert_eq!(KEPT_AHEAD, 2 * KEPT_AHEAD_MIN);
}

#[test]
fn a_key_that_cannot_be_stored_is_reported() {
    let (chip, shared, clock) = (Chip::erased(), Local::new(), Simulated::default());
    chip.borrow_mut().worn = true;
    report(&shared, Mode::Ready, 0);
    shared.set_signing(key(), FIRST_STAMP, 0);
    kept(&chip, &shared, &clock, 60_000_000);
    assert_eq!(texts(&shared), ["Signing: key or stamps could not be saved"]);
    assert_eq!(chip.borrow().writes, 2);
}

#[test]
fn signing_that_was_turned_off_stays_off_after_a_restart() {
    let (chip, shared, clock) = (Chip::erased(), Local::new(), Simulated::default());
    let mut storage = Storage::load(Words::<32>(&chip), shared.for_storage());
    report(&shared, Mode::Ready, 0);
    for key in [key(), None] {
        shared.set_signing(key, FIRST_STAMP, 0);
        clock.run(100_000, storage.keep(&clock, shared.for_storage()), |_| ());
    }
    let again = Local::new();
    Storage::load(Words::<32>(&chip), again.for_storage());
    Fed::new(&again).message(&disarm(), NOW_US);
    assert!(is_stopped(&again));
}

use super::*;

/// A record with its number in every byte.
fn record(number: usize) -> [u8; tick::TICK_BYTES] {
    [number as u8; tick::TICK_BYTES]
}

/// What can be read, by the records' first bytes.
fn read(ring: &Ring) -> Vec<u8> {
    (0..ring.len()).map(|index| ring.get(index).unwrap()[0]).collect()
}

fn recovered(slots: &[Slot]) -> Vec<u8> {
    read(&Ring::recover(&mut slots.to_vec()))
}

/// Memory after `first` records of one flight and `second` of another.
fn flown(slots: usize, first: usize, second: usize) -> Vec<Slot> {
    let mut memory = vec![[0; SLOT_BYTES]; slots];
    let mut ring = Ring::recover(&mut memory);
    ring.begin();
    (0..first).for_each(|number| ring.put(&record(200 + number)));
    ring.begin();
    (0..second).for_each(|number| ring.put(&record(number)));
    memory
}

#[test]
fn the_oldest_records_give_way_and_the_others_stay_in_order() {
    let mut memory = vec![[0; SLOT_BYTES]; 5];
    let mut ring = Ring::recover(&mut memory);
    assert!(ring.is_empty() && ring.get(0).is_none());
    ring.begin();
    for number in 0..23 {
        ring.put(&record(number));
        let oldest = number.saturating_sub(4);
        assert_eq!(read(&ring), (oldest..=number).map(|number| number as u8).collect::<Vec<_>>());
    }
    assert!(ring.get(5).is_none());
    assert_eq!(recovered(&memory), [18, 19, 20, 21, 22]);
}

#[test]
fn a_flight_hides_the_one_before_and_a_reset_finds_the_last_one_that_has_records() {
    assert_eq!(recovered(&flown(8, 3, 4)), [0, 1, 2, 3]);
    assert_eq!(recovered(&flown(8, 3, 0)), [200, 201, 202]);
    let mut memory = flown(8, 3, 4);
    let mut ring = Ring::recover(&mut memory);
    ring.begin();
    assert!(ring.is_empty());
    ring.put(&record(9));
    assert_eq!(read(&ring), [9]);
    assert_eq!(recovered(&memory), [9]);
}

#[test]
fn a_write_that_a_reset_cuts_short_loses_no_more_than_itself_and_the_oldest() {
    for (slots, records) in [(6, 0), (6, 1), (6, 5), (6, 6), (6, 15)] {
        let before = flown(slots, 2, records);
        let after = flown(slots, 2, records + 1);
        let [old, new] = [&before, &after].map(|memory| recovered(memory));
        // All but the oldest, if it is that one's place.
        let survivors = if records >= slots { old[1..].to_vec() } else { old.clone() };
        let changed = (0..slots).find(|&slot| before[slot] != after[slot]).unwrap();
        for written in 0..=SLOT_BYTES {
            // The first bytes, the last bytes, and every third: the order in which memory is written is unknown.
            let orders: [&dyn Fn(usize) -> bool; 3] =
                [&|byte| byte < written, &|byte| byte >= SLOT_BYTES - written, &|byte| byte % 3 == 0 && byte < written];
            for is_written in orders {
                let mut torn = before.clone();
                (0..SLOT_BYTES)
                    .filter(|&byte| is_written(byte))
                    .for_each(|byte| torn[changed][byte] = after[changed][byte]);
                let found = recovered(&torn);
                // In an empty flight nothing is left but the flight before.
                let none_yet = records == 0 && found == [200, 201];
                assert!(found == survivors || found == old || found == new || none_yet, "{slots} {records} {written}");
            }
        }
    }
}

#[test]
fn what_was_never_written_holds_nothing_and_neither_does_no_memory() {
    for byte in [0x00, 0xFF, 0xA5] {
        assert!(recovered(&[[byte; SLOT_BYTES]; 9]).is_empty());
    }
    let noise: Vec<Slot> = (0..64_usize)
        .map(|slot| core::array::from_fn(|byte| (((slot * SLOT_BYTES + byte) * 2_654_435_761) >> 13) as u8))
        .collect();
    assert!(recovered(&noise).is_empty());
    let mut ring = Ring::recover(&mut []);
    ring.begin();
    ring.put(&record(1));
    assert!(ring.is_empty() && ring.get(0).is_none());
}

#[test]
fn a_record_that_has_changed_ends_what_can_be_read() {
    let memory = flown(8, 0, 8);
    for slot in 0..8 {
        for byte in 0..SLOT_BYTES {
            let mut changed = memory.clone();
            changed[slot][byte] ^= 0x10;
            let expected: Vec<u8> = if slot == 7 { (0..7).collect() } else { (slot as u8 + 1..8).collect() };
            assert_eq!(recovered(&changed), expected, "{slot} {byte}");
        }
    }
}

#[test]
fn what_is_erased_stays_so_after_a_reset_and_recording_goes_on() {
    let mut memory = flown(8, 3, 4);
    let mut ring = Ring::recover(&mut memory);
    ring.erase();
    assert!(ring.is_empty());
    ring.put(&record(5));
    assert_eq!(read(&ring), [5]);
    assert_eq!(recovered(&memory), [5]);
}

//! The flight recorder between control and the link: what is recorded, and how a ground station fetches it.

use crate::support::line::Outgoing;
use crate::support::receiver::{Fed, Local};
use crate::support::{Simulated, sent};
use core::cell::RefCell;
use firmware::hardware::MotorCommand;
use firmware::link::transmit::transmit;
use firmware::recorder::ring::{Ring, SLOT_BYTES};
use firmware::recorder::ulog;
use firmware::recorder::{RECORD_SPACING_MIN_US, RECORDED_AFTERWARDS_US, SPACING_BESIDE_GYRO_US};
use firmware::shared::Report;
use mavlink::dialects::common::{
    LOG_DATA_DATA, LOG_ENTRY_DATA, LOG_ERASE_DATA, LOG_REQUEST_DATA_DATA, LOG_REQUEST_END_DATA, LOG_REQUEST_LIST_DATA,
    STATUSTEXT_DATA,
};

const RING_RECORDS: usize = 500;

/// Ticks that are recorded after a flight, with the one in which it ends.
const TICKS_AFTERWARDS: u64 = RECORDED_AFTERWARDS_US / RECORD_SPACING_MIN_US;

/// Shared, with a recorder for [`RING_RECORDS`] ticks.
fn shared() -> Local {
    let shared = Local::new();
    shared.recorder.attach(Ring::recover(Box::leak(vec![[0; SLOT_BYTES]; RING_RECORDS].into_boxed_slice())), "mine");
    shared
}

/// Ticks of a vehicle that is armed or not, from tick `from` on.
fn ticks(shared: &Local, armed: bool, from: u64, count: u64) {
    for number in from..from + count {
        let tick = || Report::NONE.tick(number * 10_000, MotorCommand::Stop, [None; 4], Some(11.1));
        shared.recorder.record(armed, tick);
    }
}

fn list() -> LOG_REQUEST_LIST_DATA {
    LOG_REQUEST_LIST_DATA { start: 0, end: 0xFFFF, target_system: 1, target_component: 1 }
}

fn part(ofs: u32, count: u32) -> LOG_REQUEST_DATA_DATA {
    LOG_REQUEST_DATA_DATA { ofs, count, id: 0, target_system: 1, target_component: 1 }
}

/// What goes out within `duration`, us.
fn transmitted(shared: &Local, duration: u64) -> RefCell<Vec<u8>> {
    let (clock, written) = (Simulated::default(), RefCell::default());
    clock.run(duration, transmit(Outgoing { written: &written, at_once: 64 }, &clock, shared.for_transmit()), |_| ());
    written
}

fn entry(shared: &Local) -> LOG_ENTRY_DATA {
    Fed::new(shared).message(&list(), 0);
    let entries: Vec<LOG_ENTRY_DATA> = sent(&transmitted(shared, 50_000));
    assert_eq!(entries.len(), 1);
    entries.into_iter().next().unwrap()
}

#[test]
fn a_flight_and_two_seconds_after_it_are_recorded_and_the_next_one_replaces_it() {
    let shared = shared();
    ticks(&shared, false, 0, 10);
    assert_eq!(shared.recorder.size(), None);
    ticks(&shared, true, 10, 50);
    assert_eq!((shared.recorder.size(), shared.recorder.read(0, &mut [0; 90])), (None, 0));
    ticks(&shared, false, 60, 1_000);
    let recorded = 50 + TICKS_AFTERWARDS as usize - 1;
    assert_eq!(shared.recorder.size(), Some(ulog::size(recorded)));
    // The time of the first record stands in the file's head.
    let mut head = [0; 16];
    assert_eq!((shared.recorder.read(0, &mut head), &head[8..]), (16, &100_000_u64.to_le_bytes()[..]));
    ticks(&shared, true, 2_000, 5);
    ticks(&shared, false, 2_005, 1_000);
    assert_eq!(shared.recorder.size(), Some(ulog::size(5 + TICKS_AFTERWARDS as usize - 1)));
}

#[test]
fn at_any_rate_records_are_ten_milliseconds_or_more_apart_and_last_as_long() {
    let alone = RECORD_SPACING_MIN_US;
    for (period, least, spacing) in [
        (1_000, alone, 10_000),
        (2_000, alone, 10_000),
        (4_000, alone, 12_000),
        (20_000, alone, 20_000),
        (10_000, SPACING_BESIDE_GYRO_US, 40_000),
    ] {
        let shared = shared();
        shared.recorder.ticks_last(period, least);
        assert_eq!(shared.recorder.spacing(), spacing);
        let times = RefCell::new(Vec::new());
        for now in (0..5_000_000).step_by(period as usize) {
            shared.recorder.record((1_200_000..2_400_000).contains(&now), || {
                times.borrow_mut().push(now);
                Report::NONE.tick(now, MotorCommand::Stop, [None; 4], None)
            });
        }
        let times = times.into_inner();
        let last = 1_200_000 + (1_200_000 + RECORDED_AFTERWARDS_US - 2 * period) / spacing * spacing;
        assert_eq!((times[0], *times.last().unwrap()), (1_200_000, last), "{period} us");
        assert!(times.windows(2).all(|pair| pair[1] - pair[0] == spacing), "{times:?}");
    }
}

#[test]
fn a_ground_station_lists_it_fetches_it_and_erases_it() {
    let shared = shared();
    assert_eq!(entry(&shared), LOG_ENTRY_DATA::DEFAULT);
    ticks(&shared, true, 0, 100);
    assert_eq!(entry(&shared), LOG_ENTRY_DATA::DEFAULT, "while it is made");
    ticks(&shared, false, 100, TICKS_AFTERWARDS);
    let size = ulog::size(99 + TICKS_AFTERWARDS as usize);
    assert_eq!(entry(&shared), LOG_ENTRY_DATA { size, num_logs: 1, ..LOG_ENTRY_DATA::DEFAULT });

    let mut fed = Fed::new(&shared);
    fed.message(&part(0, u32::MAX), 0);
    let parts: Vec<LOG_DATA_DATA> = sent(&transmitted(&shared, 3_000_000));
    let mut file: Vec<u8> = vec![];
    for LOG_DATA_DATA { ofs, id, count, data } in &parts {
        assert_eq!((*ofs as usize, *id), (file.len(), 0));
        file.extend(&data[..usize::from(*count)]);
    }
    assert!(parts.last().unwrap().count < 90);
    let mut whole = vec![0; size as usize];
    assert_eq!(shared.recorder.read(0, &mut whole), whole.len());
    assert_eq!(file, whole);

    // A gap is requested again, and a download ends on request.
    fed.message(&part(180, 100), 0);
    let parts: Vec<LOG_DATA_DATA> = sent(&transmitted(&shared, 50_000));
    assert_eq!(parts.iter().map(|part| (part.ofs, part.count)).collect::<Vec<_>>(), [(180, 90), (270, 10)]);
    fed.message(&part(0, u32::MAX), 0);
    fed.message(&LOG_REQUEST_END_DATA { target_system: 1, target_component: 1 }, 0);
    assert!(sent::<LOG_DATA_DATA>(&transmitted(&shared, 50_000)).is_empty());

    // There is no other recording, and those of other vehicles are theirs.
    fed.message(&LOG_REQUEST_DATA_DATA { id: 1, ..part(0, 90) }, 0);
    let unknown = transmitted(&shared, 50_000);
    assert!(sent::<LOG_DATA_DATA>(&unknown).is_empty());
    let texts: Vec<STATUSTEXT_DATA> = sent(&unknown);
    assert_eq!(texts[0].text.to_str(), Ok("Log 1: not found"));
    fed.message(&LOG_REQUEST_DATA_DATA { target_system: 2, ..part(0, 90) }, 0);
    fed.message(&LOG_ERASE_DATA { target_system: 2, target_component: 1 }, 0);
    assert!(sent::<LOG_DATA_DATA>(&transmitted(&shared, 50_000)).is_empty());
    assert!(shared.recorder.size().is_some());
    fed.message(&LOG_ERASE_DATA { target_system: 1, target_component: 1 }, 0);
    assert_eq!(entry(&shared), LOG_ENTRY_DATA::DEFAULT);
}

#[test]
fn telemetry_and_parameters_are_not_kept_waiting_by_a_download() {
    let shared = shared();
    ticks(&shared, true, 0, 500);
    ticks(&shared, false, 500, 300);
    let mut fed = Fed::new(&shared);
    fed.message(&part(0, u32::MAX), 0);
    shared.reply(firmware::shared::Reply::AllParameters);
    let written = transmitted(&shared, 1_000_000);
    let parts: Vec<LOG_DATA_DATA> = sent(&written);
    let parameters: Vec<mavlink::dialects::common::PARAM_VALUE_DATA> = sent(&written);
    assert!((490..=501).contains(&parts.len()), "{}", parts.len());
    assert_eq!(parameters.len(), 50, "one every 20 ms");
}

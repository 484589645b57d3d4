//! The card's files over the link, by the requests that ground stations send, while the card's task logs and the link
//! does its other work.

use crate::card::{Ticks, shared, times};
use crate::support::card::{Simulation, files, parsed, small};
use crate::support::line::Outgoing;
use crate::support::receiver::{Fed, Local, report};
use crate::support::{Simulated, sent};
use core::cell::RefCell;
use core::ops::Range;
use core::pin::Pin;
use core::task::{Context, Waker};
use embassy_futures::select::select;
use firmware::card::library::FILES_OFFERED_MAX;
use firmware::card::log::GROWTH_BYTES;
use firmware::card::run;
use firmware::hardware::SECTOR_BYTES;
use firmware::link::download::ANSWER_TIMEOUT_US;
use firmware::link::transmit::transmit;
use firmware::shared::CardState;
use flight::Mode;
use mavlink::dialects::common::{
    HEARTBEAT_DATA, LOG_DATA_DATA, LOG_ENTRY_DATA, LOG_ERASE_DATA, LOG_REQUEST_DATA_DATA, LOG_REQUEST_END_DATA,
    LOG_REQUEST_LIST_DATA, PARAM_REQUEST_LIST_DATA, PARAM_VALUE_DATA, STATUSTEXT_DATA,
};
use std::collections::BTreeMap;

/// A second, us.
const SECOND_US: u64 = 1_000_000;

/// A vehicle with a card, and a ground station on its line: the tasks of both, and control as far as the recorder knows
/// it.
struct Bench {
    card: Simulation<'static>,
    clock: &'static Simulated,
    shared: &'static Local,
    written: &'static RefCell<Vec<u8>>,
    tasks: Pin<Box<dyn Future<Output = ()>>>,
    ticks: Ticks<'static>,
    armed: Vec<Range<u64>>,
}

impl Bench {
    fn new() -> Self {
        let clock: &Simulated = Box::leak(Box::default());
        let shared: &Local = Box::leak(Box::new(shared()));
        let written: &RefCell<Vec<u8>> = Box::leak(Box::default());
        let (image, sectors) = small();
        let card = Simulation::new(image, sectors, clock);
        let logging = run(card.clone(), GROWTH_BYTES, clock, shared.for_card());
        let link = transmit(Outgoing { written, at_once: 64 }, clock, shared.for_transmit());
        let tasks = Box::pin(async {
            select(logging, link).await;
        });
        Self { card, clock, shared, written, tasks, ticks: Ticks::new(shared), armed: vec![] }
    }

    /// With two flights, of a second and of three, on the card.
    fn flown() -> Self {
        let mut bench = Self::new();
        bench.armed = vec![SECOND_US..2 * SECOND_US, 5 * SECOND_US..8 * SECOND_US];
        bench.run(12 * SECOND_US, |_, _| ());
        bench
    }

    /// The tasks for `duration` us; what went out.
    fn run(&mut self, duration: u64, mut each: impl FnMut(u64, &Local)) -> RefCell<Vec<u8>> {
        let mut context = Context::from_waker(Waker::noop());
        let end = self.clock.0.get() + duration;
        while self.clock.0.get() < end {
            let now = self.clock.0.get();
            self.ticks.until(now, &self.armed);
            each(now, self.shared);
            assert!(self.tasks.as_mut().poll(&mut context).is_pending(), "a task ended");
            self.clock.0.set(self.clock.0.get() + 1_000);
            // The status task's, which does not run here.
            while self.shared.log.take().is_some() {}
        }
        RefCell::new(self.written.take())
    }

    /// A client's request, sent once; the bytes that went out.
    fn asked(&mut self, duration: u64, ask: impl FnOnce(&mut Fed<'_>)) -> RefCell<Vec<u8>> {
        ask(&mut Fed::new(self.shared));
        self.run(duration, |_, _| ())
    }

    /// A whole file, by a client that requests all of it at once.
    fn fetched(&mut self, id: u16) -> Vec<u8> {
        let parts: Vec<LOG_DATA_DATA> = sent(&self.asked(4 * SECOND_US, |fed| fed.message(&part(id, 0, u32::MAX), 0)));
        let mut file = vec![];
        for LOG_DATA_DATA { ofs, id: of, count, data } in &parts {
            assert_eq!((*ofs as usize, *of), (file.len(), id));
            file.extend(&data[..usize::from(*count)]);
        }
        assert!(parts.last().unwrap().count < 90);
        file
    }

    /// The files as an independent reader finds them.
    fn files(&self) -> BTreeMap<String, Vec<u8>> {
        let mut medium = self.card.medium.borrow_mut();
        let sectors = medium.sectors;
        files(&mut medium.image, sectors)
    }
}

/// The texts of what went out.
fn texts_in(written: &RefCell<Vec<u8>>) -> Vec<String> {
    let texts: Vec<STATUSTEXT_DATA> = sent(written);
    texts.iter().map(|text| text.text.to_str().unwrap().to_owned()).collect()
}

fn list(start: u16, end: u16) -> LOG_REQUEST_LIST_DATA {
    LOG_REQUEST_LIST_DATA { start, end, target_system: 1, target_component: 1 }
}

fn part(id: u16, ofs: u32, count: u32) -> LOG_REQUEST_DATA_DATA {
    LOG_REQUEST_DATA_DATA { ofs, count, id, target_system: 1, target_component: 1 }
}

/// Number, how many there are, the last number, and bytes of each entry.
fn entries(written: &RefCell<Vec<u8>>) -> Vec<(u16, u16, u16, u32)> {
    let entries: Vec<LOG_ENTRY_DATA> = sent(written);
    entries.iter().map(|entry| (entry.id, entry.num_logs, entry.last_log_num, entry.size)).collect()
}

#[test]
fn a_client_lists_the_files_fetches_them_fills_gaps_ends_and_erases() {
    let mut bench = Bench::flown();
    let files = bench.files();
    let recording = bench.shared.recorder.size().unwrap();
    // The used part of the two flights' files, and the recorder's recording; not the next flight's file.
    let used = |name: &str| {
        let used =
            files[name].chunks(SECTOR_BYTES).take_while(|sector| sector[3..] != [0xFF; SECTOR_BYTES - 3]).count();
        (used * SECTOR_BYTES) as u32
    };
    let sizes = [used("LOG00001.ULG"), used("LOG00002.ULG"), recording];
    assert!(
        SECTOR_BYTES as u32 * 90 < sizes[0] && sizes[0] < sizes[1] && sizes[1] < files["LOG00002.ULG"].len() as u32
    );
    let all = [(0, 3, 2, sizes[0]), (1, 3, 2, sizes[1]), (2, 3, 2, sizes[2])];
    assert_eq!(entries(&bench.asked(SECOND_US, |fed| fed.message(&list(0, u16::MAX), 0))), all);
    // A lost part is requested again; a request beyond the end returns the end.
    assert_eq!(entries(&bench.asked(SECOND_US, |fed| fed.message(&list(1, 1), 0))), all[1..2]);
    assert_eq!(entries(&bench.asked(SECOND_US, |fed| fed.message(&list(9, 20), 0))), all[2..]);

    for (id, name) in [(0, "LOG00001.ULG"), (1, "LOG00002.ULG")] {
        assert!(bench.fetched(id) == files[name][..sizes[usize::from(id)] as usize], "{name}");
    }
    let mut whole = vec![0; recording as usize];
    assert_eq!(bench.shared.recorder.read(0, &mut whole), whole.len());
    assert!(bench.fetched(2) == whole);

    // Gaps in any order, the end, and beyond it.
    let size = sizes[1];
    for (offset, count, there) in
        [(9_000, 90, 90), (180, 90, 90), (7_001, 50, 50), (size - 10, 90, 10), (size, 90, 0), (u32::MAX - 1, 90, 0)]
    {
        let parts: Vec<LOG_DATA_DATA> = sent(&bench.asked(SECOND_US, |fed| fed.message(&part(1, offset, count), 0)));
        assert_eq!(parts.iter().map(|part| (part.ofs, part.count)).collect::<Vec<_>>(), [(offset, there)]);
        let (from, to) = (offset.min(size) as usize, (offset.min(size) + u32::from(there)) as usize);
        assert_eq!(parts[0].data[..usize::from(there)], files["LOG00002.ULG"][from..to]);
    }
    let beyond = bench.asked(SECOND_US, |fed| fed.message(&part(3, 0, 90), 0));
    assert!(sent::<LOG_DATA_DATA>(&beyond).is_empty());
    assert_eq!(texts_in(&beyond), ["Log 3: not found"]);

    let begun = bench.asked(SECOND_US, |fed| {
        fed.message(&part(1, 0, u32::MAX), 0);
        fed.message(&LOG_REQUEST_END_DATA { target_system: 1, target_component: 1 }, 0);
    });
    assert!(sent::<LOG_DATA_DATA>(&begun).is_empty());

    // Erasing takes the recording and no file.
    let erased =
        bench.asked(SECOND_US, |fed| fed.message(&LOG_ERASE_DATA { target_system: 1, target_component: 1 }, 0));
    assert_eq!(texts_in(&erased), ["Log: files stay on the card; delete them there"]);
    assert!(bench.files() == files);
    assert_eq!(
        entries(&bench.asked(SECOND_US, |fed| fed.message(&list(0, u16::MAX), 0))),
        [(0, 2, 1, sizes[0]), (1, 2, 1, sizes[1])]
    );
}

#[test]
fn a_card_without_files_has_no_logs() {
    let mut bench = Bench::new();
    assert_eq!(entries(&bench.asked(SECOND_US, |fed| fed.message(&list(0, u16::MAX), 0))), [(0, 0, 0, 0)]);
}

#[test]
fn reading_writes_nothing_and_keeps_neither_telemetry_nor_parameters_waiting() {
    let mut bench = Bench::flown();
    bench.card.medium.borrow_mut().written.clear();
    let written = bench.asked(SECOND_US, |fed| {
        fed.message(&list(0, u16::MAX), 0);
        fed.message(&part(1, 0, u32::MAX), 0);
        fed.message(&PARAM_REQUEST_LIST_DATA { target_system: 1, target_component: 1 }, 0);
    });
    let parts = sent::<LOG_DATA_DATA>(&written).len();
    // One message every 2 ms, but for what the card needs for the first chunk.
    assert!((470..=500).contains(&parts), "{parts}");
    assert!(sent::<PARAM_VALUE_DATA>(&written).len() >= 44);
    assert_eq!(sent::<HEARTBEAT_DATA>(&written).len(), 1);
    assert!(bench.card.medium.borrow().written.is_empty());
}

#[test]
fn nothing_is_served_while_armed_and_arming_ends_what_was_under_way() {
    let mut bench = Bench::flown();
    let begin = bench.clock.0.get();
    let armed = begin + SECOND_US..begin + 3 * SECOND_US;
    bench.armed = vec![armed.clone()];
    let mode = |now| if armed.contains(&now) { Mode::Flying } else { Mode::Ready };
    report(bench.shared, mode(begin), begin);
    Fed::new(bench.shared).message(&part(1, 0, u32::MAX), begin);
    let before = bench.run(SECOND_US, |_, _| ());
    assert!(sent::<LOG_DATA_DATA>(&before).len() > 400 && texts_in(&before).is_empty());
    let ended = bench.run(500_000, |now, shared| report(shared, mode(now), now));
    assert!(sent::<LOG_DATA_DATA>(&ended).is_empty());
    assert_eq!(texts_in(&ended), ["Log: not while armed"]);
    let mut fed = Fed::new(bench.shared);
    fed.message(&list(0, u16::MAX), 0);
    fed.message(&part(1, 0, 90), SECOND_US);
    fed.message(&LOG_ERASE_DATA { target_system: 1, target_component: 1 }, 2 * SECOND_US);
    let refused = bench.run(500_000, |now, shared| report(shared, mode(now), now));
    assert!(sent::<LOG_DATA_DATA>(&refused).is_empty());
    assert_eq!(texts_in(&refused), ["Log: not while armed"; 3]);
    assert_eq!(entries(&refused), [(0, 0, 0, 0)]);
    // Requested before the flight is over on the card: served then. The flight is there, whole.
    bench.run(SECOND_US + 500_000, |now, shared| report(shared, mode(now), now));
    let listed = bench.asked(4 * SECOND_US, |fed| fed.message(&list(2, 2), 0));
    assert_eq!(entries(&listed).iter().map(|entry| entry.0).collect::<Vec<_>>(), [2]);
    assert_eq!(parsed(&bench.files()["LOG00003.ULG"]).ticks, times(armed.start, armed.end));
    assert_eq!(parsed(&bench.fetched(2)).ticks, times(armed.start, armed.end));
}

#[test]
fn a_card_that_falls_silent_or_goes_ends_the_download_in_words() {
    let (clock, shared) = (Simulated::default(), shared());
    shared.card.set(CardState::Ready, 0);
    let written = RefCell::default();
    let link = transmit(Outgoing { written: &written, at_once: 64 }, &clock, shared.for_transmit());
    Fed::new(&shared).message(&part(0, 0, 90), 0);
    let mut patient = true;
    clock.run(ANSWER_TIMEOUT_US + 2 * SECOND_US, link, |now| {
        patient &= now > ANSWER_TIMEOUT_US || texts_in(&written).is_empty();
    });
    assert!(patient);
    assert_eq!(texts_in(&written), ["Log: the card does not answer"]);

    let mut bench = Bench::flown();
    Fed::new(bench.shared).message(&part(1, 0, u32::MAX), 0);
    bench.run(200_000, |_, _| ());
    bench.card.medium.borrow_mut().is_absent = true;
    let gone = bench.run(SECOND_US, |_, _| ());
    assert_eq!(texts_in(&gone), ["Log 1: cannot be read"]);
}

#[test]
fn what_the_card_offered_is_not_taken_for_the_recorders_when_the_card_goes() {
    let mut bench = Bench::flown();
    Fed::new(bench.shared).message(&part(0, 0, u32::MAX), 0);
    bench.run(50_000, |_, _| ());
    let sent_after = bench.run(SECOND_US, |now, shared| shared.card.set(CardState::Failed, now));
    assert_eq!(texts_in(&sent_after), ["Log: the card has come or gone, list again"]);
    assert!(sent::<LOG_DATA_DATA>(&sent_after).len() < 20);
}

#[test]
fn an_unreadable_file_is_reported_and_the_next_flight_is_logged() {
    let mut bench = Bench::flown();
    let worn = bench.files()["LOG00001.ULG"][18 * SECTOR_BYTES..19 * SECTOR_BYTES].to_vec();
    bench.card.medium.borrow_mut().worn = Some(worn);
    let failed = bench.asked(SECOND_US, |fed| fed.message(&part(0, 0, u32::MAX), 0));
    assert!(sent::<LOG_DATA_DATA>(&failed).len() < 120);
    assert_eq!(texts_in(&failed), ["Log 0: cannot be read"]);
    assert!(!bench.fetched(1).is_empty());
    let begin = bench.clock.0.get();
    let armed = begin + SECOND_US..begin + 2 * SECOND_US;
    bench.armed = vec![armed];
    bench.run(5 * SECOND_US, |_, _| ());
    assert_eq!(parsed(&bench.files()["LOG00003.ULG"]).ticks, times(begin + SECOND_US, begin + 2 * SECOND_US));
}

#[test]
fn of_many_files_the_newest_are_offered_in_their_order() {
    let mut bench = Bench::new();
    let flights = FILES_OFFERED_MAX as u64 + 3;
    bench.armed =
        (0..flights).map(|flight| (1 + 4 * flight) * SECOND_US..(1 + 4 * flight) * SECOND_US + 50_000).collect();
    bench.run((flights * 4 + 2) * SECOND_US, |_, _| ());
    bench.shared.recorder.erase();
    let listed = entries(&bench.asked(2 * SECOND_US, |fed| fed.message(&list(0, u16::MAX), 0)));
    assert_eq!(
        listed.iter().map(|entry| entry.0).collect::<Vec<_>>(),
        (0..FILES_OFFERED_MAX as u16).collect::<Vec<_>>()
    );
    assert!(listed.iter().all(|entry| entry.1 == FILES_OFFERED_MAX as u16 && entry.3 > 0));
    for (id, flight) in [(0, 3), (FILES_OFFERED_MAX as u16 - 1, flights - 1)] {
        let file = parsed(&bench.fetched(id));
        assert_eq!(file.time, (1 + 4 * flight) * SECOND_US, "{id}");
    }
}

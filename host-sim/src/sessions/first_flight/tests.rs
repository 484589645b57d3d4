//! The walk from its first check to its last, with the firmware's own tasks behind the link and a person who has hands.

use super::checks::CHECKS;
use super::course::make;
use super::line::{Address, Line};
use super::outcome::Outcome;
use super::page;
use super::person::{Person, Reply};
use super::record::{Record, Subject};
use super::vehicle::Vehicle;
use super::walk::{BOARDS, Walk};
use crate::output::interrupt::Interrupt;
use crate::sessions::ports::Ports;
use crate::sessions::sitl::Sitl;
use crate::sessions::sitl::hands::Holder;
use crate::sessions::sitl::session::SitlSession;
use crate::sessions::sitl::simulated_hardware::PoseSource;
use scenario::Scenario;
use std::collections::VecDeque;
use std::net::{Ipv4Addr, UdpSocket};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How many times as fast as the test's the vehicle's time passes.
const SPEED: u64 = 2;

/// The vehicle's time between two looks at the person's hands, us.
const STEP_US: u64 = 5_000;

/// What the person does next with the vehicle, in the words of hands; and the end.
#[derive(Default)]
struct Told {
    words: VecDeque<&'static str>,
    is_over: bool,
}

/// A vehicle on a desk, as long as it lives.
struct Desk {
    told: Arc<Mutex<Told>>,
    thread: Option<JoinHandle<()>>,
    ground: u16,
}

impl Desk {
    fn boot(text: &'static str) -> Self {
        let free = || UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap().local_addr().unwrap().port();
        let ports = Ports { offboard: free(), ground: free(), local: free() };
        let told = Arc::<Mutex<Told>>::default();
        told.lock().unwrap().words.push_back("hide");
        let shared = Arc::clone(&told);
        let thread = std::thread::spawn(move || {
            let session = SitlSession {
                file: "a file".to_owned(),
                ports,
                crtp: None,
                speed: 1.0,
                duration: None,
                poses: PoseSource::Camera,
                has_hands: false,
                faults: vec!["battery=16.0@0".parse().unwrap()],
                parameters: None,
                signing_key: None,
                truth: None,
                recording: None,
                gyro: None,
            };
            let scenario = Scenario::parse(text, "a file").unwrap();
            let (mut sitl, _) = Sitl::boot(&scenario, &session, |_| ()).unwrap();
            let (began, mut holder, mut now) = (Instant::now(), Holder::default(), 0);
            loop {
                let mut told = shared.lock().unwrap();
                told.words.drain(..).for_each(|word| holder.take(word).unwrap());
                if told.is_over {
                    break;
                }
                drop(told);
                holder.pass(STEP_US as f32 * 1e-6);
                sitl.hold(&holder);
                sitl.receive();
                now += STEP_US;
                sitl.pass(now);
                let due = Duration::from_micros(now / SPEED);
                std::thread::sleep(due.saturating_sub(began.elapsed()));
            }
        });
        Self { told, thread: Some(thread), ground: ports.ground }
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        if let Ok(mut told) = self.told.lock() {
            told.is_over = true;
        }
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Somebody who does what the walk says, and answers as the vehicle is built; `wrong` are answers and deeds that are
/// not so.
struct Somebody {
    hands: Arc<Mutex<Told>>,
    sides: VecDeque<&'static str>,
    wrong: Vec<(&'static str, &'static str)>,
    told: Vec<String>,
}

impl Somebody {
    fn at(desk: &Desk, wrong: &[(&'static str, &'static str)]) -> Self {
        let sides = VecDeque::from(["on-left", "on-right", "on-nose", "on-tail", "on-back"]);
        Self { hands: Arc::clone(&desk.told), sides, wrong: wrong.to_vec(), told: Vec::new() }
    }

    fn hands(&self, word: &'static str) {
        self.hands.lock().unwrap().words.push_back(word);
    }

    fn wrong(&self, key: &str) -> Option<&'static str> {
        self.wrong.iter().find(|(wrong, _)| *wrong == key).map(|(_, answer)| *answer)
    }
}

impl Person for Somebody {
    fn tell(&mut self, key: &str, text: &str) {
        self.told.push(format!("{key}: {text}"));
        let word = match key {
            "axes.nose-up" | "tilt.nose-up" => "nose-up",
            "axes.left-up" | "tilt.left-up" => "left-up",
            "axes.turned-left" | "tilt.turned-left" => "turned-left",
            "calibration.progress" if text.contains("of 6 sides") => self.sides.pop_front().unwrap_or("flat"),
            "kill.on" => "kill",
            "kill.off" => "unkill",
            "arming.north" => "carry 0 1 0",
            "arming.east" => "carry 1 1 0",
            "arming.up" => "carry 1 1 1",
            "arming.down" => "carry 0 0 0",
            _ if key.ends_with(".back") || key == "calibration" || key == "battery" => "flat",
            _ => return,
        };
        self.hands(self.wrong(key).unwrap_or(word));
    }

    fn ask(&mut self, key: &str, _: &str) {
        match key {
            // Until the hands have laid it down.
            "calibration.level" => std::thread::sleep(Duration::from_secs(3)),
            "arming" => self.hands("show"),
            _ => {}
        }
    }

    fn reply(&mut self, key: &str) -> Reply {
        let wrong = self.wrong(key);
        let places = ["front left", "front right", "rear right", "rear left"];
        let motor = key.strip_prefix("motors.").and_then(|rest| rest.split_once('.'));
        let answer = match (key, motor) {
            _ if wrong.is_some() => wrong.unwrap_or_default(),
            ("usb" | "radio" | "bootloader", _) => "no",
            ("frames", _) => "skip",
            ("battery.meter", _) => "16.05",
            (_, Some((number, "place"))) => places[number.parse::<usize>().unwrap() - 1],
            (_, Some((number, "way"))) => ["ccw", "cw"][number.parse::<usize>().unwrap() % 2],
            ("calibration.gyro" | "calibration.sides" | "calibration.level", _) => "ready",
            _ => "yes",
        };
        Reply::Given(answer.to_owned())
    }
}

/// An empty record in a directory of its own.
fn record(name: &str) -> Record {
    let directory = std::env::temp_dir().join(format!("{name}-{}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    let path: PathBuf = directory.join("record.toml");
    let _ = std::fs::remove_file(&path);
    let subject = Subject { board: "micoair-h743".to_owned(), scenario: String::new(), image: String::new() };
    Record::open(&path, subject).unwrap().0
}

/// A vehicle's link, heard already.
fn link(desk: &Desk) -> Vehicle {
    let line = Line::open(Address::Udp(format!("127.0.0.1:{}", desk.ground))).unwrap();
    let mut vehicle = Vehicle::new(line, Interrupt::default(), 1.0);
    let heard = vehicle.wait(Duration::from_secs(60), |vehicle| vehicle.heartbeat()).unwrap();
    assert!(heard.is_some(), "no heartbeat");
    vehicle
}

#[test]
fn a_walk_passes_from_the_first_check_to_the_last_and_its_page_says_so() {
    let desk = Desk::boot(scenario::STUDY);
    let scenario = Scenario::parse(scenario::STUDY, "a file").unwrap();
    let mut person = Somebody::at(&desk, &[]);
    let mut vehicle = link(&desk);
    for (name, volts) in [("BAT_LOW", 14.0), ("BAT_CRIT", 13.5), ("MOT_IDLE", 0.05)] {
        vehicle.set_parameter(name, volts).unwrap();
    }
    let mut record = record("walk");
    let made = make(&mut Walk::new(vehicle, &mut person, &scenario, BOARDS[0]), &mut record, None);
    let page = page::page(&record, &CHECKS, "study", "today");
    assert_eq!(made, Ok(true), "{page}\n{:#?}", person.told);
    let skipped: Vec<_> = record.entries.iter().filter(|entry| matches!(entry.outcome, Outcome::Skipped(_))).collect();
    let skipped: Vec<_> = skipped.iter().map(|entry| entry.id.as_str()).collect();
    assert_eq!(skipped, ["usb", "frames", "radio", "bootloader"]);
    assert_eq!(record.entries.len(), CHECKS.len());
    assert!(!page.contains("FAILED") && !page.contains("| not made |"), "{page}");
    assert!(page.contains("inequalities as in the file, certified") && page.contains("16.00 V, the meter 16.05 V"));
    // What passed is not made again, but for the first.
    let again = make(&mut Walk::new(link(&desk), &mut person, &scenario, BOARDS[0]), &mut record, None);
    assert_eq!(again, Ok(true));
}

/// The last entry of a walk, of one check or of all, with these answers and deeds.
fn failing(desk: &Desk, only: Option<&str>, wrong: &[(&'static str, &'static str)]) -> (String, String) {
    let scenario = Scenario::parse(scenario::STUDY, "a file").unwrap();
    let mut person = Somebody::at(desk, wrong);
    let mut record = record("failing");
    let made = make(&mut Walk::new(link(desk), &mut person, &scenario, BOARDS[0]), &mut record, only);
    assert_eq!(made, Ok(false), "{:#?}", person.told);
    let entry = record.entries.last().unwrap();
    assert!(matches!(entry.outcome, Outcome::Failed(_)), "{entry:?}");
    (entry.id.clone(), entry.outcome.figures().to_owned())
}

#[test]
fn a_walk_ends_at_what_is_wrong_and_names_it() {
    let desk = Desk::boot(scenario::STUDY);
    for (only, wrong, words) in [
        ("battery", ("battery.meter", "14.0"), "a wrong divider"),
        ("motors", ("propellers-off", "no"), "propellers off first"),
        ("motors", ("motors.2.place", "rear left"), "motor 2 is rear left, in the file front right"),
        ("motors", ("motors.1.way", "ccw"), "motor 1 turns ccw, in the file cw"),
        ("frames", ("frames", "no"), "differ"),
    ] {
        let (id, figures) = failing(&desk, Some(only), &[wrong]);
        assert!(id == only && figures.contains(words), "{id}: {figures}");
    }
    // Built with one file, checked with another.
    let other = scenario::STUDY.replace("name = \"study\"", "name = \"other\"");
    let other = Scenario::parse(&other, "another").unwrap();
    let (mut person, mut record) = (Somebody::at(&desk, &[]), record("other"));
    let made = make(&mut Walk::new(link(&desk), &mut person, &other, BOARDS[0]), &mut record, None);
    assert_eq!(made, Ok(false));
    assert!(record.entries[0].outcome.figures().contains("the file is \"other\""), "{:?}", record.entries);
}

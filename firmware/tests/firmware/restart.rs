//! A restart by command: granted on the ground, refused otherwise, and done after it was answered.

use crate::support::Simulated;
use crate::support::receiver::{Fed, Local, command, ordered, replies, report, texts};
use firmware::hardware::Restart;
use firmware::link::acknowledgement::Acknowledgement;
use firmware::restart::{self, RESTART_DELAY_US};
use firmware::shared::Reply;
use flight::Mode;
use mavlink::dialects::common::{MavCmd, MavResult};
use std::cell::Cell;

const RESTART: MavCmd = MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN;

/// A command with this first parameter: the answer, the texts, and whether a restart is under way.
fn asked(shared: &Local, first: f32) -> (MavResult, Vec<String>, bool) {
    Fed::new(shared).message(&command(RESTART, [first, 0.0, 0.0, 0.0, 0.0]), 0);
    let [Reply::Command(Acknowledgement { order, result })] = replies(shared)[..] else { panic!("no answer") };
    assert_eq!(order, ordered(RESTART));
    (result, texts(shared), shared.restarting.is_raised())
}

fn restartable(mode: Mode) -> Local {
    let shared = Local::new();
    shared.can_restart.raise();
    shared.has_bootloader.raise();
    report(&shared, mode, 0);
    shared
}

#[test]
fn it_is_granted_where_no_motor_turns_and_in_no_other_mode() {
    for (mode, first) in Mode::ALL.into_iter().flat_map(|mode| [(mode, 1.0), (mode, 3.0)]) {
        let turns = mode.is_armed() || mode == Mode::MotorTest;
        let shared = restartable(mode);
        let (result, texts, restarting) = asked(&shared, first);
        if turns {
            assert_eq!((result, restarting), (MavResult::MAV_RESULT_DENIED, false), "{mode:?}");
            assert_eq!(texts, ["Restart: only disarmed, and no motor turning"]);
        } else {
            assert_eq!((result, restarting), (MavResult::MAV_RESULT_ACCEPTED, true), "{mode:?}");
            assert_eq!(shared.into_bootloader.is_raised(), first == 3.0, "{mode:?}");
        }
    }
}

#[test]
fn it_waits_for_flash_and_needs_somebody_who_can() {
    let shared = restartable(Mode::Ready);
    shared.saving.raise();
    let words = vec!["Restart: parameters are being saved".to_owned()];
    assert_eq!(asked(&shared, 1.0), (MavResult::MAV_RESULT_TEMPORARILY_REJECTED, words.clone(), false));
    assert_eq!(asked(&shared, 3.0), (MavResult::MAV_RESULT_TEMPORARILY_REJECTED, words, false));
    let words = vec!["Restart: not supported here".to_owned()];
    assert_eq!(asked(&Local::new(), 1.0), (MavResult::MAV_RESULT_UNSUPPORTED, words, false));
}

#[test]
fn other_restarts_are_unsupported_in_words() {
    for (first, words) in [
        (2.0, "Restart: parameter 1 is 1 or 3, nothing else"),
        (f32::NAN, "Restart: parameter 1 is 1 or 3, nothing else"),
    ] {
        let expected = (MavResult::MAV_RESULT_UNSUPPORTED, vec![words.to_owned()], false);
        assert_eq!(asked(&restartable(Mode::Ready), first), expected);
    }
    let shared = restartable(Mode::Ready);
    shared.has_bootloader.lower();
    let words = vec!["Restart: there is no bootloader".to_owned()];
    assert_eq!(asked(&shared, 3.0), (MavResult::MAV_RESULT_UNSUPPORTED, words, false));
    Fed::new(&shared).message(&command(RESTART, [1.0, 1.0, 0.0, 0.0, 0.0]), 0);
    assert_eq!(texts(&shared), ["Restart: there is only the autopilot"]);
    assert!(!shared.restarting.is_raised());
}

#[test]
fn what_is_refused_leaves_alone_what_was_accepted() {
    for (accepted, refused) in [(1.0, 3.0), (3.0, 1.0)] {
        let shared = restartable(Mode::Ready);
        assert_eq!(asked(&shared, accepted), (MavResult::MAV_RESULT_ACCEPTED, vec![], true));
        let words = vec!["Restart: another one is under way".to_owned()];
        assert_eq!(asked(&shared, refused), (MavResult::MAV_RESULT_TEMPORARILY_REJECTED, words, true));
        assert_eq!(shared.into_bootloader.is_raised(), accepted == 3.0);
        // QueuedRequest again, it is as if it were asked once.
        assert_eq!(asked(&shared, accepted), (MavResult::MAV_RESULT_ACCEPTED, vec![], true));
    }
    let shared = restartable(Mode::Ready);
    shared.has_bootloader.lower();
    asked(&shared, 1.0);
    let words = vec!["Restart: there is no bootloader".to_owned()];
    assert_eq!(asked(&shared, 3.0), (MavResult::MAV_RESULT_UNSUPPORTED, words, true));
    assert!(!shared.into_bootloader.is_raised());
}

/// When it was restarted, and whether into its bootloader.
struct Machine<'a>(&'a Simulated, &'a Cell<Option<(u64, bool)>>, &'a Local);

impl Machine<'_> {
    fn started(&self, bootloader: bool) {
        self.1.set(Some((self.0.0.get(), bootloader)));
        self.2.restarting.lower();
    }
}

impl Restart for Machine<'_> {
    const HAS_BOOTLOADER: bool = true;

    fn restart(&mut self) {
        self.started(false);
    }

    fn start_bootloader(&mut self) {
        self.started(true);
    }
}

/// When it restarts, and into what, if this is commanded at half a second, in this mode from then on.
fn restarted(mode: Mode, first: f32) -> (Option<(u64, bool)>, Vec<String>) {
    let (clock, shared, time) = (Simulated::default(), Local::new(), Cell::new(None));
    let mut machine = Machine(&clock, &time, &shared);
    clock.run(2_000_000, restart::run(shared.for_restart(), &clock, &mut machine), |now| {
        if now == 500_000 {
            assert!(shared.can_restart.is_raised() && shared.has_bootloader.is_raised() && time.get().is_none());
            report(&shared, Mode::Ready, now);
            Fed::new(&shared).message(&command(RESTART, [first, 0.0, 0.0, 0.0, 0.0]), 0);
            report(&shared, mode, now);
        }
    });
    assert!(!shared.restarting.is_raised());
    (time.get(), texts(&shared))
}

#[test]
fn it_is_done_once_the_answer_had_time_to_go_out() {
    for (first, into_bootloader) in [(1.0, false), (3.0, true)] {
        let (started, texts) = restarted(Mode::Ready, first);
        let (time, bootloader) = started.unwrap();
        assert!((500_000 + RESTART_DELAY_US..=600_000 + RESTART_DELAY_US).contains(&time), "{time:?}");
        assert_eq!((bootloader, texts), (into_bootloader, vec![]));
    }
}

#[test]
fn a_motor_that_turns_after_all_is_not_stopped_by_it() {
    for first in [1.0, 3.0] {
        assert_eq!(restarted(Mode::MotorTest, first), (None, vec!["Restart: not now".to_owned()]));
    }
}

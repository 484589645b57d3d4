//! Requests that wait for control, which takes one a tick.
//!
//! Of each kind the latest waits, one of the link and one of the pilot's radio: a client that repeats one keeps another
//! out. An equal request that waits is answered with it. Where there is no room, a lesser one of the link makes some.
//! So landing, disarming and the pilot's switches always have room, and none waits for more than the others,
//! [`REQUESTS_CAPACITY`] ticks.

use crate::link::acknowledgement::Order;
use core::cell::RefCell;
use core::mem::discriminant;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use flight::Request;
use heapless::Deque;

/// How many may wait: the five of the radio, landing and disarming by the link, and one of the others.
pub const REQUESTS_CAPACITY: usize = 8;

/// A request to control, to be answered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QueuedRequest {
    /// What for.
    pub request: Request,
    /// The command it came by, if it came over the link.
    pub order: Option<Order>,
    /// Whose setpoints are to be flown, system and component, where the link requests it.
    pub setpoints: Option<(u8, u8)>,
}

/// Requests in the order of their coming.
pub struct Requests<M: RawMutex>(Mutex<M, RefCell<Deque<QueuedRequest, REQUESTS_CAPACITY>>>);

impl<M: RawMutex> Requests<M> {
    /// None.
    pub const fn new() -> Self {
        Self(Mutex::new(RefCell::new(Deque::new())))
    }

    /// Puts a request behind the others and takes away the one of its kind, or else a lesser one where there is no
    /// room: the command by which that came, to be answered, and whether it was the same.
    pub(super) fn put(&self, asked: QueuedRequest) -> Option<(Order, bool)> {
        let way = |asked: &QueuedRequest| (kind(&asked.request), asked.order.is_some());
        self.0.lock(|waiting| {
            let mut waiting = waiting.try_borrow_mut().ok()?;
            let alike = waiting.iter().position(|other| way(other) == way(&asked));
            let place = alike.or_else(|| waiting.iter().position(is_lesser).filter(|_| waiting.is_full()));
            let before = place.and_then(|place| remove(&mut waiting, place));
            // There is room now.
            let _ = waiting.push_back(asked);
            before.and_then(|before| Some((before.order?, is_same(&before, &asked))))
        })
    }

    /// Takes the first one.
    #[must_use]
    pub fn take(&self) -> Option<QueuedRequest> {
        self.0.lock(|waiting| waiting.try_borrow_mut().ok()?.pop_front())
    }
}

/// Takes the one at a place, by handing all of them round: nothing here may panic in control's tick.
fn remove(waiting: &mut Deque<QueuedRequest, REQUESTS_CAPACITY>, place: usize) -> Option<QueuedRequest> {
    let mut removed = None;
    for index in 0..waiting.len() {
        let asked = waiting.pop_front()?;
        if index == place {
            removed = Some(asked);
        } else {
            // There is room: it was there.
            let _ = waiting.push_back(asked);
        }
    }
    removed
}

/// Whether it makes room for others.
fn is_lesser(asked: &QueuedRequest) -> bool {
    (asked.order.is_some() || matches!(asked.request, Request::SetMissionItem(_)))
        && !matches!(asked.request, Request::Land | Request::Disarm)
}

/// Whether two requests are equal, of the kinds that clients repeat: not points and motors.
fn is_same(one: &QueuedRequest, other: &QueuedRequest) -> bool {
    let is_alike = match (&one.request, &other.request) {
        (Request::TakeOff(one), Request::TakeOff(other)) => one == other,
        (Request::FlyMission(one), Request::FlyMission(other)) => one == other,
        (Request::SetMissionItem(one), Request::SetMissionItem(other)) => one == other,
        (Request::GoTo(_) | Request::MotorTest(_) | Request::MotorSetting(_), _) => false,
        (one, other) => discriminant(one) == discriminant(other),
    };
    is_alike && one.setpoints == other.setpoints
}

/// What replaces what.
const fn kind(request: &Request) -> u8 {
    match request {
        Request::Arm => 0,
        Request::Disarm => 1,
        Request::TakeOff(_) => 2,
        Request::FlySetpoints | Request::FlyMission(_) | Request::FlyPolicy => 3,
        Request::Hold | Request::GoTo(_) => 4,
        Request::Land => 5,
        Request::MotorTest(_) | Request::MotorSetting(_) | Request::EndMotorTest => 6,
        Request::SetMissionItem(_) => 7,
    }
}

//! Time that stands still until every task waits for it, and the executor that moves it.
//!
//! All tasks share one thread. They run until none can go on; then the clock jumps to the earliest moment that any of
//! them waits for. Minutes of flight take as long as their computations, and every run is the same.

use firmware::hardware::Clock;
use futures::executor::LocalPool;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::future::Future;
use std::pin::Pin;
use std::rc::Rc;
use std::task::{Context, Poll, Waker};

/// The simulated clock; clones are the same clock.
#[derive(Clone, Default)]
pub struct SimClock(Rc<Inner>);

#[derive(Default)]
struct Inner {
    now: Cell<u64>,
    sequence: Cell<u64>,
    /// Who waits for when, in the order they began to.
    waiting: RefCell<BTreeMap<(u64, u64), Waker>>,
}

impl SimClock {
    /// Jumps to the earliest time waited for, but not beyond `end`; false if no time is due before it.
    fn advance(&self, end: u64) -> bool {
        let mut waiting = self.0.waiting.borrow_mut();
        let Some((&(time, _), _)) = waiting.first_key_value().filter(|((time, _), _)| *time <= end) else {
            self.0.now.set(end);
            return false;
        };
        self.0.now.set(time);
        let later = waiting.split_off(&(time + 1, 0));
        let due = std::mem::replace(&mut *waiting, later);
        drop(waiting);
        due.into_values().for_each(Waker::wake);
        true
    }

    /// Runs everything spawned on `pool` until `end`, us.
    pub fn run(&self, pool: &mut LocalPool, end: u64) {
        pool.run_until_stalled();
        while self.advance(end) {
            pool.run_until_stalled();
        }
    }
}

impl Clock for SimClock {
    fn now(&self) -> u64 {
        self.0.now.get()
    }

    fn until(&self, time: u64) -> impl Future<Output = ()> {
        Alarm { clock: self.clone(), time, key: None }
    }
}

/// Waits for a time; a dropped one waits no longer.
struct Alarm {
    clock: SimClock,
    time: u64,
    key: Option<(u64, u64)>,
}

impl Future for Alarm {
    type Output = ();

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<()> {
        let inner = Rc::clone(&self.clock.0);
        if inner.now.get() >= self.time {
            return Poll::Ready(());
        }
        let key = *self.key.get_or_insert_with(|| {
            let sequence = inner.sequence.get() + 1;
            inner.sequence.set(sequence);
            (0, sequence)
        });
        let key = (self.time, key.1);
        self.key = Some(key);
        inner.waiting.borrow_mut().insert(key, context.waker().clone());
        Poll::Pending
    }
}

impl Drop for Alarm {
    fn drop(&mut self) {
        if let Some(key) = self.key {
            self.clock.0.waiting.borrow_mut().remove(&key);
        }
    }
}

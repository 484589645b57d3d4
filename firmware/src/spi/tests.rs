use super::*;
use crate::tests::bench::{self, Line, on_one_bus};
use core::cell::RefCell;
use core::pin::pin;
use core::task::{Context, Poll, Waker};
use std::rc::Rc;

/// Answers with its own name.
struct Named(u8, Line);

impl bench::Device for Named {
    fn line(&mut self) -> &mut Line {
        &mut self.1
    }

    fn exchange(&mut self, bytes: &mut [u8]) {
        bytes.fill(self.0);
    }
}

fn polled<T>(work: core::pin::Pin<&mut impl Future<Output = T>>) -> Poll<T> {
    work.poll(&mut Context::from_waker(Waker::noop()))
}

#[test]
fn devices_share_a_bus_one_at_a_time() {
    let named = |name| Rc::new(RefCell::new(Named(name, Line::default())));
    let (one, other) = (named(1), named(2));
    let [mut first, mut second] = on_one_bus([one.clone(), other.clone()]);
    let mut bytes = [0];
    assert_eq!(polled(pin!(first.exchange(&mut bytes))), Poll::Ready(Ok(())));
    assert_eq!(bytes, [1]);
    one.borrow_mut().1.hangs = true;
    {
        let mut hanging = pin!(first.exchange(&mut bytes));
        assert!(polled(hanging.as_mut()).is_pending() && one.borrow().1.selected);
        // The bench panics at two that are selected.
        assert_eq!(polled(pin!(second.exchange(&mut [0]))), Poll::Ready(Err(Fault)));
        assert_eq!(other.borrow().1.falls, 0);
    }
    assert!(!one.borrow().1.selected, "dropped half-way");
    assert_eq!(polled(pin!(second.exchange(&mut bytes))), Poll::Ready(Ok(())));
    assert_eq!(bytes, [2]);
    other.borrow_mut().1.fails = true;
    assert_eq!(polled(pin!(second.exchange(&mut bytes))), Poll::Ready(Err(Fault)));
    assert!(!other.borrow().1.selected, "a bus that fails");
}

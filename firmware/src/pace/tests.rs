use super::*;
use crate::tests::bench::{Jumping, Pin};
use core::cell::Cell;
use embassy_futures::block_on;
use std::rc::Rc;

#[test]
fn a_sample_counts_from_its_edge_however_late_its_task_wakes_up() {
    let (clock, rises) = (Jumping::default(), Rc::new(Cell::new(true)));
    let mut pace = Pace::new(Pin { rises: Rc::clone(&rises), late: 300, clock: clock.clone() }, 1_000);
    clock.jump(5_000);
    assert_eq!(block_on(pace.next(&clock)), 5_000);
    assert_eq!(clock.now(), 5_300);
    // Where edges stay away, samples are due a period after the last.
    rises.set(false);
    let missed = block_on(pace.next(&clock));
    assert_eq!([missed, block_on(pace.next(&clock))], [7_800, 8_800]);
}

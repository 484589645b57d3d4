//! A serial line in memory: bytes in order, nothing lost, no time taken.

use embedded_io_async::{ErrorType, Read, Write};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::future::poll_fn;
use std::rc::Rc;
use std::task::{Poll, Waker};

/// One direction of a line; clones are the same line.
#[derive(Clone, Default)]
pub struct MemoryLine(Rc<RefCell<Inner>>);

#[derive(Default)]
struct Inner {
    bytes: VecDeque<u8>,
    reader: Option<Waker>,
}

impl MemoryLine {
    /// Puts bytes in.
    pub fn push(&self, bytes: &[u8]) {
        let mut inner = self.0.borrow_mut();
        inner.bytes.extend(bytes);
        if let Some(reader) = inner.reader.take() {
            reader.wake();
        }
    }

    /// Takes every byte out.
    pub fn drain(&self) -> Vec<u8> {
        self.0.borrow_mut().bytes.drain(..).collect()
    }
}

impl ErrorType for MemoryLine {
    type Error = Infallible;
}

impl Read for MemoryLine {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        poll_fn(|context| {
            let mut inner = self.0.borrow_mut();
            if inner.bytes.is_empty() {
                inner.reader = Some(context.waker().clone());
                return Poll::Pending;
            }
            let count = buffer.len().min(inner.bytes.len());
            for (place, byte) in buffer.iter_mut().zip(inner.bytes.drain(..count)) {
                *place = byte;
            }
            Poll::Ready(Ok(count))
        })
        .await
    }
}

impl Write for MemoryLine {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.push(bytes);
        Ok(bytes.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

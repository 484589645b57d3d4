//! Lines that deliver in pieces, fail, end or take nothing more.

use core::cell::RefCell;
use core::future::{pending, poll_fn};
use core::task::Poll;
use embedded_io_async::{ErrorKind, ErrorType, Read, Write};
use std::collections::VecDeque;
use std::rc::Rc;

/// What a line does next when it is read.
pub enum Delivery {
    Bytes(Vec<u8>),
    Fault,
    End,
}

/// What is still to come.
pub type Line = RefCell<VecDeque<Delivery>>;

/// A line that delivers piece by piece, then is silent.
pub struct Incoming<'a>(pub &'a Line);

impl ErrorType for Incoming<'_> {
    type Error = ErrorKind;
}

impl Read for Incoming<'_> {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, ErrorKind> {
        let delivery = self.0.borrow_mut().pop_front();
        match delivery {
            Some(Delivery::Bytes(bytes)) => {
                let count = bytes.len().min(buffer.len());
                buffer[..count].copy_from_slice(&bytes[..count]);
                if count < bytes.len() {
                    self.0.borrow_mut().push_front(Delivery::Bytes(bytes[count..].to_vec()));
                }
                Ok(count)
            }
            Some(Delivery::Fault) => Err(ErrorKind::Other),
            Some(Delivery::End) => Ok(0),
            None => pending().await,
        }
    }
}

/// A line that delivers what is put into it while a task waits.
#[derive(Clone, Default)]
pub struct Live(Rc<RefCell<VecDeque<u8>>>);

impl ErrorType for Live {
    type Error = ErrorKind;
}

impl Read for Live {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, ErrorKind> {
        poll_fn(|_| {
            let mut bytes = self.0.borrow_mut();
            let count = bytes.len().min(buffer.len());
            for (place, byte) in buffer.iter_mut().zip(bytes.drain(..count)) {
                *place = byte;
            }
            if count > 0 { Poll::Ready(Ok(count)) } else { Poll::Pending }
        })
        .await
    }
}

impl Live {
    /// Puts bytes into it.
    pub fn say(&self, bytes: &[u8]) {
        self.0.borrow_mut().extend(bytes);
    }
}

/// A line that keeps what is written, at most so many bytes at a time; without any, it never takes a byte.
pub struct Outgoing<'a> {
    pub written: &'a RefCell<Vec<u8>>,
    pub at_once: usize,
}

impl ErrorType for Outgoing<'_> {
    type Error = ErrorKind;
}

impl Write for Outgoing<'_> {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        if self.at_once == 0 {
            pending::<()>().await;
        }
        let count = bytes.len().min(self.at_once);
        self.written.borrow_mut().extend(&bytes[..count]);
        Ok(count)
    }

    async fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

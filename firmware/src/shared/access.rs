//! What a task may do with one of the shared values, by type: to read, to write, to take away.
//!
//! An access is a reference and costs no more. It is narrowed from a reference to the value itself, which no task has.

use super::card::{CardState, CardStatus};
use super::count::Count;
use super::flag::Flag;
use super::latest::Latest;
use super::library::{Answer, Library, Question};
use super::mission::Mission;
use super::queue::{Full, Queue};
use super::requests::{QueuedRequest, Requests};
use super::setpoint_owner::SetpointOwner;
use super::table::offers;
use crate::link::frame::Frame;
use crate::link::mission::Item;
use crate::link::signing::{Refusal, Signing};
use crate::parameters::table::Name;
use crate::parameters::{Parameters, ValueRefusal};
use crate::recorder::Recorder;
use crate::recorder::follow::{Followed, Follower};
use crate::recorder::gyro::{Block, GyroLog};
use crate::recorder::tick::Tick;
use controller_core::governor::GovernorLimits;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;
use flight::{FlightSettings, Stamped};
use mavlink::MAVLinkV2MessageRaw;
use nalgebra::Vector3;

/// An access: a reference, and what it is for.
macro_rules! accesses {
    ($($(#[$doc:meta])* $access:ident;)*) => {
        $($(#[$doc])*
        pub struct $access<'a, T>(&'a T);

        impl<T> Clone for $access<'_, T> {
            fn clone(&self) -> Self {
                *self
            }
        }

        impl<T> Copy for $access<'_, T> {}

        impl<'a, T> From<&'a T> for $access<'a, T> {
            fn from(value: &'a T) -> Self {
                Self(value)
            }
        })*
    };
}

accesses! {
    /// To read a value and leave it as it is. To use a key is to read it; to ask the library is to read in it.
    Read;
    /// To write a value, and to read what may have been written by others.
    Write;
    /// To take away what waits for one reader.
    Take;
}

/// To do whatever the value's own type can: before the tasks begin, and to keep the value in flash.
pub type All<'a, T> = &'a T;

offers! {
    [M: RawMutex, T: Copy] Read<'_, Latest<M, T>> {
        fn get() -> Option<Stamped<T>>;
        fn recent(age_max: u64, now: u64) -> Option<T>;
    }
    [M: RawMutex, T: Copy] Write<'_, Latest<M, T>> { fn put(value: T, time: u64); fn get() -> Option<Stamped<T>>; }
    [M: RawMutex, T: Copy] Take<'_, Latest<M, T>> { fn take() -> Option<Stamped<T>>; }
    [] Read<'_, Flag> { fn is_raised() -> bool; }
    [] Write<'_, Flag> { fn raise(); fn lower(); fn is_raised() -> bool; }
    [] Take<'_, Flag> { fn take() -> bool; }
    [] Read<'_, Count> { fn get() -> u32; }
    [] Read<'_, SetpointOwner> { fn get() -> Option<(u8, u8)>; }
    [] Write<'_, SetpointOwner> { fn set(sender: Option<(u8, u8)>); }
    [M: RawMutex, T, const ROOM: usize] Write<'_, Queue<M, T, ROOM>> { fn put(value: T) -> Result<(), Full>; }
    [M: RawMutex, T, const ROOM: usize] Take<'_, Queue<M, T, ROOM>> { fn take() -> Option<T>; }
    [M: RawMutex] Take<'_, Requests<M>> { fn take() -> Option<QueuedRequest>; }
    [M: RawMutex] Write<'_, Signal<M, ()>> { fn signal(what: ()); }
    [M: RawMutex] Take<'_, Signal<M, ()>> { fn wait() -> impl Future<Output = ()>; }
    [M: RawMutex] Read<'_, Parameters<M>> {
        fn get(name: Name) -> f32;
        fn flight_settings() -> FlightSettings;
        fn governor_limits() -> GovernorLimits;
        fn lost() -> Option<&'static str>;
    }
    [M: RawMutex] Write<'_, Parameters<M>> {
        fn set(name: Name, value: f32) -> Result<(), ValueRefusal>;
        fn get(name: Name) -> f32;
    }
    [M: RawMutex] Read<'_, Mission<M>> { fn item(number: u16) -> Option<Item>; }
    [M: RawMutex] Write<'_, Mission<M>> {
        fn replace(by: &[Item]);
        fn item(number: u16) -> Option<Item>;
        fn count() -> u16;
    }
    [M: RawMutex] Read<'_, Signing<M>> {
        fn keeps_out_unsigned(must_be_signed: bool) -> bool;
        fn judge(frame: &Frame<'_>, must_be_signed: bool) -> Result<(), Refusal>;
        fn sign(frame: &mut MAVLinkV2MessageRaw, now: u64);
        fn is_lost() -> bool;
    }
    [M: RawMutex] Read<'_, Recorder<M>> {
        fn size() -> Option<u32>;
        fn read(offset: u32, out: &mut [u8]) -> usize;
        fn vehicle() -> &'static str;
        fn spacing() -> u64;
        fn follower() -> Follower;
        fn follow(follower: &mut Follower) -> Followed;
        fn answer(question: Question) -> Answer;
    }
    [M: RawMutex] Write<'_, Recorder<M>> {
        fn ticks_last(period: u64, spacing: u64);
        fn record(armed: bool, tick: impl FnOnce() -> Tick);
    }
    [M: RawMutex] Take<'_, Recorder<M>> { fn erase(); }
    [M: RawMutex] Read<'_, GyroLog<M>> { fn is_attached() -> bool; }
    [M: RawMutex] Write<'_, GyroLog<M>> { fn put(time: u64, rate: &Vector3<f32>); }
    [M: RawMutex] Take<'_, GyroLog<M>> { fn take() -> Option<Block>; }
    [] Read<'_, CardStatus> {
        fn state() -> CardState;
        fn is_silent(now: u64) -> bool;
        fn health(now: u64) -> Option<bool>;
    }
    [] Write<'_, CardStatus> { fn set(state: CardState, now: u64); }
    [M: RawMutex] Read<'_, Library<M>> {
        fn put_question(question: Question, now: u64);
        fn fetch(question: Question) -> Option<Answer>;
    }
    [M: RawMutex] Write<'_, Library<M>> {
        fn take_question() -> Option<Question>;
        fn answer(question: Question, answer: Answer);
    }
}

//! Parameters in: read, listed, set.

use super::Receiver;
use crate::link::frame::Frame;
use crate::parameters::table::Name;
use crate::shared::{Event, Reply, Severity};
use core::fmt::Display;
use embassy_sync::blocking_mutex::raw::RawMutex;
use mavlink::dialects::common::{MavParamType, PARAM_REQUEST_LIST_DATA, PARAM_REQUEST_READ_DATA, PARAM_SET_DATA};

impl<M: RawMutex> Receiver<'_, M> {
    pub(super) fn list_parameters(&mut self, _: &Frame<'_>, _: &PARAM_REQUEST_LIST_DATA) {
        self.shared.reply(Reply::AllParameters);
    }

    pub(super) fn read_parameter(&mut self, frame: &Frame<'_>, message: &PARAM_REQUEST_READ_DATA) {
        // A negative index: by name.
        match usize::try_from(message.param_index) {
            Ok(index) => self.reply_with_parameter(Name::from_index(index), frame.time, index),
            Err(_) => {
                let name = message.param_id.to_str().unwrap_or("");
                self.reply_with_parameter(Name::from_name(name), frame.time, name);
            }
        }
    }

    pub(super) fn set_parameter(&mut self, frame: &Frame<'_>, message: &PARAM_SET_DATA) {
        let text = message.param_id.to_str().unwrap_or("");
        let name = Name::from_name(text);
        if let Some(name) = name {
            self.set(name, message.param_value, message.param_type);
        }
        self.reply_with_parameter(name, frame.time, text);
    }

    /// Its value, as it is now, answers every question about a parameter. Of one that is not there nothing can be sent:
    /// the sender gets at `now`, us.
    pub(super) fn reply_with_parameter(&mut self, name: Option<Name>, now: u64, asked: impl Display) {
        match name {
            Some(name) => self.shared.reply(Reply::Parameter(name)),
            None => {
                self.refused();
                self.parameter_refused.warn(self.shared, now, format_args!("No parameter {asked}"));
            }
        }
    }

    fn set(&self, name: Name, value: f32, kind: MavParamType) {
        if kind == MavParamType::MAV_PARAM_TYPE_REAL32 {
            return self.shared.set_parameter(name, value);
        }
        let words = format_args!("{}: is a REAL32", name.row().name);
        self.shared.announce(Event::new(Severity::Warning, words));
    }
}

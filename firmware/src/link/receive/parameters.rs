//! Parameters in: read, listed, set while disarmed.

use super::Receiver;
use crate::link::frame::Frame;
use crate::parameters::table::Name;
use crate::shared::{Event, Reply, Severity};
use core::fmt::Display;
use embassy_sync::blocking_mutex::raw::RawMutex;
use mavlink::dialects::common::{MavParamType, PARAM_REQUEST_LIST_DATA, PARAM_REQUEST_READ_DATA, PARAM_SET_DATA};

impl<M: RawMutex> Receiver<'_, M> {
    pub(super) fn list_parameters(&mut self, _: &Frame<'_>, message: &PARAM_REQUEST_LIST_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            self.shared.reply(Reply::AllParameters);
        }
    }

    pub(super) fn read_parameter(&mut self, _: &Frame<'_>, message: &PARAM_REQUEST_READ_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            // A negative index: by name.
            let name = match usize::try_from(message.param_index) {
                Ok(index) => Name::from_index(index),
                Err(_) => message.param_id.to_str().ok().and_then(Name::from_name),
            };
            self.reply_with_parameter(name);
        }
    }

    pub(super) fn set_parameter(&mut self, _: &Frame<'_>, message: &PARAM_SET_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            let name = message.param_id.to_str().ok().and_then(Name::from_name);
            if let Some(name) = name {
                self.set(name, message.param_value, message.param_type);
            }
            self.reply_with_parameter(name);
        }
    }

    /// Its value, as it is now, answers every question about a parameter.
    pub(super) fn reply_with_parameter(&mut self, name: Option<Name>) {
        match name {
            Some(name) => self.shared.reply(Reply::Parameter(name)),
            None => self.refused(),
        }
    }

    pub(super) fn set(&mut self, name: Name, value: f32, kind: MavParamType) {
        let shared = self.shared;
        let warn = |words: &dyn Display| shared.announce(Event::new(Severity::Warning, words));
        if shared.is_armed() {
            warn(&"Parameters change only while disarmed");
        } else if kind != MavParamType::MAV_PARAM_TYPE_REAL32 {
            warn(&format_args!("{}: is a REAL32", name.row().name));
        } else if let Err(error) = shared.parameters.set(name, value) {
            warn(&error);
        }
    }
}

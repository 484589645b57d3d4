//! Places and files in: an origin is kept, files are refused.

use super::Receiver;
use crate::link::files::FileRequest;
use crate::link::frame::Frame;
use crate::link::origin::Origin;
use crate::link::telemetry::kind::Kind;
use crate::shared::Reply;
use embassy_sync::blocking_mutex::raw::RawMutex;
use mavlink::dialects::common::SET_GPS_GLOBAL_ORIGIN_DATA;

impl<M: RawMutex> Receiver<'_, M> {
    pub(super) fn set_origin(&mut self, frame: &Frame<'_>, message: &SET_GPS_GLOBAL_ORIGIN_DATA) {
        let SET_GPS_GLOBAL_ORIGIN_DATA { latitude, longitude, altitude, .. } = *message;
        match Origin::new(latitude, longitude, altitude) {
            Some(origin) => {
                self.shared.origin().put(origin, frame.time);
                self.shared.reply(Reply::Message(Kind::GlobalOrigin));
            }
            None => self.refused(),
        }
    }

    /// There are no files.
    pub(super) fn file(&mut self, frame: &Frame<'_>) {
        if let Some((request, _)) = FileRequest::read(frame).filter(|(_, target)| self.is_target((*target).into())) {
            self.shared.reply(Reply::NoFiles(request));
        }
    }
}

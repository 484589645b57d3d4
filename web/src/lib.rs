//! What the page in `web/page` computes: certificates and flights of a vehicle's file, in the browser.
//!
//! A page has no server. It loads this crate as WebAssembly, writes a request into it as JSON, calls it, and reads the
//! answer. `web/page/api.ts` has the same types in TypeScript.
//!
//! | module | request | answer |
//! |---|---|---|
//! | [`presets`] | `{"do": "presets"}` | vehicles to begin with |
//! | [`imported`] | `{"do": "import", "file", "text"}` | a vehicle file of ours, from another program's |
//! | [`certified`] | `{"do": "certify", "file", "text"}` | the verdict and its rows |
//! | [`flights`], [`tasks`] | `{"do": "fly", "file", "text", "request"}` | flights, tick by tick |
//! | [`paper`] | `{"do": "paper"}` | the paper's flight as one number |
//!
//! An answer is `{"ok": …}` or `{"error": "file: field: reason"}`.

pub mod certified;
pub mod exchange;
pub mod flights;
pub mod imported;
pub mod indi;
pub mod paper;
pub mod presets;
pub mod tasks;
pub mod vehicle_file;

use serde::{Deserialize, Serialize};
use vehicle_file::VehicleFile;

#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "lowercase")]
enum Request {
    Presets,
    Import(VehicleFile),
    Certify(VehicleFile),
    Fly {
        #[serde(flatten)]
        vehicle: VehicleFile,
        request: tasks::FlightRequest,
    },
    Paper,
}

#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum Answer<T> {
    Ok(T),
    Error(String),
}

/// The answer to a request, both as JSON.
pub fn answer(request: &str) -> String {
    match serde_json::from_str(request) {
        Err(error) => written(Err::<(), _>(format!("request: {error}"))),
        Ok(Request::Presets) => written(Ok(presets::all())),
        Ok(Request::Import(vehicle)) => written(imported::import(&vehicle)),
        Ok(Request::Certify(vehicle)) => written(certified::certify(&vehicle)),
        Ok(Request::Fly { vehicle, request }) => written(flights::fly(&vehicle, &request)),
        Ok(Request::Paper) => written(paper::number()),
    }
}

fn written<T: Serialize>(result: Result<T, String>) -> String {
    let answer = match result {
        Ok(answer) => Answer::Ok(answer),
        Err(error) => Answer::Error(error.replace('\n', " ")),
    };
    serde_json::to_string(&answer).unwrap_or_else(|error| format!("{{\"error\":\"the answer: {error}\"}}"))
}

#[cfg(test)]
mod tests;

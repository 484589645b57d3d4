//! What there is to say of a scenario's vehicle and reference, whether it flies or not.

use crate::excess::Excess;
use crate::file::Scenario;
use crate::path::Swing;
use crate::reference::ReferenceKind;
use crate::trajectory::{Route, RouteWay};

/// Of the vehicle of a scenario: which of its numbers are unusual, and whether its motors may stall. Of the reference:
/// where it swings out, how near it is to the rows of a file, and where it is too fast.
#[must_use]
pub fn remarks(scenario: &Scenario, is_certified: bool) -> Vec<String> {
    let route = match &scenario.reference {
        ReferenceKind::Route(route) => Some(route),
        _ => None,
    };
    let summary = route.and_then(summary);
    let source = route.into_iter().flat_map(|route| route.remarks.clone());
    let swing = Swing::find(&scenario.reference, &*scenario.trajectory).map(|swing| swing.to_string());
    let excess = if is_certified { None } else { Excess::find(scenario) };
    let reference = summary.into_iter().chain(source).chain(swing).chain(excess.map(|excess| excess.to_string()));
    let vehicle = scenario.unusual.iter().map(|unusual| format!("vehicle, unusual: {unusual}"));
    let idle = scenario.least_command.and_then(|least| least.doubt()).map(|doubt| format!("vehicle, motors: {doubt}"));
    vehicle.chain(idle).chain(reference.map(|remark| format!("reference: {remark}"))).collect()
}

fn summary(route: &Route) -> Option<String> {
    let (points, duration) = (route.points.len(), route.duration());
    match route.way {
        RouteWay::Near { farthest: (distance, time), lead_in } => Some(format!(
            "{points} rows, each within {:.1} mm (most at {time:.2} s); the first is passed {lead_in:.2} s after the \
             start, the end is at {duration:.2} s",
            1e3 * distance
        )),
        RouteWay::Paced { corridor } => {
            Some(format!("{points} points in {duration:.2} s, at most {corridor} m beside the straight legs"))
        }
        RouteWay::Smooth | RouteWay::Inside => None,
    }
}

use super::*;
use crate::flight::Flight;
use scenario::Scenario;

/// A column of the ticks' numbers, which a test can know: the time, s.
fn time(kept: Kept) -> (String, Kept, Read) {
    ("t".to_owned(), kept, Box::new(|instant: &Instant| instant.tick.time_us as f64 / 1e6))
}

/// A column that is zero but for one tick.
fn peak(at_us: u64) -> (String, Kept, Read) {
    let read = move |instant: &Instant| if instant.tick.time_us == at_us { 7.0 } else { 0.0 };
    ("peak".to_owned(), Kept::Extremes, Box::new(read))
}

/// The record of so many ticks of 10 ms.
fn recorded(ticks: u64, columns: Vec<(String, Kept, Read)>) -> Track {
    let mut tick = Flight::new(&Scenario::paper().unwrap()).unwrap().tick().unwrap();
    let mut recorder = ReportRecorder::new(ticks, 0.01, columns);
    for number in 0..ticks {
        tick.time_us = number * 10_000;
        recorder.observe(&tick);
    }
    recorder.finish("test")
}

#[test]
fn every_tick_of_a_short_flight_is_a_row() {
    let track = recorded(ROWS_MAX, vec![time(Kept::Samples), peak(120_000)]);
    let (times, peaks) = (track.column("t").unwrap(), track.column("peak").unwrap());
    assert_eq!((times.len() as u64, track.step), (ROWS_MAX, 0.01));
    assert!(times.iter().enumerate().all(|(row, time)| *time == (row as f64 * 0.01) as f32));
    assert_eq!(peaks.iter().position(|value| *value == 7.0), Some(12));
}

#[test]
fn a_long_flight_keeps_every_peak_and_stays_bounded() {
    for ticks in [ROWS_MAX + 1, 12_345, 360_001] {
        for at in [0, 1, ticks / 3, ticks - 2, ticks - 1] {
            let track = recorded(ticks, vec![time(Kept::Samples), time(Kept::Extremes), peak(at * 10_000)]);
            let rows = track.columns[0].1.len();
            assert!(rows as u64 <= ROWS_MAX + 2, "{ticks}: {rows} rows");
            assert!(track.columns.iter().all(|(_, values)| values.len() == rows));
            let peaks = &track.columns[2].1;
            assert!(peaks.contains(&7.0), "{ticks}: the peak at {at} is lost");
            // Rows stand where they say: samples exactly, extremes within their stretch.
            for (row, sample) in track.columns[0].1.iter().enumerate().take(rows - 1) {
                let time = row as f64 * track.step;
                assert!(
                    (f64::from(*sample) - time).abs() < 0.01 + 1e-6 * time,
                    "{ticks}: row {row}: {sample}, not {time}"
                );
            }
            let end = track.columns[1].1[rows - 1];
            assert!((f64::from(end) - (ticks - 1) as f64 * 0.01).abs() < 1e-3, "{ticks}: ends at {end}");
        }
    }
}

#[test]
fn yaw_has_no_jumps_of_a_turn_and_ends_beside_the_desired_one() {
    let scenario = Scenario::paper().unwrap();
    let mut flight = Flight::new(&scenario).unwrap();
    let yaw: (String, Kept, Read) = ("yaw".to_owned(), Kept::Samples, Box::new(|instant: &Instant| instant.yaw));
    let asked: (String, Kept, Read) =
        ("yaw_d".to_owned(), Kept::Samples, Box::new(|instant: &Instant| instant.desired_yaw));
    let mut recorder = ReportRecorder::new(scenario.timing.ticks, 0.01, vec![yaw, asked]);
    for _ in 0..scenario.timing.ticks {
        recorder.observe(&flight.tick().unwrap());
    }
    let track = recorder.finish("paper");
    let (yaw, asked) = (track.column("yaw").unwrap(), track.column("yaw_d").unwrap());
    assert_eq!(yaw.len(), 4000);
    assert!(asked.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 5.0));
    assert!(yaw.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 180.0));
    assert!((yaw[3999] - asked[3999]).abs() < 0.1);
}

use super::*;
use crate::flight::Flight;
use crate::reports::report::flight::recorder;
use scenario::Scenario;

/// The paper's flight from upside down.
fn track() -> Track {
    let scenario = Scenario::paper().unwrap();
    let (mut flight, mut recorder) = (Flight::new(&scenario).unwrap(), recorder(&scenario));
    for _ in 0..300 {
        recorder.observe(&flight.tick().unwrap());
    }
    recorder.finish("paper")
}

/// The pictures of a GIF, each put on the ones before it.
fn decoded(bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut decoder = gif::DecodeOptions::new().read_info(bytes).unwrap();
    let size = (usize::from(decoder.width()), usize::from(decoder.height()));
    assert_eq!(size, (SIZE_PIXELS.0 as usize, SIZE_PIXELS.1 as usize));
    let (mut whole, mut pictures) = (vec![UNCHANGED_ENTRY; size.0 * size.1], Vec::new());
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        for (row, line) in frame.buffer.chunks(usize::from(frame.width)).enumerate() {
            let start = (usize::from(frame.top) + row) * size.0 + usize::from(frame.left);
            for (pixel, place) in whole[start..].iter_mut().zip(line) {
                *pixel = if *place == UNCHANGED_ENTRY { *pixel } else { *place };
            }
        }
        pictures.push(whole.clone());
    }
    pictures
}

#[test]
fn the_gif_decodes_to_the_pictures_that_were_drawn() {
    let track = track();
    let gate = [vec![Vector3::new(-1.0, 0.0, 1.0), Vector3::new(9.0, 0.0, 1.0)]];
    let bytes = gif(&track, &gate, Stretch { from: 0.0, to: 2.0, speed: 1.0 }).unwrap();
    let pictures = decoded(&bytes);
    assert_eq!(pictures.len(), 41);
    assert!(pictures.windows(2).all(|pair| pair[0] != pair[1]), "the vehicle stands still");
    let poses = poses(&track);
    let shown = &poses[..=200];
    let last = Table::new().places(&picture(&view(shown, &gate), &gate, shown, 200, 1.0));
    assert_eq!(pictures.last(), Some(&last));
    assert!(!last.contains(&UNCHANGED_ENTRY), "a colour of the table stands for what has not changed");
    assert_ne!(last, Table::new().places(&picture(&view(shown, &gate), &[], shown, 200, 1.0)), "the gate is not there");
    // The vehicle and both paths are there, in their own colours.
    for place in [0, 1, 3] {
        assert!(last.contains(&((1 + place) * COLOR_STEPS as u8)), "{:?} is nowhere", DRAWN_COLORS[place as usize]);
    }
}

#[test]
fn a_moment_or_an_empty_track_is_one_still_picture() {
    for (track, from, to) in [(track(), 1.0, 1.0), (track(), 90.0, 91.0), (Track::default(), 0.0, 0.01)] {
        let pictures = decoded(&gif(&track, &[], Stretch { from, to, speed: 100.0 }).unwrap());
        assert_eq!(pictures.len(), 2);
    }
}

#[test]
fn the_front_pages_moving_picture_is_small_and_moves() {
    let bytes: &[u8] = include_bytes!("../../../../../docs/images/recovery.gif");
    assert!(bytes.len() < 1_500_000, "{} bytes", bytes.len());
    assert_eq!(decoded(bytes).len(), 161);
}

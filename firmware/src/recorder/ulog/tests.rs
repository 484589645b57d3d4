use super::*;
use crate::recorder::ring::SLOT_BYTES;

/// A ring of ten records, each of its own byte.
fn filled(memory: &mut Vec<[u8; SLOT_BYTES]>) -> Ring<'_> {
    memory.resize(10, [0; SLOT_BYTES]);
    let mut ring = Ring::recover(memory);
    ring.begin();
    (1..=10).for_each(|number| ring.put(&[number; tick::TICK_BYTES]));
    ring
}

/// The whole file, in pieces of so many bytes.
fn file(ring: &Ring, piece: usize) -> Vec<u8> {
    let mut file = vec![];
    let mut buffer = vec![0; piece];
    loop {
        let count = read(ring, "mine", file.len(), &mut buffer);
        file.extend(&buffer[..count]);
        if count < piece {
            return file;
        }
    }
}

#[test]
fn a_file_is_the_same_in_pieces_of_any_size() {
    let mut memory = vec![];
    let ring = filled(&mut memory);
    let whole = file(&ring, 100_000);
    assert_eq!(whole.len(), size(10) as usize);
    for piece in [1, 7, 90, 128, 1_024] {
        assert_eq!(file(&ring, piece), whole, "{piece}");
    }
    for beyond in [whole.len(), whole.len() + 1, usize::MAX] {
        assert_eq!(read(&ring, "mine", beyond, &mut [0; 90]), 0);
    }
}

#[test]
fn every_message_is_as_long_as_it_says_and_of_a_kind_in_its_place() {
    let mut memory = vec![];
    let ring = filled(&mut memory);
    let file = file(&ring, 4_096);
    assert_eq!((&file[..8], &file[8..16]), (&FILE_MAGIC[..], &[1; 8][..]));
    let (mut at, mut kinds) = (16, String::new());
    while at < file.len() {
        let length = usize::from(u16::from_le_bytes([file[at], file[at + 1]]));
        let body = &file[at + 3..at + 3 + length];
        kinds.push(char::from(file[at + 2]));
        match file[at + 2] {
            b'B' => assert_eq!(body, [0; 40]),
            b'F' => assert_eq!(body, tick::FORMAT.as_bytes()),
            b'A' => assert_eq!(body, b"\0\0\0tick"),
            b'D' => assert!(body[2..].iter().all(|byte| *byte == body[2]) && body.len() == 2 + tick::TICK_BYTES),
            _ => {}
        }
        at += 3 + length;
    }
    assert_eq!((at, kinds.as_str()), (file.len(), "BIIIIIFADDDDDDDDDD"));
}

#[test]
fn whatever_a_vehicle_is_called_its_file_is_as_long() {
    for (name, written) in [("", ""), ("mine", "mine"), (&"long".repeat(20)[..], &"long".repeat(8)[..])] {
        let bytes: Vec<u8> = definitions(&[0; TIME_BYTES], name).flatten().copied().collect();
        assert_eq!(bytes.len(), definitions_size());
        assert!(String::from_utf8_lossy(&bytes).contains(&format!("char[32] vehicle{written:32}")), "{name}");
    }
}

#[test]
fn a_text_is_as_long_as_its_key_says_and_names_every_mode() {
    for Information { key, text, .. } in &INFORMATION {
        let length = key.strip_prefix("char[").and_then(|key| key.split_once(']')).unwrap().0;
        assert_eq!(length.parse(), Ok(text.len()), "{key}");
    }
    let modes = flight::Mode::ALL.map(|mode| format!("{} {}", mode as u8, mode));
    assert_eq!(INFORMATION[3].text, modes.join(", "));
}

use super::*;

/// Kinds and lengths of the messages in these bytes; the last must end where they do.
fn messages(bytes: &[u8]) -> Vec<(char, usize)> {
    let (mut at, mut found) = (0, vec![]);
    while at < bytes.len() {
        let length = usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
        found.push((char::from(bytes[at + 2]), length));
        at += MESSAGE_HEAD_BYTES + length;
    }
    assert_eq!(at, bytes.len());
    found
}

#[test]
fn sectors_are_whole_messages_however_full_they_are() {
    assert_eq!(messages(&BLANK_SECTOR), [('Z', SECTOR_BYTES - MESSAGE_HEAD_BYTES)]);
    assert_eq!(Content::from_bytes(&BLANK_SECTOR), Content::Blank);
    for length in [1, 100, SECTOR_CAPACITY_BYTES - MESSAGE_HEAD_BYTES] {
        let mut sector = Sector::new();
        assert!(sector.put(&[&ulog::head(b'D', length), &vec![7; length]]));
        assert!(!sector.is_empty());
        let bytes = sector.finish();
        assert_eq!(messages(&bytes), [('D', length), ('Z', SECTOR_BYTES - length - 2 * MESSAGE_HEAD_BYTES)]);
        assert_eq!(Content::from_bytes(&bytes), Content::Whole);
        assert!(sector.is_empty());
    }
    let mut sector = Sector::new();
    assert!(!sector.put(&[&[0; SECTOR_CAPACITY_BYTES], &[0]]) && sector.is_empty());
}

#[test]
fn a_torn_sector_is_found_wherever_it_tore() {
    let mut sector = Sector::new();
    assert!(sector.put(&[&ulog::head(b'D', 300), &(0..300).map(|byte| byte as u8).collect::<Vec<_>>()]));
    let whole = sector.finish();
    for at in 1..SECTOR_BYTES {
        for (front, back) in [(&whole, &BLANK_SECTOR), (&BLANK_SECTOR, &whole)] {
            let mut torn = *back;
            torn[..at].copy_from_slice(&front[..at]);
            let expected = match () {
                () if torn == whole => Content::Whole,
                () if torn == BLANK_SECTOR => Content::Blank,
                () => Content::Torn,
            };
            assert_eq!(Content::from_bytes(&torn), expected, "{at}");
        }
    }
    assert_eq!(Content::from_bytes(&[0; SECTOR_BYTES]), Content::Torn);
}

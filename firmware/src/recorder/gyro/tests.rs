use super::*;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;

fn log(blocks: usize) -> GyroLog<NoopRawMutex> {
    let log = GyroLog::new();
    log.attach(Box::leak(vec![[0; BLOCK_BYTES]; blocks].into_boxed_slice()));
    log
}

/// The number of sample `n` on each axis, counts.
fn counts(n: u64) -> [i16; 3] {
    [n as i16, -(n as i16), 20_000 - n as i16]
}

fn put(log: &GyroLog<NoopRawMutex>, n: u64, time: u64) {
    log.put(time, &Vector3::from(counts(n)).map(|count| f32::from(count) * RATE_PER_COUNT));
}

/// Time, time between samples, samples on three axes.
fn read(block: &Block) -> (u64, f32, Vec<[i16; 3]>) {
    let samples = usize::from(block[BLOCK_BYTES - 1]);
    assert_eq!((block[..8].to_vec(), &block[16..20]), (block[8..16].to_vec(), &[1, 0, 0, 0][..]));
    assert_eq!(f32::from_le_bytes(block[24..28].try_into().unwrap()), RATE_PER_COUNT);
    let number = |axis: usize, sample: usize| {
        let at = BLOCK_HEAD_BYTES + axis * AXIS_BYTES + 2 * sample;
        i16::from_le_bytes([block[at], block[at + 1]])
    };
    let all = (0..BLOCK_SAMPLES).map(|sample| [0, 1, 2].map(|axis| number(axis, sample))).collect::<Vec<_>>();
    assert!(all[samples..].iter().all(|sample| *sample == [0; 3]));
    let time = u64::from_le_bytes(block[..8].try_into().unwrap());
    (time, f32::from_le_bytes(block[20..24].try_into().unwrap()), all[..samples].to_vec())
}

#[test]
fn every_sample_comes_out_in_blocks_with_its_time() {
    let log = log(4);
    for n in 0..96 {
        put(&log, n, 5_000 + n * 1_000);
        if n % 32 == 31 {
            let (time, between, samples) = read(&log.take().unwrap());
            assert_eq!((time, between), (5_000 + n * 1_000, 1_000.0));
            assert_eq!(samples, (n - 31..=n).map(counts).collect::<Vec<_>>());
        }
        assert_eq!(log.take(), None, "{n}");
    }
}

#[test]
fn a_block_ends_where_samples_are_missing() {
    let log = log(4);
    (0..5).for_each(|n| put(&log, n, n * 625));
    put(&log, 5, 4 * 625 + SAMPLE_GAP_MAX_US + 1);
    let (time, between, samples) = read(&log.take().unwrap());
    assert_eq!((time, between, samples.len()), (2_500, 625.0, 5));
    assert_eq!(log.take(), None);
}

#[test]
fn the_oldest_makes_room_and_the_rest_is_whole() {
    let log = log(3);
    (0..32 * 5).for_each(|n| put(&log, n, n * 1_000));
    let times: Vec<u64> = std::iter::from_fn(|| log.take()).map(|block| read(&block).0).collect();
    assert_eq!(times, [127_000, 159_000]);
    (160..192).for_each(|n| put(&log, n, n * 1_000));
    assert_eq!(read(&log.take().unwrap()).2, (160..192).map(counts).collect::<Vec<_>>());
}

#[test]
fn what_is_beyond_a_count_is_cut_and_without_memory_nothing_is_kept() {
    let log = log(2);
    (0..32).for_each(|n| log.put(n * 1_000, &Vector3::new(1e9, -1e9, f32::NAN)));
    assert_eq!(read(&log.take().unwrap()).2[0], [i16::MAX, i16::MIN, 0]);
    let none = GyroLog::<NoopRawMutex>::new();
    none.put(0, &Vector3::zeros());
    assert!(!none.is_attached() && none.take().is_none());
}

#[test]
fn the_format_is_as_long_as_a_block() {
    let fields = FORMAT.split_once(':').unwrap().1;
    let bytes = |field: &str| match field.split_once(' ').unwrap().0 {
        "uint64_t" => 8,
        "uint32_t" | "float" => 4,
        "int16_t[32]" => 64,
        "uint8_t" => 1,
        other => panic!("{other}"),
    };
    assert_eq!(fields.split_terminator(';').map(bytes).sum::<usize>(), BLOCK_BYTES);
}

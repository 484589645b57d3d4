//! Times divided: microseconds are counted in 64 bits, and dividing those takes a kilobyte of flash. Here it is done in two
//! steps of 32 bits, for times up to 2^48 us, which are nine years.

/// Whole milliseconds, as far as 32 bits count them.
#[must_use]
pub fn milliseconds(time: u64) -> u32 {
    let (high, low) = halves(time);
    ((high / 1000) << 16) + (((high % 1000) << 16) + low) / 1000
}

/// How much of a time (us) is left over from whole steps of so many microseconds.
#[must_use]
pub fn beyond(time: u64, step: u16) -> u64 {
    let (high, low) = halves(time);
    let step = u32::from(step);
    ((((high % step) << 16) + low) % step).into()
}

/// All but the last 16 bits, and those.
fn halves(time: u64) -> (u32, u32) {
    ((time >> 16) as u32, time as u32 & 0xFFFF)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_those_of_a_division() {
        let year = 365 * 24 * 3_600_000_000_u64;
        for time in
            [0, 999, 1000, 65_535_999, 65_536_000, u64::from(u32::MAX), year, 8 * year + 123_456_789, (1 << 48) - 1]
        {
            assert_eq!(milliseconds(time), (time / 1000) as u32, "{time}");
            for step in [1, 1000, 50_000, u16::MAX] {
                assert_eq!(beyond(time, step), time % u64::from(step), "{time} {step}");
            }
        }
    }
}

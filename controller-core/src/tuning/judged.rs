//! Which factors on the gains have sampled loops that are stable, with margin: judged beforehand, for every choice
//! there is.
//!
//! Judging a loop takes an analysis that no board does (`docs/sampled-loop.md`). So the build of a configuration does
//! it for each choice of [`Factors`], and what is kept is one bit a choice. The loops about the horizontal axes, and
//! about yaw, depend on four factors, the loop along the vertical on two; under the paper's law, which has no gains of
//! its own for the vertical, on the four.

use super::{Factors, Percent};

/// Choices of four factors, and of two.
const CHOICES_ACROSS: usize = Percent::COUNT.pow(4);
const CHOICES_VERTICAL: usize = Percent::COUNT.pow(2);

/// Bytes of the bits for each.
pub const CHOICES_ACROSS_BYTES: usize = CHOICES_ACROSS.div_ceil(8);
/// See [`CHOICES_ACROSS_BYTES`].
pub const CHOICES_VERTICAL_BYTES: usize = CHOICES_VERTICAL.div_ceil(8);

/// One bit for each choice of factors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JudgedLoops {
    across: [u8; CHOICES_ACROSS_BYTES],
    vertical: [u8; CHOICES_VERTICAL_BYTES],
}

impl JudgedLoops {
    /// Only the gains as built.
    pub const BUILT: Self = {
        let (mut across, mut vertical) = ([0; CHOICES_ACROSS_BYTES], [0; CHOICES_VERTICAL_BYTES]);
        // The middle of an odd number of choices.
        across[CHOICES_ACROSS / 2 / 8] = 1 << (CHOICES_ACROSS / 2 % 8);
        vertical[CHOICES_VERTICAL / 2 / 8] = 1 << (CHOICES_VERTICAL / 2 % 8);
        Self { across, vertical }
    };

    /// An earlier judgement, as [`Self::bits`] gave it.
    pub const fn from_bits(across: [u8; CHOICES_ACROSS_BYTES], vertical: [u8; CHOICES_VERTICAL_BYTES]) -> Self {
        Self { across, vertical }
    }

    /// To be kept: the bits of the choices of four factors, and of two.
    pub fn bits(&self) -> (&[u8; CHOICES_ACROSS_BYTES], &[u8; CHOICES_VERTICAL_BYTES]) {
        (&self.across, &self.vertical)
    }

    /// Calls `across` for every choice of the first four factors, and `vertical` for every choice of the other two; the
    /// factors that are not varied are as built.
    pub fn judge(mut across: impl FnMut(&Factors) -> bool, mut vertical: impl FnMut(&Factors) -> bool) -> Self {
        let mut judged = Self { across: [0; _], vertical: [0; _] };
        for attitude in Percent::all() {
            for rate in Percent::all() {
                for position_across in Percent::all() {
                    for velocity_across in Percent::all() {
                        let factors = Factors { attitude, rate, position_across, velocity_across, ..Factors::BUILT };
                        set(&mut judged.across, index_across(&factors), across(&factors));
                    }
                }
            }
        }
        for position_vertical in Percent::all() {
            for velocity_vertical in Percent::all() {
                let factors = Factors { position_vertical, velocity_vertical, ..Factors::BUILT };
                set(&mut judged.vertical, index_vertical(&factors), vertical(&factors));
            }
        }
        judged
    }

    /// Whether every loop was found stable, with margin, under these factors.
    pub fn hold(&self, factors: &Factors) -> bool {
        get(&self.across, index_across(factors)) && get(&self.vertical, index_vertical(factors))
    }
}

fn index_across(factors: &Factors) -> usize {
    let Factors { attitude, rate, position_across, velocity_across, .. } = factors;
    [attitude, rate, position_across, velocity_across]
        .iter()
        .fold(0, |index, factor| index * Percent::COUNT + factor.index())
}

fn index_vertical(factors: &Factors) -> usize {
    factors.position_vertical.index() * Percent::COUNT + factors.velocity_vertical.index()
}

fn set(bits: &mut [u8], index: usize, value: bool) {
    if let Some(byte) = bits.get_mut(index / 8) {
        *byte |= u8::from(value) << (index % 8);
    }
}

fn get(bits: &[u8], index: usize) -> bool {
    bits.get(index / 8).is_some_and(|byte| byte >> (index % 8) & 1 == 1)
}

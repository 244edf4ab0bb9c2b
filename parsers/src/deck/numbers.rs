//! Decimal numbers to `f64`, correctly rounded, eight digits at a time.
//!
//! A decimal with at most 2^53 as its digits and a power of ten up to 22 is one exact integer
//! multiplied or divided by another, so the one rounding of that operation is the correct one
//! (Clinger 1990). All other numbers go through the standard library.

use std::ops::Neg;

/// Powers of ten that `f64` holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];
const INTEGER_POWERS: [u64; 9] = [
    1,
    10,
    100,
    1_000,
    10_000,
    100_000,
    1_000_000,
    10_000_000,
    100_000_000,
];
const EXACT: u64 = 1 << 53;

/// The number at the start of `text` and its length, where the fast path can read it and a blank follows.
///
/// `None` says nothing about the token: hand it to [`number`].
#[inline]
pub(super) fn leading_number(text: &[u8]) -> Option<(f64, usize)> {
    let negative = text.first() == Some(&b'-');
    let start = usize::from(negative);
    let (whole, whole_digits) = eight_digits(text, start);
    let mut at = start + whole_digits;
    let (mut digits, mut fraction_digits) = (whole, 0);
    if text.get(at) == Some(&b'.') {
        let (fraction, count) = eight_digits(text, at + 1);
        digits = whole * INTEGER_POWERS.get(count)? + fraction;
        fraction_digits = count;
        at += 1 + count;
    }
    let ended = text.get(at).is_none_or(|&byte| byte <= b' ');
    if !ended || whole_digits + fraction_digits == 0 || digits > EXACT {
        return None;
    }
    #[allow(clippy::cast_precision_loss, reason = "digits are at most 2^53")]
    let magnitude = digits as f64 / POWERS.get(fraction_digits)?;
    Some((if negative { magnitude.neg() } else { magnitude }, at))
}

/// Value and count of the digits at `at`, eight at most.
#[inline]
fn eight_digits(text: &[u8], at: usize) -> (u64, usize) {
    let word = eight_bytes(text, at);
    // Digits become 0..=9; any other byte sets its high bit in `others`.
    let values = word ^ 0x3030_3030_3030_3030;
    let others = (((values & 0x7f7f_7f7f_7f7f_7f7f) + 0x7676_7676_7676_7676) | values)
        & 0x8080_8080_8080_8080;
    let count = (others.trailing_zeros() / 8) as usize;
    if count == 0 {
        return (0, 0);
    }
    // Leading zeros take the place of what follows the digits.
    let values = values << (64 - 8 * count);
    (joined(values), count)
}

/// The decimal number of eight digit values, most significant in the lowest byte.
#[inline]
fn joined(values: u64) -> u64 {
    let pairs = values.wrapping_mul(10).wrapping_add(values >> 8) & 0x00ff_00ff_00ff_00ff;
    let fours = pairs.wrapping_mul(100).wrapping_add(pairs >> 16) & 0x0000_ffff_0000_ffff;
    fours.wrapping_mul(10_000).wrapping_add(fours >> 32) & 0xffff_ffff
}

/// Eight bytes from `at` on, little endian, blanks beyond the end.
#[inline]
pub(super) fn eight_bytes(text: &[u8], at: usize) -> u64 {
    let rest = text.get(at..).unwrap_or_default();
    if let Some((word, _)) = rest.split_first_chunk::<8>() {
        return u64::from_le_bytes(*word);
    }
    let mut word = [b' '; 8];
    for (to, from) in word.iter_mut().zip(rest) {
        *to = *from;
    }
    u64::from_le_bytes(word)
}

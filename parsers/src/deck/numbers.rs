//! Decimal numbers to `f64`, correctly rounded, fifteen digits at a time.
//!
//! A decimal with at most 2^53 as its digits and a power of ten up to 22 is one exact integer
//! multiplied or divided by another, so the one rounding of that operation is the correct one
//! (Clinger 1990). All other numbers go through the standard library.

use nom::character::complete::{digit0, digit1, one_of};
use nom::combinator::{all_consuming, opt};
use nom::sequence::preceded;
use nom::{IResult, Parser};

/// Powers of ten that `f64` holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];
const EXACT: u64 = 1 << 53;

/// The number at the start of `text` and its length, where the fast path can read it: at most
/// 15 bytes of digits and one point behind the sign, and a blank behind them.
///
/// `None` says nothing about the token: hand it to [`number`].
#[inline]
pub(super) fn leading_number(text: &[u8]) -> Option<(f64, usize)> {
    let negative = text.first() == Some(&b'-');
    let start = usize::from(negative);
    let word = sixteen_bytes(text, start);
    // Digits become 0..=9; any other byte sets its high bit in `others`.
    let values = word ^ bytes_of(b'0');
    let others = high_bits(((values & bytes_of(0x7f)) + bytes_of(0x76)) | values);
    let first = others.trailing_zeros();
    let is_point = first < 128 && (word >> (first - 7)) & 0xff == u128::from(b'.');
    let (end, point) = if is_point {
        ((others & (others - 1)).trailing_zeros(), first - 7)
    } else {
        (first, 128)
    };
    // Bits of the digits, without the point.
    let digits = end.checked_sub(if is_point { 15 } else { 7 })?;
    if end == 128 || digits == 0 || (word >> (end - 7)) & 0xff > u128::from(b' ') {
        return None;
    }
    let before = u128::MAX.unbounded_shr(128 - point);
    let values = (values & before) | ((values >> 8) & !before);
    // Leading zeros take the place of what follows the digits.
    let values = values << (128 - digits);
    let [high, low] = [values, values >> 64].map(|half| joined(low_half(half)));
    let fraction_digits = ((digits.saturating_sub(point)) / 8) as usize;
    #[allow(clippy::cast_precision_loss, reason = "15 digits are exact")]
    let magnitude = (high * 100_000_000 + low) as f64 / POWERS.get(fraction_digits)?;
    let length = start + (end / 8) as usize;
    Some((if negative { -magnitude } else { magnitude }, length))
}

/// `byte` sixteen times.
const fn bytes_of(byte: u8) -> u128 {
    u128::from_le_bytes([byte; 16])
}

/// The high bit of each byte.
const fn high_bits(word: u128) -> u128 {
    word & bytes_of(0x80)
}

#[allow(clippy::cast_possible_truncation, reason = "the lower half is meant")]
const fn low_half(word: u128) -> u64 {
    word as u64
}

/// The high bit of each byte that is no blank.
#[inline]
pub(super) const fn visible(word: u128) -> u128 {
    high_bits(((word & bytes_of(0x7f)) + bytes_of(0x5f)) | word)
}

/// The decimal number of eight digit values, most significant in the lowest byte.
#[inline]
fn joined(values: u64) -> u64 {
    let pairs = values.wrapping_mul(10).wrapping_add(values >> 8) & 0x00ff_00ff_00ff_00ff;
    let fours = pairs.wrapping_mul(100).wrapping_add(pairs >> 16) & 0x0000_ffff_0000_ffff;
    fours.wrapping_mul(10_000).wrapping_add(fours >> 32) & 0xffff_ffff
}

/// Sixteen bytes from `at` on, little endian, blanks beyond the end.
#[inline]
pub(super) fn sixteen_bytes(text: &[u8], at: usize) -> u128 {
    let rest = text.get(at..).unwrap_or_default();
    if let Some((word, _)) = rest.split_first_chunk::<16>() {
        return u128::from_le_bytes(*word);
    }
    let mut word = [b' '; 16];
    for (to, from) in word.iter_mut().zip(rest) {
        *to = *from;
    }
    u128::from_le_bytes(word)
}

/// The parts of a decimal number: minus sign, digits before and after the point, power of ten.
struct Decimal<'a> {
    negative: bool,
    whole: &'a [u8],
    fraction: &'a [u8],
    exponent: Option<(bool, &'a [u8])>,
}

/// The value of a whole token in Fortran or C notation; `None` where it is no decimal number.
///
/// A number beyond the range of `f64` is infinite, as the standard library has it.
pub(super) fn number(token: &[u8]) -> Option<f64> {
    let (_, decimal) = all_consuming(decimal).parse(token).ok()?;
    if decimal.whole.is_empty() && decimal.fraction.is_empty() {
        return None;
    }
    exact(&decimal).or_else(|| {
        let text = std::str::from_utf8(token).ok()?;
        text.replace(['d', 'D'], "e").parse().ok()
    })
}

fn decimal(input: &[u8]) -> IResult<&[u8], Decimal<'_>> {
    let exponent = (one_of("eEdD"), opt(one_of("+-")), digit1);
    let parts = (
        opt(one_of("+-")),
        digit0,
        opt(preceded(nom::character::complete::char('.'), digit0)),
        opt(exponent),
    );
    parts
        .map(|(sign, whole, fraction, exponent)| Decimal {
            negative: sign == Some('-'),
            whole,
            fraction: fraction.unwrap_or_default(),
            exponent: exponent.map(|(_, sign, digits)| (sign == Some('-'), digits)),
        })
        .parse(input)
}

/// The value where one exact multiplication or division gives it.
fn exact(decimal: &Decimal) -> Option<f64> {
    let whole = joined_digits(0, decimal.whole)?;
    let digits = joined_digits(whole, decimal.fraction)?;
    if digits > EXACT {
        return None;
    }
    let (down, power) = decimal.exponent.unwrap_or_default();
    let power = i64::try_from(joined_digits(0, power)?).ok()?;
    let scale = if down { -power } else { power } - i64::try_from(decimal.fraction.len()).ok()?;
    let factor = *POWERS.get(usize::try_from(scale.unsigned_abs()).ok()?)?;
    #[allow(clippy::cast_precision_loss, reason = "digits are at most 2^53")]
    let digits = digits as f64;
    let magnitude = if scale < 0 {
        digits / factor
    } else {
        digits * factor
    };
    Some(if decimal.negative {
        -magnitude
    } else {
        magnitude
    })
}

/// `start` followed by `digits`; `None` beyond 18 of them, which surely fit in 64 bits.
fn joined_digits(start: u64, digits: &[u8]) -> Option<u64> {
    digits.iter().try_fold(start, |sum, digit| {
        (sum < 10_u64.pow(17)).then(|| sum * 10 + u64::from(digit - b'0'))
    })
}

//! Types of samples, and their bytes.

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ByteOrder {
    /// The lowest byte first.
    Little,
    /// The highest byte first.
    Big,
}

/// Type of the samples in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleType {
    /// 1 byte with sign.
    I8,
    /// 1 byte without sign.
    U8,
    /// 2 bytes with sign.
    I16,
    /// 2 bytes without sign.
    U16,
    /// 3 bytes with sign.
    I24,
    /// 3 bytes without sign.
    U24,
    /// 4 bytes with sign.
    I32,
    /// 4 bytes without sign.
    U32,
    /// 8 bytes with sign; beyond 2^53 values are rounded.
    I64,
    /// 8 bytes without sign; beyond 2^53 values are rounded.
    U64,
    /// 4-byte real of IEEE 754.
    F32,
    /// 8-byte real of IEEE 754.
    F64,
    /// 4-byte real of the IBM System/360: a fraction of 24 bits and a power of 16.
    Ibm32,
}

impl SampleType {
    /// All types.
    pub const ALL: [Self; 13] = [
        Self::I8,
        Self::U8,
        Self::I16,
        Self::U16,
        Self::I24,
        Self::U24,
        Self::I32,
        Self::U32,
        Self::I64,
        Self::U64,
        Self::F32,
        Self::F64,
        Self::Ibm32,
    ];

    /// Bytes of a sample.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I24 | Self::U24 => 3,
            Self::I32 | Self::U32 | Self::F32 | Self::Ibm32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Short name, such as `u8`.
    pub fn name(self) -> &'static str {
        match self {
            Self::I8 => "i8",
            Self::U8 => "u8",
            Self::I16 => "i16",
            Self::U16 => "u16",
            Self::I24 => "i24",
            Self::U24 => "u24",
            Self::I32 => "i32",
            Self::U32 => "u32",
            Self::I64 => "i64",
            Self::U64 => "u64",
            Self::F32 => "f32",
            Self::F64 => "f64",
            Self::Ibm32 => "ibm32",
        }
    }

    /// The type of a short name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Smallest and largest whole number; `None` of reals.
    fn bounds(self) -> Option<[f64; 2]> {
        let bits = 8 * self.size() as i32;
        match self {
            Self::F32 | Self::F64 | Self::Ibm32 => None,
            Self::U8 | Self::U16 | Self::U24 | Self::U32 | Self::U64 => {
                Some([0.0, 2_f64.powi(bits) - 1.0])
            }
            _ => Some([-2_f64.powi(bits - 1), 2_f64.powi(bits - 1) - 1.0]),
        }
    }
}

/// What samples are read as: `f32` or `f64`.
///
/// All types but 4- and 8-byte integers and `f64` are exact as `f32`. Values beyond the range of `f32` become infinite.
pub trait Value: Copy + Default + Send + Sync + 'static {
    /// Stands for no value.
    const NONE: Self;
    /// The nearest value of this type.
    fn of(value: f64) -> Self;
    /// As `f64`.
    fn wide(self) -> f64;
}

impl Value for f32 {
    const NONE: Self = f32::NAN;
    fn of(value: f64) -> Self {
        value as f32
    }
    fn wide(self) -> f64 {
        f64::from(self)
    }
}

impl Value for f64 {
    const NONE: Self = f64::NAN;
    fn of(value: f64) -> Self {
        value
    }
    fn wide(self) -> f64 {
        self
    }
}

/// How samples stand in bytes: type and order of bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Coding {
    pub(super) kind: SampleType,
    pub(super) order: ByteOrder,
}

impl Coding {
    /// Values of samples that begin `stride` bytes apart.
    pub(super) fn decode<T: Value>(self, bytes: &[u8], stride: usize, out: &mut [T]) {
        /// One loop for each type, so that the type is not asked for each sample.
        macro_rules! each {
            ($size:literal, $value:expr) => {{
                let samples = bytes
                    .chunks(stride)
                    .filter_map(|c| c.first_chunk::<$size>());
                let is_big = self.order == ByteOrder::Big;
                for (value, sample) in out.iter_mut().zip(samples) {
                    let mut little = *sample;
                    if is_big {
                        little.reverse();
                    }
                    *value = T::of($value(little));
                }
            }};
        }
        let wide = |b: [u8; 3]| [b[0], b[1], b[2], 0];
        match self.kind {
            SampleType::I8 => each!(1, |b| f64::from(i8::from_le_bytes(b))),
            SampleType::U8 => each!(1, |b| f64::from(u8::from_le_bytes(b))),
            SampleType::I16 => each!(2, |b| f64::from(i16::from_le_bytes(b))),
            SampleType::U16 => each!(2, |b| f64::from(u16::from_le_bytes(b))),
            // The sign moves to the highest bit and back.
            SampleType::I24 => each!(3, |b| f64::from(i32::from_le_bytes(wide(b)) << 8 >> 8)),
            SampleType::U24 => each!(3, |b| f64::from(u32::from_le_bytes(wide(b)))),
            SampleType::I32 => each!(4, |b| f64::from(i32::from_le_bytes(b))),
            SampleType::U32 => each!(4, |b| f64::from(u32::from_le_bytes(b))),
            SampleType::I64 => each!(8, |b| i64::from_le_bytes(b) as f64),
            SampleType::U64 => each!(8, |b| u64::from_le_bytes(b) as f64),
            SampleType::F32 => each!(4, |b| f64::from(f32::from_le_bytes(b))),
            SampleType::F64 => each!(8, f64::from_le_bytes),
            SampleType::Ibm32 => each!(4, |b| from_ibm(u32::from_le_bytes(b))),
        }
    }

    /// Appends a value, rounded to the type; `None` where the type has no such value, as whole numbers have no NaN.
    pub(super) fn encode(self, value: f64, out: &mut Vec<u8>) -> Option<()> {
        let start = out.len();
        if let Some([low, high]) = self.kind.bounds() {
            let whole = value.round();
            if !(low..=high).contains(&whole) {
                return None;
            }
            // Numbers without sign beyond the signed ones have the same bytes after a cast to 128 bits.
            out.extend(&(whole as i128).to_le_bytes()[..self.kind.size()]);
        } else {
            match self.kind {
                SampleType::F64 => out.extend(value.to_le_bytes()),
                SampleType::Ibm32 => out.extend(to_ibm(value)?.to_le_bytes()),
                _ => out.extend((value as f32).to_le_bytes()),
            }
        }
        if self.order == ByteOrder::Big {
            out[start..].reverse();
        }
        Some(())
    }

    /// What is read where `value` was meant: as rounded to the type; `None` where no sample can be that.
    pub(super) fn rounded(self, value: f64) -> Option<f64> {
        let mut bytes = Vec::with_capacity(8);
        self.encode(value, &mut bytes)?;
        let mut read = [0.0];
        self.decode(&bytes, bytes.len(), &mut read);
        Some(read[0])
    }
}

/// 2 to the power of `exponent`, for exponents of normal numbers.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// The value of an IBM real: sign, 7 bits of a power of 16 that counts from -64, and a fraction of 24 bits. Exact.
pub(super) fn from_ibm(bits: u32) -> f64 {
    let fraction = f64::from(bits & 0x00ff_ffff);
    let exponent = 4 * ((bits >> 24 & 0x7f) as i32 - 64) - 24;
    let value = fraction * power_of_two(exponent);
    if bits >> 31 == 1 { -value } else { value }
}

/// The nearest IBM real, normalized; zero below the smallest one, `None` of what is not finite or beyond the largest.
pub(super) fn to_ibm(value: f64) -> Option<u32> {
    if !value.is_finite() {
        return None;
    }
    let sign = u32::from(value.is_sign_negative()) << 31;
    let magnitude = value.abs();
    // `magnitude` is below 2^binary.
    let binary = (magnitude.to_bits() >> 52) as i32 - 1022;
    let mut power = (binary + 3).div_euclid(4);
    if magnitude == 0.0 || power < -64 {
        return Some(sign);
    }
    if power > 63 {
        return None;
    }
    let mut fraction = (magnitude * power_of_two(24 - 4 * power)).round() as u32;
    if fraction > 0x00ff_ffff {
        fraction >>= 4;
        power += 1;
    }
    (power <= 63).then(|| sign | ((power + 64) as u32) << 24 | fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: sign, power of 16, fraction.
    const IBM: [(u32, f64); 20] = [
        (0x0000_0000, 0.0),
        (0x4110_0000, 1.0),
        (0xc110_0000, -1.0),
        (0x4080_0000, 0.5),
        (0x4040_0000, 0.25),
        (0x4120_0000, 2.0),
        (0x41a0_0000, 10.0),
        (0x4264_0000, 100.0),
        (0x433e_8000, 1000.0),
        (0xc276_a000, -118.625),
        (0x4019_999a, 0.100_000_023_841_857_91),
        (0x4132_43f7, 3.141_592_979_431_152_3),
        (0x3f10_0000, 1.0 / 256.0),
        (0x4110_0001, 1.000_000_953_674_316_4),
        (0x40ff_ffff, 0.999_999_940_395_355_2),
        (0x46ff_ffff, 16_777_215.0),
        (0x4710_0000, 16_777_216.0),
        (0x7fff_ffff, 7.237_005_145_973_118e75),
        (0x0010_0000, 5.397_605_346_934_028e-79),
        (0xffff_ffff, -7.237_005_145_973_118e75),
    ];

    #[test]
    fn ibm_reals_by_a_table() {
        for (bits, value) in IBM {
            let read = from_ibm(bits);
            assert!(
                (read - value).abs() <= 1e-15 * value.abs(),
                "{bits:#x} {read}"
            );
            assert_eq!(to_ibm(read), Some(bits), "{read}");
            // As an IEEE real the same bits are another number.
            let ieee = f64::from(f32::from_bits(bits));
            assert!(bits == 0 || ieee.is_nan() || (ieee - value).abs() > 1e-3 * value.abs());
        }
        assert_eq!(from_ibm(0x4101_0000), 1.0 / 16.0, "not normalized");
        assert_eq!(to_ibm(f64::NAN), None);
        assert_eq!(to_ibm(1e76), None);
        assert_eq!(to_ibm(1e-90), Some(0));
        // Rounded up to the next power.
        assert_eq!(to_ibm(0.999_999_999_9), Some(0x4110_0000));
    }

    #[test]
    fn every_type_reads_what_it_writes() {
        for kind in SampleType::ALL {
            for order in [ByteOrder::Little, ByteOrder::Big] {
                let coding = Coding { kind, order };
                let bounds = kind.bounds().unwrap_or([-118.625, 1e6]);
                // The largest 8-byte numbers are not exact.
                let values = [bounds[0], 0.0, 1.0, 100.0, bounds[1].min(2_f64.powi(53))];
                let mut bytes = Vec::new();
                for value in values {
                    coding.encode(value, &mut bytes).unwrap();
                }
                assert_eq!(bytes.len(), values.len() * kind.size());
                let mut read = [0.0; 5];
                coding.decode(&bytes, kind.size(), &mut read);
                assert_eq!(read, values, "{kind:?} {order:?}");
                let other = match order {
                    ByteOrder::Little => ByteOrder::Big,
                    ByteOrder::Big => ByteOrder::Little,
                };
                let other = Coding { kind, order: other };
                other.decode(&bytes, kind.size(), &mut read);
                assert_eq!(read == values, kind.size() == 1, "{kind:?}");
            }
        }
    }

    #[test]
    fn whole_numbers_have_bounds() {
        let coding = Coding {
            kind: SampleType::U8,
            order: ByteOrder::Little,
        };
        assert_eq!(coding.rounded(254.6), Some(255.0));
        assert_eq!(coding.rounded(-1.0), None);
        assert_eq!(coding.rounded(256.0), None);
        assert_eq!(coding.rounded(f64::NAN), None);
    }
}

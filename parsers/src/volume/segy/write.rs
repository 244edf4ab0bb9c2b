//! Writing SEG-Y files: samples that are read again by the numbers and places of their traces.

use std::io::{self, BufWriter, Write};

use super::super::sample::{ByteOrder, Coding, SampleType};
use super::header::{self, TRACE_HEADER};
use super::text;
use crate::records::refused;

/// What all traces of a file have in common.
#[derive(Debug, Clone, PartialEq)]
pub struct SegyLayout {
    /// Type of the samples: [`SampleType::Ibm32`] and [`SampleType::F32`] are what all programs read.
    pub sample: SampleType,
    /// Big-endian as rev 0 and 1 are; little-endian files are of rev 2.
    pub byte_order: ByteOrder,
    /// Samples of a trace.
    pub samples: usize,
    /// Step between samples, in ms or in lengths.
    pub interval: f64,
    /// Time of the first sample in whole ms.
    pub delay: i16,
    /// Lines of the text header.
    pub text: String,
}

/// Writes traces in any order; places of the lattice may be left out.
#[derive(Debug)]
pub struct SegyWriter<W: Write> {
    out: BufWriter<W>,
    layout: SegyLayout,
    interval: u16,
    count: i32,
}

/// Coordinates are whole hundredths.
const SCALAR: i16 = -100;

impl<W: Write> SegyWriter<W> {
    /// A writer to `out`, which needs no buffer of its own.
    ///
    /// # Errors
    /// When writing fails, or the interval or the number of samples does not fit in the header.
    pub fn new(out: W, layout: SegyLayout) -> io::Result<Self> {
        let thousandths = layout.interval * 1000.0;
        let interval = (thousandths.round() as i64).clamp(0, i64::from(i16::MAX)) as u16;
        if interval == 0 || (f64::from(interval) - thousandths).abs() > 1e-6 {
            let message = format!(
                "an interval of {} is not 0.001 to 32.767 in whole thousandths",
                layout.interval
            );
            return Err(refused(message));
        }
        if !(1..=usize::from(u16::MAX)).contains(&layout.samples) {
            let message = format!("traces of {} samples: 1 to 65535 fit", layout.samples);
            return Err(refused(message));
        }
        let mut writer = Self {
            out: BufWriter::new(out),
            layout,
            interval,
            count: 0,
        };
        let mut binary = writer.header(3201, 400);
        let is_little = writer.layout.byte_order == ByteOrder::Little;
        binary.put(3217, i32::from(interval), 2);
        binary.put(3221, writer.layout.samples as i32, 2);
        binary.put(3225, i32::from(header::code(writer.layout.sample)), 2);
        binary.put(3255, 1, 2);
        binary.bytes[300] = if is_little { 2 } else { 1 };
        binary.put(3503, 1, 2);
        if is_little {
            binary.put(3297, 0x0102_0304, 4);
        }
        writer.out.write_all(&text::header(&writer.layout.text))?;
        writer.out.write_all(&binary.bytes)?;
        Ok(writer)
    }

    fn header(&self, first: usize, length: usize) -> Bytes {
        Bytes {
            bytes: vec![0; length],
            first,
            order: self.layout.byte_order,
        }
    }

    /// Writes a trace with its inline and crossline number and its place, which is rounded to hundredths.
    ///
    /// # Errors
    /// When writing fails, there is another number of values than samples, the type has no such value, or the place does
    /// not fit.
    pub fn trace(
        &mut self,
        inline: i32,
        crossline: i32,
        place: [f64; 2],
        values: &[f32],
    ) -> io::Result<()> {
        if values.len() != self.layout.samples {
            let message = format!(
                "{} values for {} samples",
                values.len(),
                self.layout.samples
            );
            return Err(refused(message));
        }
        let place = place.map(|v| (v * 100.0).round());
        if place
            .iter()
            .any(|v| v.abs() > f64::from(i32::MAX) || v.is_nan())
        {
            return Err(refused("coordinates beyond 21 million do not fit".into()));
        }
        self.count += 1;
        let mut header = self.header(1, TRACE_HEADER as usize);
        for (number, value) in [
            (1, self.count),
            (5, self.count),
            (21, self.count),
            (189, inline),
            (193, crossline),
        ] {
            header.put(number, value, 4);
        }
        for (number, value) in [
            (73, place[0]),
            (77, place[1]),
            (181, place[0]),
            (185, place[1]),
        ] {
            header.put(number, value as i32, 4);
        }
        for (number, value) in [
            (29, 1),
            (71, i32::from(SCALAR)),
            (89, 1),
            (109, i32::from(self.layout.delay)),
            (115, self.layout.samples as i32),
            (117, i32::from(self.interval)),
        ] {
            header.put(number, value, 2);
        }
        let mut bytes = header.bytes;
        let coding = Coding {
            kind: self.layout.sample,
            order: self.layout.byte_order,
        };
        for value in values {
            coding
                .encode(f64::from(*value), &mut bytes)
                .ok_or_else(|| {
                    let kind = coding.kind.name();
                    refused(format!(
                        "trace {inline}, {crossline}: {value} is none of the type {kind}"
                    ))
                })?;
        }
        self.out.write_all(&bytes)
    }

    /// Hands back the underlying writer.
    ///
    /// # Errors
    /// When writing the last bytes fails.
    pub fn finish(self) -> io::Result<W> {
        self.out
            .into_inner()
            .map_err(io::IntoInnerError::into_error)
    }
}

struct Bytes {
    bytes: Vec<u8>,
    first: usize,
    order: ByteOrder,
}

impl Bytes {
    /// Puts the lowest `size` bytes of a number at byte `number`.
    fn put(&mut self, number: usize, value: i32, size: usize) {
        let mut bytes = value.to_le_bytes();
        let bytes = &mut bytes[..size];
        if self.order == ByteOrder::Big {
            bytes.reverse();
        }
        let start = number - self.first;
        self.bytes[start..start + size].copy_from_slice(bytes);
    }
}

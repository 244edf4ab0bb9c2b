//! H.264 in MP4, by OpenH264. Color is that of BT.601 over the primaries of sRGB, and says so.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::ops::Range;
use std::path::Path;

use muxide::api::{Muxer, MuxerBuilder, VideoCodec};
use openh264::encoder::{
    Encoder as H264, EncoderConfig, FrameRate, FrameType, MatrixCoefficients, QpRange,
    RateControlMode, TransferCharacteristics, VuiConfig,
};
use openh264::formats::{RgbSliceU8, YUVBuffer};
use openh264::{OpenH264API, Timestamp};

use super::{Encoder, FilmShape};
use crate::picture::files::Cause;

/// Quantizer of every picture, 0 (best) to 51. Text stays sharp, and about 1 dB is lost beside what
/// halving the resolution of color takes. The bit rate follows size and content: with one that is
/// asked for, the encoder leaves pictures out.
const QUANTIZER: u8 = 20;
/// Sides of a picture in pixels, larger and smaller, at most and at least.
const LARGEST: [u32; 2] = [3840, 2160];
const SMALLEST: u32 = 16;

pub struct Mp4 {
    encoder: H264,
    muxer: Muxer<BufWriter<File>>,
    size: [usize; 2],
    /// Width and height are even: color has half the resolution.
    padded: [usize; 2],
    fps: f64,
    written: u32,
}

impl Mp4 {
    pub fn create(path: &Path, shape: FilmShape) -> Result<Self, Cause> {
        let padded = shape.size.map(|n| n.next_multiple_of(2));
        let (smaller, larger) = (padded[0].min(padded[1]), padded[0].max(padded[1]));
        if smaller < SMALLEST || larger > LARGEST[0] || smaller > LARGEST[1] {
            let [w, h] = shape.size;
            return Err(format!("images of {w}x{h} do not fit H.264: use {SMALLEST}x{SMALLEST} to 3840x2160, or name a .png").into());
        }
        // What the conversion below computes; sRGB and BT.709 share their primaries.
        let color = VuiConfig::bt709()
            .transfer_characteristics(TransferCharacteristics::Srgb)
            .matrix_coefficients(MatrixCoefficients::Smpte170M);
        let config = EncoderConfig::new()
            .max_frame_rate(FrameRate::from_hz(shape.fps as f32))
            .rate_control_mode(RateControlMode::Bufferbased)
            .qp(QpRange::new(QUANTIZER, QUANTIZER))
            .skip_frames(false)
            .vui(color);
        let file = BufWriter::new(File::create(path)?);
        let muxer = MuxerBuilder::new(file)
            .video(VideoCodec::H264, padded[0], padded[1], shape.fps)
            .build()?;
        Ok(Self {
            encoder: H264::with_api_config(OpenH264API::from_source(), config)?,
            muxer,
            size: shape.size.map(|n| n as usize),
            padded: padded.map(|n| n as usize),
            fps: shape.fps,
            written: 0,
        })
    }

    /// The picture with its last column and row repeated where its sides are odd.
    fn padded(&self, rgb: &[[u8; 3]]) -> Vec<[u8; 3]> {
        let ([w, h], [padded_w, padded_h]) = (self.size, self.padded);
        let row = |y: usize| (0..padded_w).map(move |x| rgb[x.min(w - 1) + w * y.min(h - 1)]);
        (0..padded_h).flat_map(row).collect()
    }
}

impl Encoder for Mp4 {
    /// A picture that stands for long is repeated: some players want an even rate.
    fn add(&mut self, rgb: &[[u8; 3]], seen: Range<f64>) -> Result<(), Cause> {
        let rgb = self.padded(rgb);
        let yuv = YUVBuffer::from_rgb8_source(RgbSliceU8::new(
            rgb.as_flattened(),
            (self.padded[0], self.padded[1]),
        ));
        let until = (seen.end * self.fps).round() as u32;
        while self.written < until {
            let at = f64::from(self.written) / self.fps;
            let timestamp = Timestamp::from_millis((1000.0 * at).round() as u64);
            let stream = self.encoder.encode_at(&yuv, timestamp)?;
            let key = matches!(stream.frame_type(), FrameType::IDR | FrameType::I);
            self.muxer.write_video(at, &stream.to_vec(), key)?;
            self.written += 1;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<(), Cause> {
        self.muxer.finish_in_place()?;
        Ok(self.muxer.into_writer().flush()?)
    }
}

//! Value to color and extinction, and sums of them along a ray. The twin of `shaders/shared/transfer.wgsl` and
//! `table.wgsl`.

use glam::{Vec3A, Vec4, Vec4Swizzles};

use super::along::LightAlong;
use super::each::Each;
use crate::render::plan::layout::{LUT_SIZE, per_unit};
use crate::render::plan::transfer::{transfer_integrals, transfer_table};
use crate::view::View;

/// The transfer function's tables, for one transfer function and blending.
pub struct Tables {
    /// Color, as it is blended, and extinction at equal distances over the range.
    table: Vec<Vec4>,
    /// Integrals over the position of extinction times color, and of extinction.
    integrals: Vec<Vec4>,
}

impl Tables {
    /// The tables of a view.
    pub fn new(view: &View) -> Self {
        Self::of(&transfer_table(view))
    }

    /// Those of a table of colors, as they are blended, and extinctions.
    pub fn of(table: &[[f32; 4]]) -> Self {
        let vectors = |entries: &[[f32; 4]]| entries.iter().map(|e| Vec4::from(*e)).collect();
        Self {
            integrals: vectors(&transfer_integrals(table)),
            table: vectors(table),
        }
    }

    /// Color and extinction at a position, whatever is seen of insides.
    #[inline]
    pub fn at(&self, position: f32) -> Vec4 {
        between(&self.table, position.clamp(0.0, 1.0))
    }
}

/// What rays make of values.
pub struct Transfer<'a> {
    tables: &'a Tables,
    value_low: f32,
    value_scale: f32,
    /// World-space distance of samples.
    step: f32,
    /// Transmittance at which a ray ends.
    early_termination: f32,
    /// Cells with a value are solid: nothing of their inside is seen.
    is_solid: bool,
}

/// Front-to-back emission and absorption; colors as they are blended, premultiplied.
#[derive(Clone, Copy)]
pub struct Accumulated {
    /// Red, green and blue.
    pub color: Vec3A,
    /// What is left of what lies behind.
    pub transmittance: f32,
    /// Light that was found on the way.
    pub light: LightAlong,
}

impl Accumulated {
    /// Nothing but a color that covers all behind it by its fourth coordinate.
    #[inline]
    pub fn of(color: Vec4) -> Self {
        Self {
            color: Vec3A::from_vec4(color),
            transmittance: 1.0 - color.w,
            light: LightAlong::default(),
        }
    }

    /// Adds a stretch of one color and an optical depth.
    #[inline]
    pub fn absorb(&mut self, entry: Vec4, optical_depth: f32) {
        self.pass(Vec3A::from_vec4(entry), passed(optical_depth));
    }

    /// Adds a stretch of one color that lets a part pass of what lies behind.
    #[inline]
    pub fn pass(&mut self, color: Vec3A, passed: f32) {
        self.color += self.transmittance * (1.0 - passed) * color;
        self.transmittance *= passed;
    }

    /// Lays a color of an opacity behind what there is.
    #[inline]
    pub fn blend(&mut self, color: Vec3A, opacity: f32) {
        self.color += self.transmittance * opacity * color;
        self.transmittance *= 1.0 - opacity;
    }

    /// The pixel: color times alpha, and alpha.
    pub fn pixel(&self) -> [f32; 4] {
        let [r, g, b] = self.color.to_array();
        [r, g, b, 1.0 - self.transmittance]
    }
}

impl<'a> Transfer<'a> {
    /// What rays of a view make of values.
    pub fn new(tables: &'a Tables, view: &View) -> Self {
        let range = view.style.transfer.range;
        Self {
            tables,
            value_low: range[0] as f32,
            value_scale: per_unit(range),
            step: view.sampling.step as f32,
            early_termination: view.sampling.early_termination as f32,
            is_solid: view.style.surfaces.solid,
        }
    }

    /// Part of the range of values per unit.
    pub fn value_scale(&self) -> f32 {
        self.value_scale
    }

    /// Color and extinction of the inside of a cell.
    pub fn of(&self, value: f32) -> Vec4 {
        self.at(self.position(value))
    }

    /// Color and extinction of the inside of a cell, by its position.
    pub fn at(&self, position: f32) -> Vec4 {
        let entry = self.tables.at(position);
        match self.is_solid {
            true => entry.xyz().extend(0.0),
            false => entry,
        }
    }

    #[inline]
    fn position(&self, value: f32) -> f32 {
        ((value - self.value_low) * self.value_scale).clamp(0.0, 1.0)
    }

    /// Means over the values between two: of extinction times color, and of extinction.
    #[inline]
    pub fn mean(&self, a: f32, b: f32) -> Vec4 {
        if self.is_solid {
            return Vec4::ZERO;
        }
        let [pa, pb] = [a, b].each(|value| self.position(value));
        if (pb - pa).abs() * ((LUT_SIZE - 1) as f32) < 4.0 {
            // Differences of large sums would be rounding errors; the table is all but linear here.
            let entry = self.of(0.5 * (a + b));
            return (entry.xyz() * entry.w).extend(entry.w);
        }
        let integral = |position| between(&self.tables.integrals, position);
        (integral(pb) - integral(pa)) / (pb - pa)
    }

    /// Colors and extinctions of the inside of a cell at four values, and what a sample of each lets pass.
    #[inline]
    pub fn of_four(&self, values: Vec4) -> ([Vec4; 4], Vec4) {
        self.at_four((values - self.value_low) * self.value_scale)
    }

    /// As [`Self::of_four`], by their positions.
    #[inline]
    pub fn at_four(&self, positions: Vec4) -> ([Vec4; 4], Vec4) {
        let entries = positions.to_array().each(|position| self.at(position));
        let depths = self.step * Vec4::from_array(entries.each(|entry| entry.w));
        (entries, passed_four(depths))
    }

    /// What a sample of an extinction lets pass.
    #[inline]
    pub fn passed(&self, extinction: f32) -> f32 {
        passed(extinction * self.step)
    }

    /// Adds so many samples of one color and extinction, or as many of them as a ray needs until it ends; returns
    /// how many these were.
    pub fn accumulate_many(&self, sum: &mut Accumulated, entry: Vec4, count: f32) -> f32 {
        let depth = entry.w * self.step;
        let open = self.early_termination.max(1e-30) / sum.transmittance;
        let needed = (open.ln() / -depth.max(1e-20)).ceil().max(1.0);
        let count = count.min(needed);
        sum.absorb(entry, depth * count);
        count
    }

    /// False once nothing behind can be seen.
    #[inline]
    pub fn is_open(&self, sum: &Accumulated) -> bool {
        sum.transmittance > 0.0 && sum.transmittance >= self.early_termination
    }
}

/// Part of the light that passes an optical depth: e to the power of minus that, to 2e-7 of it.
#[inline]
pub fn passed(depth: f32) -> f32 {
    passed_four(Vec4::splat(depth)).x
}

/// [`passed`] of four depths.
#[inline]
pub fn passed_four(depths: Vec4) -> Vec4 {
    // Coefficients of the series of 2^f behind 1: powers of ln 2 over factorials.
    const SERIES: [f32; 6] = [
        std::f32::consts::LN_2,
        0.240_226_5,
        0.055_504_11,
        0.009_618_129,
        0.001_333_355_8,
        0.000_154_035_3,
    ];
    // Added to a small number, this leaves it as a whole one in the low bits.
    const ROUNDING: f32 = 12_582_912.0;
    // Smaller powers of two are no normal numbers.
    let power = (-std::f32::consts::LOG2_E * depths).max(Vec4::splat(-126.0));
    let rounded = power + ROUNDING;
    let f = power - (rounded - ROUNDING);
    let [a, b, c, d, e, g] = SERIES;
    let of_fraction = 1.0 + f * (a + f * (b + f * (c + f * (d + f * (e + f * g)))));
    let bits = rounded.to_array().map(f32::to_bits);
    let of_whole = bits.each(|n| f32::from_bits((n << 23).wrapping_add(1.0f32.to_bits())));
    of_fraction * Vec4::from_array(of_whole)
}

/// Linear between the entries of a table, at a position from 0 to 1.
#[inline]
fn between(table: &[Vec4], position: f32) -> Vec4 {
    let at = position * (LUT_SIZE - 1) as f32;
    // Numbers of 16 bits are the fastest to get from f32.
    let entry = (at as u16).min(LUT_SIZE as u16 - 2);
    let first = usize::from(entry);
    match table.get(first..first + 2) {
        Some([low, high]) => low.lerp(*high, at - f32::from(entry)),
        _ => Vec4::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_passes_is_the_exponential_function() {
        for n in 0..20_000 {
            let depth = n as f32 * 4e-3;
            let exact = (-f64::from(depth)).exp();
            let off = (f64::from(passed(depth)) / exact - 1.0).abs();
            // The power itself is rounded, the more the larger it is.
            assert!(off < 3e-7 + 1e-7 * f64::from(depth), "{depth} {off}");
        }
        assert_eq!(passed(0.0), 1.0);
        assert!(passed(f32::MAX) < 2e-38 && passed(f32::INFINITY) < 2e-38);
    }
}

//! Radial grids as corner-point grids: pillars by radius and angle become pillars by x and y.

/// Sectors that are wider are drawn as wide as this: the straight sides of wider ones would cut off most of them, and
/// those of a whole circle would leave nothing.
const WIDEST: f64 = 90.0;

/// Replaces radius and angle of each pillar end by x and y, of a grid of `ni` cells along the radius.
///
/// **Shape**: 6 values per pillar, as COORD; radius, angle in degrees from the x axis towards the y axis, depth.
///
/// The sentence says what was done.
pub(crate) fn straighten(coord: &mut [f64], ni: usize) -> String {
    let row = 6 * (ni + 1);
    let widest = widest_sector(coord, row);
    if widest > WIDEST {
        narrow(coord, row);
    }
    for end in coord.chunks_exact_mut(3) {
        // A whole turn is the same place as none, to the last bit.
        let (sin, cos) = end[1].rem_euclid(360.0).to_radians().sin_cos();
        (end[0], end[1]) = (end[0] * cos, end[0] * sin);
    }
    if widest > WIDEST {
        return format!(
            "the grid is radial and its widest sector has {widest} degrees: sectors are drawn with straight sides and at most {WIDEST} degrees wide, so their volumes are too small"
        );
    }
    let angle = widest.to_radians();
    let drawn = if angle > 0.0 {
        angle.sin() / angle
    } else {
        1.0
    };
    let less = 100.0 * (1.0 - drawn);
    format!(
        "the grid is radial: its sectors are drawn with straight sides, so their volumes are up to {less:.1} % too small"
    )
}

/// The angles across the sectors of a side, upper or lower, between two rows of pillars.
fn widest_sector(coord: &[f64], row: usize) -> f64 {
    let angles = |coord: &[f64]| coord.iter().skip(1).step_by(3).copied().collect::<Vec<_>>();
    let rows: Vec<_> = coord.chunks_exact(row).map(angles).collect();
    let sectors = rows.windows(2).flat_map(|pair| {
        let ends = pair[0].iter().zip(&pair[1]);
        ends.map(|(first, last)| (last - first).abs())
    });
    sectors.fold(0.0, f64::max)
}

/// Makes sectors narrower that are wider than [`WIDEST`].
fn narrow(coord: &mut [f64], row: usize) {
    let first: Vec<f64> = coord.iter().take(row).copied().collect();
    let (mut before, mut drawn) = (first.clone(), first);
    for line in coord.chunks_exact_mut(row).skip(1) {
        for at in (1..row).step_by(3) {
            let width = (line[at] - before[at]).clamp(-WIDEST, WIDEST);
            (before[at], drawn[at]) = (line[at], drawn[at] + width);
            line[at] = drawn[at];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pillars of one ring of cells from radius 1 to 2 at these angles.
    fn ring(angles: &[f64]) -> Vec<f64> {
        let pillar = |r: f64, angle: f64| [r, angle, 10.0, r, angle, 20.0];
        let rows = angles
            .iter()
            .flat_map(|a| [pillar(1.0, *a), pillar(2.0, *a)]);
        rows.flatten().collect()
    }

    #[test]
    fn a_circle_closes() {
        let mut coord = ring(&[0.0, 90.0, 180.0, 270.0, 360.0]);
        let note = straighten(&mut coord, 1);
        assert_eq!(coord[..12], coord[48..]);
        assert_eq!(coord[..3], [1.0, 0.0, 10.0]);
        let quarter = &coord[18..21];
        assert!(quarter[0].abs() < 1e-15 && quarter[1..] == [2.0, 10.0]);
        // A square in a circle: 2 / pi of it.
        assert!(note.contains("up to 36.3 % too small"), "{note}");
    }

    #[test]
    fn a_sector_of_a_whole_circle_is_drawn_as_a_quarter() {
        let mut coord = ring(&[0.0, 360.0]);
        let note = straighten(&mut coord, 1);
        assert!((coord[13] - 1.0).abs() < 1e-15);
        assert!(note.contains("360 degrees"), "{note}");
    }
}

//! Selected cells in a picture: their edges.

use glam::DVec2;

use super::canvas::Canvas;
use super::orientation::on_screen;
use super::pen::Pen;
use crate::image::Rgb8;
use crate::model::{Grid, Ijk};
use crate::view::View;
use crate::view::surfaces::PALETTE;

/// Color of the selected cell at a place in a list of `count`, 8-bit sRGB: of few cells each has another one, the
/// colors of many, such as those of a well, run from blue to red.
pub fn mark_color(n: usize, count: usize) -> [u8; 3] {
    // Reddish purple and blue first, which stand out from most color maps.
    let order = [6, 4, 5, 2, 0, 1, 3];
    if count > order.len() {
        // Without the ends, which are too dark for dark themes.
        let part = n as f64 / (count - 1) as f64;
        return colorous::TURBO.eval_continuous(0.1 + 0.8 * part).as_array();
    }
    PALETTE[order[n % order.len()]].map(|v| (255.0 * v).round() as u8)
}

/// The edges of a cell of `grid` (the case's) as they lie in a picture of `size`; those behind the viewer are
/// left out.
pub fn cell_edges(view: &View, grid: &Grid, cell: Ijk, size: DVec2) -> Vec<[DVec2; 2]> {
    let corners = grid.hexahedron(cell).0;
    let corners = corners.map(|c| view.world.spaces.world_from_grid.transform_point3(c));
    let ends = (0..8usize).flat_map(|a| [1, 2, 4].map(|bit| (a, a | bit)));
    let edges = ends.filter(|(a, b)| a != b);
    edges
        .filter_map(|(a, b)| on_screen(view, [corners[a], corners[b]], size))
        .collect()
}

/// Draws the edges of cells, by I, J, K from 1, into a picture of a view; those outside the grid are left out.
pub fn mark_cells(picture: &mut Rgb8, view: &View, grid: &Grid, cells: &[[usize; 3]]) {
    let size = DVec2::from_array(picture.size.map(f64::from));
    let unit = Pen::unit_of(picture.size);
    let mut canvas = Canvas::new(picture.size, &mut picture.pixels);
    for (n, cell) in cells.iter().enumerate() {
        let Some(cell) = grid.dims().one_based(*cell) else {
            continue;
        };
        for line in cell_edges(view, grid, cell, size) {
            let line = line.map(|p| p.to_array());
            // A light seam keeps the line apart from what is behind it.
            canvas.line(line, [0.3 * unit; 2], [255; 3], |_, _| 0.63);
            canvas.line(
                line,
                [0.16 * unit; 2],
                mark_color(n, cells.len()),
                |_, _| 1.0,
            );
        }
    }
}

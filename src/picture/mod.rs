//! From premultiplied pixels to files and films with legend, title and axes; difference maps,
//! plots and contact sheets.

mod annotate;
mod axes;
mod canvas;
pub mod compared;
mod difference;
mod files;
pub mod film;
pub mod filming;
mod info;
mod layout;
mod legend;
mod marks;
mod orientation;
mod pen;
mod plot;
mod sheet;
mod ticks;
mod units;

#[cfg(test)]
pub(crate) use annotate::tests::view as test_view;
pub use annotate::{Annotations, Shot, finished, when};
pub use axes::CONNECTION;
pub use difference::{difference_colors, difference_picture};
pub use files::{Format, PictureError, write_exr, write_png};
pub use info::Info;
pub use layout::{LINE, Layout, LegendWidths, Length, Parts};
pub use legend::{GROUND, Key, Legend, cut};
pub use marks::{cell_edges, mark_cells, mark_color};
pub use orientation::{Area, Arrow, Orientation, Paper, Text, WellNames, on_screen, well_names};
pub use plot::{Plot, Series};
pub use sheet::{SheetError, SheetImage, contact_sheet};
pub use units::{Lengths, short_unit};

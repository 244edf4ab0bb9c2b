//! x
/// x
pub const NAMES: [&str; 1] = ["turbo"];
/// x
pub fn color_map(_: &str) -> Option<Vec<(f64, [f64; 3])>> {
    None
}
/// x
pub fn parse_color(_: &str) -> Option<[f64; 3]> {
    None
}

//! Named color maps, and colors as `#rrggbb`.

/// Names of all color maps; the default first.
pub const NAMES: [&str; 13] = [
    "turbo", "viridis", "cividis", "coolwarm", "redblue", "rainbow", "plasma", "inferno", "magma",
    "gray", "oil", "water", "gas",
];

/// Points that a smooth map is sampled at.
const SAMPLES: usize = 256;

/// The map called `name`: positions 0..1 and sRGB colors, 0..1; `None` for an unknown name.
pub fn color_map(name: &str) -> Option<Vec<(f64, [f64; 3])>> {
    Some(match name {
        "turbo" => knots(&TURBO),
        "viridis" => sampled(&colorous::VIRIDIS, false),
        "cividis" => knots(&CIVIDIS),
        "plasma" => sampled(&colorous::PLASMA, false),
        "inferno" => inferno(),
        "magma" => sampled(&colorous::MAGMA, false),
        // ColorBrewer's runs from red to blue; low values are blue here.
        "redblue" => sampled(&colorous::RED_BLUE, true),
        "coolwarm" => knots(&COOLWARM),
        "rainbow" => evenly(&RAINBOW),
        "gray" => evenly(&[[0.0; 3], [1.0; 3]]),
        "oil" => knots(&OIL),
        "water" => knots(&WATER),
        "gas" => knots(&GAS),
        _ => return None,
    })
}

/// Perceptually even from black over red to pale yellow: zero is dark, so that little stands out.
pub fn inferno() -> Vec<(f64, [f64; 3])> {
    sampled(&colorous::INFERNO, false)
}

/// A position in steps of 1/255 and a color as 0xrrggbb.
type Knot = (u8, u32);

/// Mikhailov 2019, turbo: knots of the published table of 256 colors, between which it is linear to
/// within 2 of 255. (`colorous` has the polynomial approximation, which is off by up to 32.)
const TURBO: [Knot; 33] = [
    (0, 0x30123b),
    (7, 0x38276d),
    (10, 0x3b2f80),
    (16, 0x4040a2),
    (22, 0x4451bf),
    (29, 0x4664da),
    (36, 0x4776ee),
    (42, 0x4685fa),
    (48, 0x4294ff),
    (52, 0x3d9efe),
    (60, 0x2fb2f4),
    (74, 0x1ad2d2),
    (77, 0x18d7ca),
    (85, 0x1ae4b6),
    (90, 0x22ebaa),
    (98, 0x38f491),
    (112, 0x6dfe62),
    (122, 0x92ff47),
    (129, 0xa7fc3a),
    (137, 0xbcf534),
    (146, 0xd2e935),
    (158, 0xebd339),
    (167, 0xf7c13a),
    (171, 0xfbb838),
    (177, 0xfea933),
    (186, 0xfe9029),
    (195, 0xf9751d),
    (206, 0xed5510),
    (218, 0xdc3b07),
    (228, 0xc82803),
    (237, 0xb21a01),
    (248, 0x920b01),
    (255, 0x7a0403),
];

/// Nunez, Anderton and Renslow 2018, cividis: knots as for [`TURBO`] (`colorous` is off by up to 19).
const CIVIDIS: [Knot; 18] = [
    (0, 0x00224e),
    (17, 0x002e6c),
    (22, 0x003171),
    (23, 0x013271),
    (28, 0x123570),
    (35, 0x203a6f),
    (53, 0x38476c),
    (86, 0x585e6d),
    (110, 0x6d6f72),
    (125, 0x7a7a78),
    (152, 0x938e78),
    (175, 0xaaa073),
    (203, 0xc7b767),
    (224, 0xdec958),
    (234, 0xe9d34e),
    (246, 0xf7de3e),
    (251, 0xfde334),
    (255, 0xfee838),
];

/// Moreland 2009, diverging from cool (59, 76, 192) over gray to warm (180, 4, 38): knots of his map
/// through Msh space, as for [`TURBO`].
const COOLWARM: [Knot; 18] = [
    (0, 0x3b4cc0),
    (16, 0x4e68d8),
    (37, 0x688aef),
    (49, 0x799cf8),
    (63, 0x8caffe),
    (79, 0xa2c1ff),
    (98, 0xbbd1f8),
    (114, 0xcedaeb),
    (127, 0xdcdddd),
    (141, 0xead5c9),
    (160, 0xf5c4ac),
    (167, 0xf7bca1),
    (190, 0xf59c7d),
    (211, 0xe9785d),
    (225, 0xdc5d4a),
    (239, 0xcb3e38),
    (247, 0xc0282f),
    (255, 0xb40426),
];

/// Oil saturation: water blue where there is no oil, then from green to red. No color is so dark that edges and
/// light cannot be seen on it, none so light that it is taken for paper.
const OIL: [Knot; 7] = [
    (0, 0x7fa6d3),
    (38, 0x6fb3c4),
    (77, 0x3f9e5c),
    (128, 0xb5c83a),
    (166, 0xf0c02e),
    (204, 0xee7d22),
    (255, 0xc4161c),
];

/// Water saturation: sand where there is none, then blue.
const WATER: [Knot; 5] = [
    (0, 0xd8b36a),
    (64, 0xb9c08a),
    (128, 0x74b9c4),
    (191, 0x3f86cf),
    (255, 0x1f4fa8),
];

/// Gas saturation: gray-blue where there is none, then yellow to red.
const GAS: [Knot; 6] = [
    (0, 0x93a8bd),
    (38, 0xa9b48f),
    (89, 0xe3c437),
    (140, 0xf29a2e),
    (191, 0xe35432),
    (255, 0xb3123f),
];

/// The engineers' rainbow: blue, cyan, green, yellow, red.
const RAINBOW: [[f64; 3]; 5] = [
    [0.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [0.0, 1.0, 0.0],
    [1.0, 1.0, 0.0],
    [1.0, 0.0, 0.0],
];

fn knots(knots: &[Knot]) -> Vec<(f64, [f64; 3])> {
    let point = |&(at, hex): &Knot| (f64::from(at) / 255.0, from_hex(hex));
    knots.iter().map(point).collect()
}

pub(super) fn from_hex(value: u32) -> [f64; 3] {
    [16, 8, 0].map(|shift| f64::from(value >> shift & 255) / 255.0)
}

fn evenly(colors: &[[f64; 3]]) -> Vec<(f64, [f64; 3])> {
    let last = (colors.len() - 1) as f64;
    colors
        .iter()
        .enumerate()
        .map(|(n, &c)| (n as f64 / last, c))
        .collect()
}

fn sampled(gradient: &colorous::Gradient, reversed: bool) -> Vec<(f64, [f64; 3])> {
    let colors: Vec<[f64; 3]> = (0..SAMPLES)
        .map(|n| {
            let at = if reversed { SAMPLES - 1 - n } else { n };
            let color = gradient.eval_rational(at, SAMPLES);
            [color.r, color.g, color.b].map(|v| f64::from(v) / 255.0)
        })
        .collect();
    evenly(&colors)
}

/// A color from `#rrggbb` as sRGB, 0..1.
pub fn parse_color(text: &str) -> Option<[f64; 3]> {
    let digits = text
        .strip_prefix('#')
        .filter(|d| d.len() == 6 && d.is_ascii())?;
    if !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    u32::from_str_radix(digits, 16).ok().map(from_hex)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_resolve_and_ends_are_the_published_ones() {
        for name in NAMES {
            let map = color_map(name).unwrap();
            assert!(
                map.first().unwrap().0 == 0.0 && map.last().unwrap().0 == 1.0,
                "{name}"
            );
        }
        assert!(color_map("nonsense").is_none());
        let ends = |name: &str| {
            let map = color_map(name).unwrap();
            [map[0].1, map[map.len() - 1].1].map(|c| c.map(|v| (v * 255.0).round() as u8))
        };
        // The first and last rows of the published tables.
        assert_eq!(ends("turbo"), [[48, 18, 59], [122, 4, 3]]);
        assert_eq!(ends("viridis"), [[68, 1, 84], [253, 231, 37]]);
        assert_eq!(ends("cividis"), [[0, 34, 78], [254, 232, 56]]);
        assert_eq!(ends("plasma"), [[13, 8, 135], [240, 249, 33]]);
        assert_eq!(ends("inferno"), [[0, 0, 4], [252, 255, 164]]);
        assert_eq!(ends("magma"), [[0, 0, 4], [252, 253, 191]]);
        assert_eq!(ends("coolwarm"), [[59, 76, 192], [180, 4, 38]]);
        assert_eq!(ends("rainbow"), [[0, 0, 255], [255, 0, 0]]);
        let [low, high] = ends("redblue");
        assert!(low[2] > low[0] && high[0] > high[2]);
    }

    #[test]
    fn knots_meet_the_published_tables_between_them() {
        // Rows of the published tables (counted from 0) that are no knots here.
        let rows = [
            ("turbo", 101, [67.0, 247.0, 135.0]),
            ("turbo", 200, [244.0, 102.0, 23.0]),
            ("cividis", 101, [101.0, 104.0, 112.0]),
            ("cividis", 200, [196.0, 180.0, 104.0]),
            ("coolwarm", 101, [191.0, 211.0, 246.0]),
            ("coolwarm", 200, [240.0, 139.0, 110.0]),
        ];
        let error = |name: &str, row: u32, wanted: [f64; 3]| {
            let function = crate::transfer::TransferFunction {
                color: color_map(name).unwrap(),
                opacity: vec![(0.0, 0.0)],
                range: [0.0, 1.0],
                scale: crate::transfer::Scale::Linear,
                bands: None,
                reference_length: 1.0,
            };
            let color = function.srgb(f64::from(row) / 255.0);
            let off = |c: usize| (255.0 * color[c] - wanted[c]).abs();
            off(0).max(off(1)).max(off(2))
        };
        for (name, row, wanted) in rows {
            assert!(error(name, row, wanted) < 2.0, "{name} {row}");
        }
        assert!(error("turbo", 110, rows[0].2) > 2.0);
    }

    #[test]
    fn colors_parse_or_not() {
        assert_eq!(parse_color("#ff8000"), Some([1.0, 128.0 / 255.0, 0.0]));
        for bad in [
            "", "#", "ff8000", "#ff80", "#ff80000", "#gg0000", "#é0000", "#+12345",
        ] {
            assert_eq!(parse_color(bad), None, "{bad}");
        }
    }
}

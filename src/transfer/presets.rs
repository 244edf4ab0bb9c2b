//! Named color maps, and colors as `#rrggbb`.

/// Names of all color maps; the default first.
pub const NAMES: [&str; 10] = [
    "turbo", "viridis", "cividis", "coolwarm", "redblue", "rainbow", "plasma", "inferno", "magma",
    "gray",
];

/// Points that a smooth map is sampled at.
const SAMPLES: usize = 256;

/// The map called `name`: positions 0..1 and sRGB colors, 0..1; `None` for an unknown name.
pub fn color_map(name: &str) -> Option<Vec<(f64, [f64; 3])>> {
    Some(match name {
        "turbo" => sampled(&colorous::TURBO, false),
        "viridis" => sampled(&colorous::VIRIDIS, false),
        "cividis" => sampled(&colorous::CIVIDIS, false),
        "plasma" => sampled(&colorous::PLASMA, false),
        "inferno" => sampled(&colorous::INFERNO, false),
        "magma" => sampled(&colorous::MAGMA, false),
        // ColorBrewer's runs from red to blue; low values are blue here.
        "redblue" => sampled(&colorous::RED_BLUE, true),
        "coolwarm" => evenly(&COOLWARM),
        "rainbow" => evenly(&RAINBOW),
        "gray" => evenly(&[[0.0; 3], [1.0; 3]]),
        _ => return None,
    })
}

/// Moreland 2009, diverging map from cool (59, 76, 192) over gray to warm (180, 4, 38) in Msh space,
/// at nine even positions.
const COOLWARM: [[f64; 3]; 9] = [
    [0.2298, 0.2987, 0.7537],
    [0.3836, 0.5094, 0.9174],
    [0.5543, 0.6901, 0.9955],
    [0.7205, 0.8163, 0.9792],
    [0.8654, 0.8654, 0.8654],
    [0.9592, 0.7692, 0.6789],
    [0.9582, 0.6038, 0.4819],
    [0.8690, 0.3783, 0.3003],
    [0.7057, 0.0156, 0.1502],
];

/// The engineers' rainbow: blue, cyan, green, yellow, red.
const RAINBOW: [[f64; 3]; 5] = [
    [0.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [0.0, 1.0, 0.0],
    [1.0, 1.0, 0.0],
    [1.0, 0.0, 0.0],
];

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
    let value = u32::from_str_radix(digits, 16).ok()?;
    Some([16, 8, 0].map(|shift| f64::from(value >> shift & 255) / 255.0))
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
        // matplotlib's tables of viridis, and Moreland's ends of coolwarm.
        assert_eq!(ends("viridis"), [[68, 1, 84], [253, 231, 37]]);
        assert_eq!(ends("coolwarm"), [[59, 76, 192], [180, 4, 38]]);
        assert_eq!(ends("rainbow"), [[0, 0, 255], [255, 0, 0]]);
        let [low, high] = ends("redblue");
        assert!(low[2] > low[0] && high[0] > high[2]);
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

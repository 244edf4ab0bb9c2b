//! A filter in words.

use super::Filter;

/// What a filter keeps, such as `I 3-7, SOIL 0.3 to 1`; empty of one that keeps all.
pub(super) fn words(filter: &Filter) -> String {
    let axes = [("I", filter.i), ("J", filter.j), ("K", filter.k)];
    let axes = axes.into_iter().filter_map(|(name, range)| {
        let [a, b] = range?;
        Some(match a == b {
            true => format!("{name} {a}"),
            false => format!("{name} {a}-{b}"),
        })
    });
    let properties = filter.properties.iter().map(|p| {
        let [min, max] = [p.min, p.max].map(|v| v.to_string());
        match p.min == p.max {
            true => format!("{} {min}", p.name),
            false => format!("{} {min} to {max}", p.name),
        }
    });
    axes.chain(properties).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::PropertyFilter;

    #[test]
    fn filters_are_said_as_engineers_say_them() {
        assert_eq!(words(&Filter::default()), "");
        let filter = Filter {
            i: Some([3, 7]),
            k: Some([2, 2]),
            properties: vec![PropertyFilter {
                name: "SOIL".into(),
                min: 0.3,
                max: 1.0,
            }],
            ..Filter::default()
        };
        assert_eq!(words(&filter), "I 3-7, K 2, SOIL 0.3 to 1");
    }
}

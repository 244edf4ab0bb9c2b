//! Names by patterns, as of wells: `*` stands for any letters, `?` for one, in any letter case.

/// True where a name matches a pattern.
pub fn matches(pattern: &str, name: &str) -> bool {
    let letters = |text: &str| text.to_lowercase().chars().collect::<Vec<_>>();
    let (pattern, name) = (letters(pattern), letters(name));
    // Where to go on after the last `*`, should what follows it not fit.
    let mut last: Option<(usize, usize)> = None;
    let (mut p, mut n) = (0, 0);
    while n < name.len() {
        match pattern.get(p) {
            Some('*') => {
                last = Some((p + 1, n));
                p += 1;
            }
            Some(c) if *c == '?' || *c == name[n] => (p, n) = (p + 1, n + 1),
            _ => {
                let Some((after, taken)) = last else {
                    return false;
                };
                last = Some((after, taken + 1));
                (p, n) = (after, taken + 1);
            }
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}

/// True where a name matches one of some patterns.
pub fn matches_any(patterns: &[String], name: &str) -> bool {
    patterns.iter().any(|pattern| matches(pattern, name))
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn patterns_match_names_or_not() {
        for (pattern, fitting, other) in [
            ("P1", "p1", "P12"),
            ("P*", "PROD", "OP"),
            ("*_1", "OP_1_1", "OP_12"),
            ("?P*", "OP_1", "P_1"),
            ("A*B*C", "AxBxBxC", "AxCxB"),
            ("W?", "WÄ", "W"),
        ] {
            assert!(matches(pattern, fitting), "{pattern} {fitting}");
            assert!(!matches(pattern, other), "{pattern} {other}");
        }
        assert!(!matches("", "A") && matches("", "") && matches("*", ""));
    }
}

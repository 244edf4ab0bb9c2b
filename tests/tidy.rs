//! The documents name only what exists.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use std::path::Path;

#[test]
fn paths_in_documents_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut seen = 0;
    for document in [
        "README.md",
        "docs/ARCHITECTURE.md",
        "docs/performance.md",
        "samples/README.md",
    ] {
        let text = std::fs::read_to_string(root.join(document)).unwrap();
        for quoted in text.split('`').skip(1).step_by(2) {
            let starts = [
                "src/", "shaders/", "parsers/", "samples/", "tests/", "docs/", "scripts/", ".ci/",
            ];
            let path = quoted.split_whitespace().next().unwrap_or_default();
            if starts.iter().any(|s| path.starts_with(s)) {
                assert!(root.join(path).exists(), "{document} names {path}");
                seen += 1;
            }
        }
    }
    assert!(seen > 20, "only {seen} paths were found");
}

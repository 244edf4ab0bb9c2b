//! The rooms of the library have one direction: each imports only from those before it, and within a folder no
//! files import each other in a circle.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The rooms from the ground up. `cli` is the command, which imports the library by its name.
const ROOMS: [&str; 16] = [
    "draft",
    "image",
    "model",
    "transfer",
    "case",
    "scene",
    "view",
    "export",
    "render",
    "reference",
    "picking",
    "picture",
    "session",
    "compare",
    "viewer",
    "cli",
];

/// Rooms that know less than those before them.
const STRANGERS: [(&str, &[&str]); 4] = [
    ("scene", &["model", "transfer", "case"]),
    ("reference", &["render"]),
    ("model", &["image"]),
    ("picking", &["reference"]),
];

/// Crates, and the only rooms that know them; `cli` is the command.
const CRATES: [(&str, &[&str]); 7] = [
    ("strataray_parsers", &["case", "export", "lib.rs"]),
    ("parquet", &["export"]),
    ("wgpu", &["render/gpu"]),
    ("eframe", &["viewer"]),
    ("rfd", &["viewer"]),
    ("indicatif", &["cli"]),
    ("ctrlc", &["cli"]),
];

type Module = Vec<String>;

/// The modules of a source folder and what each imports.
struct Sources {
    /// Text without comments and tests, by module.
    texts: BTreeMap<Module, String>,
    /// Names that a module passes on, and where they come from.
    passed: BTreeMap<Module, BTreeMap<String, Module>>,
}

/// An import: who, and from which module.
type Import = (Module, Module);

impl Sources {
    fn of(root: &Path) -> Self {
        let files = files(root).into_iter().filter(|f| !f.ends_with("main.rs"));
        let texts = files.filter_map(|file| {
            let module = module_of(file.strip_prefix(root).unwrap());
            let is_test = module.iter().any(|part| part == "tests");
            (!is_test).then(|| (module, plain(&std::fs::read_to_string(&file).unwrap())))
        });
        Self::with(texts.collect())
    }

    fn with(texts: BTreeMap<Module, String>) -> Self {
        let mut sources = Self {
            texts,
            passed: BTreeMap::new(),
        };
        for (module, text) in &sources.texts {
            let uses = uses(text).into_iter().filter(|(is_public, _)| *is_public);
            let passed = uses.filter_map(|(_, path)| {
                let name = path.rsplit("::").next()?.trim().to_owned();
                let (path, name) = match name.split_once(" as ") {
                    Some((_, alias)) => (path.split(" as ").next()?.trim().to_owned(), alias),
                    None => (path.clone(), name.as_str()),
                };
                Some((name.to_owned(), sources.absolute(module, &path)?))
            });
            let passed = passed.collect();
            sources.passed.insert(module.clone(), passed);
        }
        sources
    }

    /// A path as the crate's root sees it; `None` of other crates and of names in scope.
    fn absolute(&self, module: &Module, path: &str) -> Option<Module> {
        let path = path.split(" as ").next()?.trim();
        let parts: Vec<&str> = path.split("::").map(str::trim).collect();
        let up = parts.iter().take_while(|p| **p == "super").count();
        let (base, rest): (&[String], &[&str]) = match parts[0] {
            "crate" | "strataray" => (&[], &parts[1..]),
            "self" => (module, &parts[1..]),
            "super" => (module.get(..module.len().checked_sub(up)?)?, &parts[up..]),
            first => {
                let mut child = module.clone();
                child.push(first.to_owned());
                self.texts.get(&child)?;
                (module, &parts[..])
            }
        };
        Some(
            base.iter()
                .cloned()
                .chain(rest.iter().map(|p| (*p).to_owned()))
                .collect(),
        )
    }

    /// The module that holds what a path names, through all that pass it on.
    fn holder(&self, path: &[String]) -> Option<Module> {
        let mut path = path.to_vec();
        // Nothing is passed on so often.
        for _ in 0..10 {
            let most = (0..=path.len())
                .rev()
                .find(|n| self.texts.contains_key(&path[..*n]));
            let (module, rest) = path.split_at(most?);
            let next = rest.first().and_then(|name| self.passed[module].get(name));
            match next.filter(|next| **next != path) {
                None => return Some(module.to_vec()),
                Some(next) => path = next.iter().chain(&rest[1..]).cloned().collect(),
            }
        }
        None
    }

    fn imports(&self) -> BTreeSet<Import> {
        let mut all = BTreeSet::new();
        for (module, text) in &self.texts {
            let named = uses(text).into_iter().filter(|(is_public, _)| !is_public);
            let paths = named.map(|(_, path)| path).chain(paths(text));
            for path in paths.filter_map(|path| self.absolute(module, &path)) {
                let holder = self.holder(&path);
                all.extend(holder.filter(|h| h != module).map(|h| (module.clone(), h)));
            }
        }
        all
    }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let files = paths.flat_map(|path| match path.is_dir() {
        true => files(&path),
        false => vec![path],
    });
    files
        .filter(|f| f.extension().is_some_and(|e| e == "rs"))
        .collect()
}

fn module_of(file: &Path) -> Module {
    let parts = file.with_extension("");
    let mut parts: Module = parts
        .iter()
        .map(|p| p.to_string_lossy().into_owned())
        .collect();
    if parts
        .last()
        .is_some_and(|last| last == "mod" || last == "lib")
    {
        parts.pop();
    }
    parts
}

/// A text without comments and without the tests at its end.
fn plain(text: &str) -> String {
    let lines = text.lines().take_while(|line| *line != "#[cfg(test)]");
    let lines = lines.map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// The paths of `use` declarations, each name by itself, and whether they are passed on.
fn uses(text: &str) -> Vec<(bool, String)> {
    let mut all = Vec::new();
    for statement in text.split(';') {
        let Some(at) = statement.rfind("use ") else {
            continue;
        };
        let before = statement[..at]
            .rsplit('\n')
            .next()
            .unwrap_or_default()
            .trim();
        if !(before.is_empty() || before.starts_with("pub")) {
            continue;
        }
        let is_public = before.starts_with("pub");
        expand("", &statement[at + 4..], &mut |path| {
            all.push((is_public, path))
        });
    }
    all
}

/// Calls back with each name of a tree such as `a::{b, c::d}`.
fn expand(prefix: &str, tree: &str, found: &mut dyn FnMut(String)) {
    let tree = tree.trim();
    match tree
        .split_once('{')
        .filter(|(head, _)| head.is_empty() || head.ends_with("::"))
    {
        None if tree.is_empty() => {}
        None => found(
            format!("{prefix}{tree}")
                .trim_end_matches("::self")
                .to_owned(),
        ),
        Some((head, body)) => {
            let body = body.strip_suffix('}').unwrap_or(body);
            let (mut depth, mut start) = (0usize, 0usize);
            for (at, c) in body.char_indices().chain([(body.len(), ',')]) {
                match c {
                    '{' => depth += 1,
                    '}' => depth = depth.saturating_sub(1),
                    ',' if depth == 0 => {
                        expand(&format!("{prefix}{head}"), &body[start..at], found);
                        start = at + 1;
                    }
                    _ => {}
                }
            }
        }
    }
}

/// Paths in code, from the first letter of each.
fn paths(text: &str) -> Vec<String> {
    let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let words = text
        .split(|c| !is_path(c))
        .filter(|word| word.contains("::"));
    words
        .map(|word| word.trim_matches(':').to_owned())
        .filter(|w| !w.is_empty())
        .collect()
}

/// Imports that climb from a room to one above it, or to one that it must not know.
fn climbs(imports: &BTreeSet<Import>) -> Vec<String> {
    let place = |room: &str| ROOMS.iter().position(|r| *r == room);
    let is_wrong = |from: &str, to: &str| {
        let is_stranger = STRANGERS
            .iter()
            .any(|(room, others)| *room == from && others.contains(&to));
        is_stranger || place(from) < place(to)
    };
    let between = imports
        .iter()
        .filter(|(from, to)| !from.is_empty() && !to.is_empty());
    let wrong = between.filter(|(from, to)| is_wrong(&from[0], &to[0]));
    wrong
        .map(|(from, to)| format!("{} imports {}", from.join("::"), to.join("::")))
        .collect()
}

/// Circles among the entries of each folder; a module and what lies in its folder are one.
fn circles(imports: &BTreeSet<Import>) -> Vec<String> {
    let folders: BTreeSet<&[String]> = imports
        .iter()
        .flat_map(|(from, _)| (0..from.len()).map(|n| &from[..n]))
        .collect();
    let mut found = Vec::new();
    for folder in folders {
        let depth = folder.len();
        let inside = |m: &Module| m.len() > depth && m.starts_with(folder);
        let inner = imports
            .iter()
            .filter(|(from, to)| inside(from) && inside(to));
        let mut next: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        for (from, to) in inner.filter(|(from, to)| from[depth] != to[depth]) {
            next.entry(&from[depth]).or_default().insert(&to[depth]);
        }
        // Whoever imports only from those without imports leaves, until nobody does.
        loop {
            let left: BTreeSet<&str> = next.keys().copied().collect();
            next.values_mut()
                .for_each(|to| to.retain(|t| left.contains(t)));
            let count = next.len();
            next.retain(|_, to| !to.is_empty());
            if next.len() == count {
                break;
            }
        }
        if !next.is_empty() {
            found.push(format!("{}: {next:?}", folder.join("::")));
        }
    }
    found
}

fn sources() -> Sources {
    Sources::of(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"))
}

#[test]
fn rooms_have_one_direction() {
    let sources = sources();
    for module in sources.texts.keys().filter(|m| !m.is_empty()) {
        assert!(
            ROOMS.contains(&module[0].as_str()),
            "{module:?} is in no known room"
        );
    }
    let imports = sources.imports();
    assert!(
        imports.len() > 500,
        "only {} imports were found",
        imports.len()
    );
    assert_eq!(climbs(&imports), Vec::<String>::new());
    // Whoever wants images knows the contract, and no executor; nor do executors, and what they share, know others.
    for executor in ["gpu", "cpu"] {
        let executor = ["render".to_owned(), executor.to_owned()];
        let stranger =
            |from: &Module| from[0] != "render" || (from.len() > 1 && !from.starts_with(&executor));
        let knows = |(from, to): &&Import| to.starts_with(&executor) && stranger(from);
        assert_eq!(imports.iter().find(knows), None);
    }
    assert_eq!(circles(&imports), Vec::<String>::new());
}

#[test]
fn crates_stay_in_their_rooms() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut seen = 0;
    for file in files(&root) {
        let text = plain(&std::fs::read_to_string(&file).unwrap());
        let place = file.strip_prefix(&root).unwrap();
        for (name, homes) in CRATES {
            let names = uses(&text)
                .into_iter()
                .map(|(_, path)| path)
                .chain(paths(&text));
            if names
                .into_iter()
                .any(|path| path.split("::").next() == Some(name))
            {
                assert!(
                    homes.iter().any(|home| place.starts_with(home)),
                    "{} knows {name}",
                    place.display()
                );
                seen += 1;
            }
        }
    }
    assert!(seen > 60, "only {seen} files with these crates were found");
}

/// The twin: what climbs, and what goes in a circle, is noticed, directly or through what passes it on.
#[test]
fn what_climbs_is_noticed() {
    let module = |path: &str| -> Module { path.split("::").map(str::to_owned).collect() };
    let sources = |files: &[(&str, &str)]| {
        let texts = files.iter().map(|(path, text)| (module(path), plain(text)));
        Sources::with(texts.collect()).imports()
    };
    let good = [
        ("model", "mod grid;\npub use grid::Grid;"),
        ("model::grid", "pub struct Grid;"),
        (
            "view",
            "use crate::model::{self, Grid};\nmod camera;\nmod look;",
        ),
        ("view::camera", "pub struct Camera;"),
        ("view::look", "use super::camera::Camera;"),
    ];
    assert!(climbs(&sources(&good)).is_empty() && circles(&sources(&good)).is_empty());
    let mut climbing = good;
    climbing[1].1 = "fn f() -> crate::view::camera::Camera { todo!() }";
    assert_eq!(
        climbs(&sources(&climbing)),
        ["model::grid imports view::camera"]
    );
    let mut round = good;
    round[3].1 = "use crate::view::look::Look;";
    assert_eq!(circles(&sources(&round)).len(), 1);
    // In a comment or a test it is none.
    let mut said = good;
    said[3].1 =
        "// use crate::view::look::Look;\n#[cfg(test)]\nmod tests { use crate::viewer::Window; }";
    assert!(circles(&sources(&said)).is_empty() && climbs(&sources(&said)).is_empty());
}

//! What a path that someone typed or dropped means: a case, a folder with several, or neither.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::case::load;

/// What a path means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Meaning {
    /// A case: one of its files, its base name, or a folder with one.
    Case(PathBuf),
    /// The cases of a folder that has several.
    Several(Vec<PathBuf>),
    /// Neither; the sentence says so.
    Nothing(String),
}

/// Endings of files that hold a grid, and behind these of regular volumes; of a case with more than one of them the first
/// counts.
const GRIDS: [&str; 15] = [
    "EGRID", "FEGRID", "GRID", "FGRID", "GRDECL", "ROFF", "EPC", "DATA", "SGY", "SEGY", "NRRD",
    "NHDR", "MHA", "MHD", "VTI",
];
/// How many of them are of grids.
const OF_GRIDS: usize = 8;
/// Bytes of a text file that is searched for a grid, at most; a larger one is taken to have one.
const MOST_SEARCHED: u64 = 16 << 20;
/// Entries that are offered while a path is typed, at most.
const MOST_OFFERED: usize = 200;

/// A path as typed, `~` being the user's folder.
pub fn expanded(path: &str) -> PathBuf {
    let path = path.trim();
    let home = std::env::var_os("HOME").or_else(|| std::env::var_os("USERPROFILE"));
    let rest = match path {
        "~" => Some(""),
        _ => path.strip_prefix("~/"),
    };
    match (rest, home) {
        (Some(rest), Some(home)) => PathBuf::from(home).join(rest),
        _ => PathBuf::from(path),
    }
}

/// What a path means.
pub fn meaning(path: &Path) -> Meaning {
    if path.is_dir() {
        let mut cases = of_folder(path);
        return match cases.len() {
            0 => Meaning::Nothing(format!("there is no case in {}", path.display())),
            1 => Meaning::Case(cases.remove(0)),
            _ => Meaning::Several(cases),
        };
    }
    if path.is_file() {
        return Meaning::Case(path.to_owned());
    }
    let name = path.file_name().and_then(|n| n.to_str());
    let is_named = |case: &PathBuf| {
        let stem = case.file_stem().and_then(|s| s.to_str());
        stem.zip(name)
            .is_some_and(|(s, n)| s.eq_ignore_ascii_case(n))
    };
    let case = in_folder(&folder_of(path)).into_iter().find(is_named);
    case.map_or_else(
        || Meaning::Nothing(format!("there is no case {}", path.display())),
        Meaning::Case,
    )
}

/// The cases of a folder. Where there are cases that were run, text files with grids are parts of their decks; where
/// there are none, those without a grid are left out.
fn of_folder(folder: &Path) -> Vec<PathBuf> {
    let mut cases = in_folder(folder);
    let is_text = |path: &PathBuf| has_ending(path, "GRDECL");
    let is_volume = |path: &PathBuf| GRIDS[OF_GRIDS..].iter().any(|g| has_ending(path, g));
    let was_run = |path: &PathBuf| !is_text(path) && !has_ending(path, "DATA") && !is_volume(path);
    let were_run = cases.iter().any(was_run);
    let is_large = |path: &PathBuf| path.metadata().is_ok_and(|m| m.len() > MOST_SEARCHED);
    let is_grid = |path: &PathBuf| is_large(path) || load::is_case(path);
    cases.retain(|path| !is_text(path) || !were_run && is_grid(path));
    cases
}

fn has_ending(path: &Path, wanted: &str) -> bool {
    let ending = path.extension().and_then(|e| e.to_str());
    ending.is_some_and(|e| e.eq_ignore_ascii_case(wanted))
}

/// The grid of each case in a folder, in the order of their names.
pub fn in_folder(folder: &Path) -> Vec<PathBuf> {
    let mut cases: BTreeMap<String, (usize, PathBuf)> = BTreeMap::new();
    for file in entries(folder).filter(|p| p.is_file()) {
        let rank = GRIDS.iter().position(|g| has_ending(&file, g));
        let (Some(rank), Some(stem)) = (rank, file.file_stem()) else {
            continue;
        };
        let name = stem.to_string_lossy().to_uppercase();
        let known = cases.entry(name).or_insert((rank, file.clone()));
        if rank < known.0 {
            *known = (rank, file);
        }
    }
    cases.into_values().map(|(_, file)| file).collect()
}

/// Folders and cases that what was typed so far may go on with.
pub fn offered(path: &Path, typed: &str) -> Vec<PathBuf> {
    let is_whole = typed.is_empty() || typed.ends_with(std::path::is_separator) || path.is_dir();
    let (folder, begin) = match is_whole {
        true => (path.to_owned(), String::new()),
        false => {
            let begin = path.file_name().unwrap_or_default().to_string_lossy();
            (folder_of(path), begin.to_lowercase())
        }
    };
    let begins = |p: &PathBuf| {
        let name = p.file_name().unwrap_or_default().to_string_lossy();
        name.to_lowercase().starts_with(&begin) && !name.starts_with('.')
    };
    let mut folders: Vec<PathBuf> = entries(&folder).filter(|p| p.is_dir()).collect();
    folders.sort();
    let all = in_folder(&folder).into_iter().chain(folders);
    all.filter(begins).take(MOST_OFFERED).collect()
}

fn entries(folder: &Path) -> impl Iterator<Item = PathBuf> {
    let folder = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    let list = std::fs::read_dir(folder).into_iter().flatten();
    list.flatten().map(|entry| entry.path())
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().map(Path::to_owned).unwrap_or_default()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn paths_mean_files_base_names_and_folders() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let make = |name: &str| std::fs::write(at(name), "").unwrap();
        assert!(matches!(meaning(folder.path()), Meaning::Nothing(why) if why.contains("no case")));
        make("A.EGRID");
        make("A.DATA");
        make("A.UNRST");
        make("readme.txt");
        assert_eq!(meaning(folder.path()), Meaning::Case(at("A.EGRID")));
        // Text files beside a case that was run are parts of decks.
        make("b.grdecl");
        assert_eq!(meaning(folder.path()), Meaning::Case(at("A.EGRID")));
        make("d.data");
        let both = vec![at("A.EGRID"), at("d.data")];
        assert_eq!(meaning(folder.path()), Meaning::Several(both));
        assert_eq!(meaning(&at("a")), Meaning::Case(at("A.EGRID")));
        assert_eq!(meaning(&at("B")), Meaning::Case(at("b.grdecl")));
        assert_eq!(meaning(&at("A.UNRST")), Meaning::Case(at("A.UNRST")));
        // Of one name the grid goes before the volume, and a volume alone is a case.
        make("A.nrrd");
        assert_eq!(meaning(&at("a")), Meaning::Case(at("A.EGRID")));
        make("cube.segy");
        assert_eq!(meaning(&at("cube")), Meaning::Case(at("cube.segy")));
        std::fs::remove_file(at("cube.segy")).unwrap();
        assert!(matches!(meaning(&at("C")), Meaning::Nothing(_)));
        assert!(matches!(meaning(&at("no/C")), Meaning::Nothing(_)));
        std::fs::create_dir(at("beyond")).unwrap();
        let typed = |text: &str| offered(&at(text), text);
        assert_eq!(typed("b"), [at("b.grdecl"), at("beyond")]);
        assert_eq!(offered(folder.path(), "").len(), 4);
        assert!(typed("x").is_empty());
    }

    #[test]
    fn text_files_with_a_grid_are_cases_where_none_was_run() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("poro.grdecl"), "PORO\n 8*0.2 /\n").unwrap();
        assert!(matches!(meaning(folder.path()), Meaning::Nothing(_)));
        let grid = "SPECGRID\n 2 2 2 1 F /\nCOORD\n 54*0 /\nZCORN\n 64*1000 /\n";
        std::fs::write(at("grid.grdecl"), grid).unwrap();
        assert_eq!(meaning(folder.path()), Meaning::Case(at("grid.grdecl")));
    }

    #[test]
    fn a_tilde_is_the_users_folder() {
        let Some(home) = std::env::var_os("HOME") else {
            return;
        };
        let home = PathBuf::from(home);
        assert_eq!(expanded("~"), home);
        assert_eq!(expanded(" ~/a b "), home.join("a b"));
        assert_eq!(expanded("~a"), PathBuf::from("~a"));
    }
}

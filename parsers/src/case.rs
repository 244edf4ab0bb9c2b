//! Finds the files that belong to a case, from any of them or the base name.

use std::path::{Path, PathBuf};

use crate::deck::Schedule;
use crate::error::{At, ErrorKind, ParseError};
use crate::paths;
use crate::records::Form;
use crate::resqml::is_package;
use crate::volume;

/// Where the grid is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum GridSource {
    /// An EGRID or legacy GRID file, binary or formatted.
    Egrid(PathBuf),
    /// A text deck or grid file: corner-point or block-centered.
    Deck(PathBuf),
    /// A ROFF file, binary or text.
    Roff(PathBuf),
    /// A RESQML package, with its properties and time steps.
    Resqml(PathBuf),
    /// A regular volume: seismic, or an image.
    Volume(PathBuf),
}

/// Where the time steps are.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum RestartSource {
    /// There are none.
    #[default]
    None,
    /// One file with all steps.
    Unified(PathBuf),
    /// One file per step, with its report number, rising.
    Separate(Vec<(u32, PathBuf)>),
    /// Several of them, in the order in which they were named: a run that was continued in others.
    Several(Vec<RestartSource>),
}

/// Where the curves over time are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SummarySource {
    /// All of them in one file.
    Unified {
        /// SMSPEC or FSMSPEC: what the vectors are.
        spec: PathBuf,
        /// UNSMRY or FUNSMRY: their values.
        data: PathBuf,
    },
    /// One file of values per report.
    Separate {
        /// As above.
        spec: PathBuf,
        /// S0001 or A0001 and so on, with their numbers, rising.
        data: Vec<(u32, PathBuf)>,
    },
    /// ESMRY: both in one file.
    Extended(PathBuf),
}

/// The files of a case.
#[derive(Debug, Clone)]
pub struct CaseFiles {
    /// Base name.
    pub name: String,
    /// Geometry.
    pub grid: GridSource,
    /// A deck beside an EGRID file, which has what that lacks, such as FAULTS.
    pub deck: Option<PathBuf>,
    /// Text files that were added by hand: properties, faults and what else goes on where the grid's text ends.
    pub added: Vec<PathBuf>,
    /// Decks, and parts of them, that may say something of wells.
    pub schedules: Vec<PathBuf>,
    /// Files with paths of wells, added by hand.
    pub paths: Vec<PathBuf>,
    /// ROFF files of properties: those beside a ROFF grid whose names begin with its own and `--`, and those added by hand.
    pub roff: Vec<PathBuf>,
    /// Volumes on the lattice of another one, added by hand.
    pub volumes: Vec<PathBuf>,
    /// Static properties.
    pub init: Option<PathBuf>,
    /// Time steps.
    pub restart: RestartSource,
    /// Curves over time.
    pub summary: Option<SummarySource>,
    /// Files that belong to the case and are not read, with the reason.
    pub not_read: Vec<(PathBuf, &'static str)>,
}

impl CaseFiles {
    /// A grid with its own values: what lies beside it is of another one.
    fn alone(name: String, grid: GridSource) -> Self {
        Self {
            name,
            grid,
            deck: None,
            added: Vec::new(),
            schedules: Vec::new(),
            paths: Vec::new(),
            roff: Vec::new(),
            volumes: Vec::new(),
            init: None,
            restart: RestartSource::None,
            summary: None,
            not_read: Vec::new(),
        }
    }
}

/// What an extension stands for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    Egrid,
    Init,
    Unified,
    Separate(u32),
    Deck,
    Text,
    /// A part of a deck about wells and time.
    Schedule,
    /// Paths of wells.
    Paths,
    Roff,
    Resqml,
    Volume,
    /// Curves over time, which [`find_summary`] finds.
    Summary(SummaryPart),
}

/// A file of curves over time.
#[derive(Clone, Copy, PartialEq, Eq)]
enum SummaryPart {
    Spec,
    Unified,
    Separate(u32),
    Extended,
}

fn role(path: &Path) -> Option<Role> {
    let extension = path.extension()?.to_str()?.to_ascii_uppercase();
    let numbered = |letter: char| {
        extension
            .strip_prefix(letter)
            .filter(|d| d.len() >= 4 && d.bytes().all(|b| b.is_ascii_digit()))?
            .parse()
            .ok()
    };
    Some(match extension.as_str() {
        "EGRID" | "FEGRID" => Role::Egrid,
        "INIT" | "FINIT" => Role::Init,
        "UNRST" | "FUNRST" => Role::Unified,
        "DATA" => Role::Deck,
        "SMSPEC" | "FSMSPEC" => Role::Summary(SummaryPart::Spec),
        "UNSMRY" | "FUNSMRY" => Role::Summary(SummaryPart::Unified),
        "ESMRY" => Role::Summary(SummaryPart::Extended),
        "GRDECL" => Role::Text,
        "SCH" => Role::Schedule,
        "ROFF" | "ROFFBIN" | "ROFFASC" => Role::Roff,
        "EPC" => Role::Resqml,
        "SGY" | "SEGY" | "NRRD" | "NHDR" | "MHA" | "MHD" | "VTI" => Role::Volume,
        // Text grids are called .grid too.
        "GRID" if form(path).is_none() => Role::Text,
        "GRID" | "FGRID" => Role::Egrid,
        _ => match numbered('X').or_else(|| numbered('F')) {
            Some(report) => Role::Separate(report),
            None => {
                let report = numbered('S').or_else(|| numbered('A'))?;
                Role::Summary(SummaryPart::Separate(report))
            }
        },
    })
}

/// Which of several files of one role is preferred: EGRID before GRID, which has less, and binary before formatted.
fn rank(path: &Path) -> usize {
    let extension = path.extension().and_then(|e| e.to_str());
    let extension = extension.unwrap_or_default().to_ascii_uppercase();
    let is_legacy = matches!(extension.as_str(), "GRID" | "FGRID");
    // A0001 is the formatted S0001.
    2 * usize::from(is_legacy) + usize::from(extension.starts_with(['F', 'A']))
}

/// The form of a file of arrays; `None` for other files.
fn form(path: &Path) -> Option<Form> {
    Form::of(&start(path, 64)?)
}

/// The first bytes of a file.
fn start(path: &Path, count: u64) -> Option<Vec<u8>> {
    let mut start = Vec::new();
    let file = std::fs::File::open(path).ok()?;
    std::io::Read::read_to_end(&mut std::io::Read::take(file, count), &mut start).ok()?;
    Some(start)
}

/// True for a file that begins as ROFF files do.
fn is_roff(path: &Path) -> bool {
    start(path, 64).is_some_and(|start| {
        let text = String::from_utf8_lossy(&start);
        text.contains("roff-bin") || text.contains("roff-asc")
    })
}

/// Bytes by which text is told from text, at most.
const SNIFFED: u64 = 1 << 16;
/// Endings that promise paths of wells.
const PATH_ENDINGS: [&str; 4] = ["DEV", "WELLPATH", "TRAJ", "RMSWELL"];

/// What text that is named by the user, and not by an ending of a deck, is.
fn text_role(path: &Path) -> Role {
    let start = start(path, SNIFFED).unwrap_or_default();
    let ending = path.extension().and_then(|ending| ending.to_str());
    let ending = ending.unwrap_or_default().to_ascii_uppercase();
    match () {
        () if paths::begin(&start, PATH_ENDINGS.contains(&ending.as_str())) => Role::Paths,
        () if Schedule::begins(&start) => Role::Schedule,
        () => Role::Text,
    }
}

/// What the content of the file named by the user shows, where its extension says nothing sure.
fn sniff(path: &Path) -> Role {
    match role(path) {
        None | Some(Role::Text) if form(path).is_some() => Role::Egrid,
        None | Some(Role::Text) if is_roff(path) => Role::Roff,
        None if is_package(path) => Role::Resqml,
        None if volume::is_volume(path) => Role::Volume,
        None | Some(Role::Text) => text_role(path),
        Some(role) => role,
    }
}

/// Finds the case that `path` names: one of its files, its base name without extension, or a folder with one
/// EGRID file.
///
/// A `.grdecl` file named by the user is the grid itself; a file with an unknown extension is taken
/// for an EGRID, a volume or a text grid by its first bytes. EGRID goes before decks, grids before volumes, unified
/// before separate restarts, and what the user named before all.
///
/// # Errors
/// When no grid is found; the sentence says what was looked for.
pub fn find(path: &Path) -> Result<CaseFiles, ParseError> {
    if let Some(only) = only_grid(path) {
        return find(&only);
    }
    let named = path.is_file().then(|| sniff(path));
    if let Some(error) = without_grid(path, named) {
        return Err(error);
    }
    let (stem, files) = family(path, named)?;
    let first = |wanted: Role| {
        let file = files.iter().find(|(_, r)| *r == wanted);
        file.map(|(p, _)| p.clone())
    };
    if path.is_dir() && files.is_empty() {
        let message = "is a folder with no case in it, or several; name one of its files";
        return Err(not_found(path, message));
    }
    if !path.exists() && !files.is_empty() && role(path).is_some_and(|r| first(r).is_none()) {
        let others: Vec<_> = files
            .iter()
            .take(3)
            .map(|(p, _)| p.display().to_string())
            .collect();
        let message = format!("there is no such file; the case has {}", others.join(", "));
        return Err(not_found(path, message));
    }
    let grid = match named {
        Some(Role::Text) => Some(GridSource::Deck(path.to_owned())),
        Some(Role::Egrid) => Some(GridSource::Egrid(path.to_owned())),
        Some(Role::Roff) => Some(GridSource::Roff(path.to_owned())),
        Some(Role::Resqml) => Some(GridSource::Resqml(path.to_owned())),
        Some(Role::Volume) => Some(GridSource::Volume(path.to_owned())),
        _ => first(Role::Egrid).map(GridSource::Egrid),
    };
    let deck = first(Role::Deck).or_else(|| first(Role::Text));
    let roff = || first(Role::Roff).map(GridSource::Roff);
    let resqml = || first(Role::Resqml).map(GridSource::Resqml);
    let Some(grid) = grid
        .or_else(|| deck.clone().map(GridSource::Deck))
        .or_else(roff)
        .or_else(resqml)
        .or_else(|| first(Role::Volume).map(GridSource::Volume))
    else {
        return Err(no_grid(path, &stem, &files));
    };
    if matches!(grid, GridSource::Volume(_)) {
        return Ok(CaseFiles::alone(stem, grid));
    }
    let schedules = first(Role::Deck).filter(|schedule| match &grid {
        GridSource::Deck(deck) => schedule == deck,
        GridSource::Roff(_) => false,
        _ => true,
    });
    let deck = deck.filter(|_| matches!(grid, GridSource::Egrid(_)));
    let is_resqml = matches!(grid, GridSource::Resqml(_));
    let other_package = files
        .iter()
        .filter(|(_, r)| !is_resqml && *r == Role::Resqml);
    let not_read =
        other_package.map(|(p, _)| (p.clone(), "it has a grid of its own; open it by itself"));
    Ok(CaseFiles {
        roff: match &grid {
            GridSource::Roff(grid) => properties_beside(grid),
            _ => Vec::new(),
        },
        name: stem,
        grid,
        deck,
        added: Vec::new(),
        schedules: schedules.into_iter().collect(),
        paths: Vec::new(),
        volumes: Vec::new(),
        // A package has properties and steps of its own.
        init: first(Role::Init).filter(|_| !is_resqml),
        restart: if is_resqml {
            RestartSource::None
        } else {
            restart_of(&files, named)
        },
        summary: summary_of(&files, named),
        not_read: not_read.collect(),
    })
}

/// The restart among the files of a case; `named` is what the user named of them.
fn restart_of(files: &[(PathBuf, Role)], named: Option<Role>) -> RestartSource {
    let mut separate: Vec<(u32, PathBuf)> = Vec::new();
    for (file, role) in files {
        if let Role::Separate(report) = role
            && !separate.iter().any(|s| s.0 == *report)
        {
            separate.push((*report, file.clone()));
        }
    }
    separate.sort();
    let mut unified = files.iter().filter(|(_, role)| *role == Role::Unified);
    match unified.next() {
        Some((unified, _)) if !matches!(named, Some(Role::Separate(_))) => {
            RestartSource::Unified(unified.clone())
        }
        _ if separate.is_empty() => RestartSource::None,
        _ => RestartSource::Separate(separate),
    }
}

/// Why a file that belongs to a case cannot be one.
fn without_grid(path: &Path, role: Option<Role>) -> Option<ParseError> {
    let what = match role? {
        Role::Paths => "paths of wells",
        Role::Schedule => "a schedule of wells",
        _ => return None,
    };
    let message = format!("has {what} and no grid; add it to a case, as by --with");
    let kind = ErrorKind::Unsupported;
    Some(ParseError::of(kind, path, At::File, "", message))
}

/// As [`find`], with files added by hand to what is found: text beside the grid, an INIT, restart or summary of another
/// name.
///
/// What is added takes the place of what was found, which is among what is not read then; several restarts are kept side by
/// side.
///
/// # Errors
/// As [`find`]; and when an added file is not there or can be no part of a case.
pub fn find_with(path: &Path, with: &[PathBuf]) -> Result<CaseFiles, ParseError> {
    let mut files = find(path)?;
    let mut restarts: Vec<RestartSource> = Vec::new();
    let found = (files.init.clone(), files.restart.clone());
    for added in with {
        if !added.is_file() {
            return Err(not_found(added, "there is no such file"));
        }
        let refuse =
            |message: &str| ParseError::of(ErrorKind::Unsupported, added, At::File, "", message);
        match sniff(added) {
            Role::Deck => {
                files.added.push(added.clone());
                files.schedules.push(added.clone());
            }
            Role::Text => files.added.push(added.clone()),
            Role::Schedule => files.schedules.push(added.clone()),
            Role::Paths => files.paths.push(added.clone()),
            Role::Roff => files.roff.push(added.clone()),
            Role::Init => files.init = Some(added.clone()),
            Role::Unified => restarts.push(RestartSource::Unified(added.clone())),
            Role::Separate(report) => add_separate(&mut restarts, report, added),
            Role::Egrid | Role::Resqml => {
                return Err(refuse(
                    "is a grid of its own and cannot be added to another one",
                ));
            }
            Role::Volume if matches!(files.grid, GridSource::Volume(_)) => {
                files.volumes.push(added.clone());
            }
            Role::Volume => {
                return Err(refuse(
                    "is a regular volume and can be added to another volume alone; open it by itself",
                ));
            }
            Role::Summary(_) => files.summary = Some(find_summary(added)?),
        }
    }
    files.restart = match restarts.len() {
        0 => files.restart,
        1 => restarts.swap_remove(0),
        _ => RestartSource::Several(restarts),
    };
    let replaced = found.0.filter(|init| files.init.as_ref() != Some(init));
    let why = "an INIT of another name was added";
    files.not_read.extend(replaced.map(|init| (init, why)));
    let kept = restart_files(&files.restart);
    let replaced = restart_files(&found.1).into_iter();
    let mut replaced = replaced.filter(|file| !kept.contains(file));
    let why = "time steps of another name were added; add this file too to see both";
    files
        .not_read
        .extend(replaced.next().map(|file| (file, why)));
    Ok(files)
}

/// Adds a file of one step to the others of its run, which have its folder and its name but for the ending.
fn add_separate(restarts: &mut Vec<RestartSource>, report: u32, added: &Path) {
    let run = |path: &Path| path.with_extension("");
    let known = restarts.iter_mut().find_map(|source| match source {
        RestartSource::Separate(files) => {
            let is_of = files.iter().any(|(_, file)| run(file) == run(added));
            is_of.then_some(files)
        }
        _ => None,
    });
    match known {
        Some(files) => {
            files.push((report, added.to_owned()));
            files.sort();
        }
        None => restarts.push(RestartSource::Separate(vec![(report, added.to_owned())])),
    }
}

/// The files of restarts.
fn restart_files(source: &RestartSource) -> Vec<PathBuf> {
    match source {
        RestartSource::None => Vec::new(),
        RestartSource::Unified(path) => vec![path.clone()],
        RestartSource::Separate(files) => files.iter().map(|(_, path)| path.clone()).collect(),
        RestartSource::Several(sources) => sources.iter().flat_map(restart_files).collect(),
    }
}

/// Finds the summary files of the case that `path` names, as [`find`] does; the case needs no grid.
///
/// Of several forms the unified one goes first, then one file per report, then ESMRY, and what the user named before
/// all.
///
/// # Errors
/// When there are none; the sentence says what was looked for.
pub fn find_summary(path: &Path) -> Result<SummarySource, ParseError> {
    let only = only_grid(path);
    let path = only.as_deref().unwrap_or(path);
    let named = path.is_file().then(|| role(path)).flatten();
    let (stem, files) = family(path, named)?;
    summary_of(&files, named).ok_or_else(|| {
        let message = format!(
            "this case has no summary: looked for {stem}.SMSPEC with {stem}.UNSMRY or {stem}.S0001, and {stem}.ESMRY"
        );
        not_found(path, message)
    })
}

/// The summary among the files of a case; `named` is what the user named of them.
fn summary_of(files: &[(PathBuf, Role)], named: Option<Role>) -> Option<SummarySource> {
    let first = |wanted: SummaryPart| {
        let file = files.iter().find(|(_, r)| *r == Role::Summary(wanted));
        file.map(|(p, _)| p.clone())
    };
    let mut separate: Vec<(u32, PathBuf)> = Vec::new();
    for (file, role) in files {
        if let Role::Summary(SummaryPart::Separate(report)) = role
            && !separate.iter().any(|s| s.0 == *report)
        {
            separate.push((*report, file.clone()));
        }
    }
    separate.sort();
    let is_named = |part: fn(SummaryPart) -> bool| match named {
        Some(Role::Summary(named)) => part(named),
        _ => false,
    };
    let extended = first(SummaryPart::Extended);
    if let (Some(file), true) = (&extended, is_named(|p| p == SummaryPart::Extended)) {
        return Some(SummarySource::Extended(file.clone()));
    }
    let wants_separate = is_named(|p| matches!(p, SummaryPart::Separate(_)));
    let unified = first(SummaryPart::Unified).filter(|_| !wants_separate);
    match (first(SummaryPart::Spec), unified, extended) {
        (Some(spec), Some(data), _) => Some(SummarySource::Unified { spec, data }),
        (Some(spec), None, _) if !separate.is_empty() => Some(SummarySource::Separate {
            spec,
            data: separate,
        }),
        (_, _, extended) => extended.map(SummarySource::Extended),
    }
}

/// The grid of a folder that has one case.
fn only_grid(folder: &Path) -> Option<PathBuf> {
    let files = std::fs::read_dir(folder).ok()?.flatten().map(|e| e.path());
    let mut grids: Vec<PathBuf> = files.filter(|p| role(p) == Some(Role::Egrid)).collect();
    grids.sort_by_key(|p| rank(p));
    let first = grids.first()?;
    let same = grids.iter().all(|p| p.file_stem() == first.file_stem());
    same.then(|| first.clone())
}

/// The stem of a case and its files: first what the user named, then those of exactly this letter case, then by
/// [`rank`].
fn family(path: &Path, named: Option<Role>) -> Result<(String, Vec<(PathBuf, Role)>), ParseError> {
    let stem = match named.or_else(|| role(path)) {
        Some(_) => path.file_stem(),
        None => path.file_name(),
    };
    // A name that is not UTF-8 is compared and told by what of it can be read.
    let stem = stem.map(|s| s.to_string_lossy().into_owned());
    let stem = stem.unwrap_or_default();
    let mut files = siblings(path, &stem)?;
    let exact = |p: &Path| p.file_stem().is_some_and(|s| s.to_string_lossy() == stem);
    files.sort_by_key(|(p, _)| {
        let is_other = p.file_name() != path.file_name();
        (is_other, !exact(p), rank(p), p.clone())
    });
    Ok((stem, files))
}

/// Files beside `path` with the same stem, whatever the letter case, and a known extension.
fn siblings(path: &Path, stem: &str) -> Result<Vec<(PathBuf, Role)>, ParseError> {
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let list =
        std::fs::read_dir(folder).map_err(|e| ParseError::io(path, "cannot open its folder", e))?;
    let shown = |entry: std::fs::DirEntry| {
        if folder == Path::new(".") && path.parent().is_none_or(|p| p.as_os_str().is_empty()) {
            PathBuf::from(entry.file_name())
        } else {
            entry.path()
        }
    };
    let same_stem = |p: &Path| {
        let this = p.file_stem().map(|s| s.to_string_lossy());
        this.is_some_and(|s| s.eq_ignore_ascii_case(stem))
    };
    let files = list.flatten().map(shown).filter(|p| same_stem(p));
    Ok(files.filter_map(|p| role(&p).map(|r| (p, r))).collect())
}

/// ROFF files of properties beside a ROFF grid: `geogrid--poro.roff` beside `geogrid.roff`.
fn properties_beside(grid: &Path) -> Vec<PathBuf> {
    let Some(stem) = grid.file_stem().and_then(|s| s.to_str()) else {
        return Vec::new();
    };
    let start = format!("{stem}--");
    let folder = grid.parent().filter(|p| !p.as_os_str().is_empty());
    let files = std::fs::read_dir(folder.unwrap_or_else(|| Path::new(".")));
    let files = files.into_iter().flatten().flatten();
    let is_property = |name: &std::ffi::OsString| {
        let name = name.to_str().unwrap_or_default();
        name.starts_with(&start) && role(Path::new(name)) == Some(Role::Roff)
    };
    let names = files.map(|entry| entry.file_name()).filter(is_property);
    let mut found: Vec<PathBuf> = names.map(|name| grid.with_file_name(name)).collect();
    found.sort();
    found
}

fn no_grid(path: &Path, stem: &str, files: &[(PathBuf, Role)]) -> ParseError {
    let found = if path.exists() || !files.is_empty() {
        "this case has no grid"
    } else {
        "there is no such case"
    };
    let message = format!(
        "{found}: looked for {stem}.EGRID, {stem}.DATA, {stem}.GRDECL, {stem}.ROFF and {stem}.EPC"
    );
    ParseError::of(ErrorKind::NotFound, path, At::File, "", message)
}

fn not_found(path: &Path, message: impl Into<String>) -> ParseError {
    ParseError::of(ErrorKind::NotFound, path, At::File, "", message)
}

//! Takes in order what the SCHEDULE sections of decks say of wells.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::super::files::DeckFiles;
use super::super::include::named_file;
use super::super::lexer::{Cursor, Item, Keyword, Mistake, keyword, line_end};
use super::super::skip::skip_records;
use super::super::source::Source;
use super::super::walk::{Flow, Visitor, Walk};
use super::records::{self, is_meant, text};
use super::{Change, Schedule, What};
use crate::error::{ErrorKind, ParseError, Warnings};

/// When time begins where nobody says it.
const START: &str = "1983-01-01";
/// Layers that wells are connected to and other changes of wells, at most.
const MOST_CHANGES: usize = 3_000_000;

/// Keywords whose records are read one by one, up to an empty one.
const LISTS: &[&str] = &[
    "WELSPECS", "WELSPECL", "COMPDAT", "COMPDATL", "WCONPROD", "WCONHIST", "WCONINJE", "WCONINJH",
    "WCONINJ", "WELOPEN", "WELTARG", "WLIST", "DATES",
];

/// Keywords about wells that are not evaluated.
const NOT_EVALUATED: &[&str] = &[
    "ACTION", "ACTIONG", "ACTIONR", "ACTIONS", "ACTIONW", "ACTIONX", "COMPDATM", "COMPTRAJ",
    "PYACTION", "UDQ", "WELLSPEC", "WELLCOMP", "WELOPENL", "WELTRAJ",
];

/// Where the walk is.
#[derive(Clone, PartialEq, Eq)]
enum Section {
    /// Before any section, as in a file that SCHEDULE includes, and in RUNSPEC and SCHEDULE.
    Read,
    /// In another section, whose name stands in this file: what is included there belongs to it.
    Passed(PathBuf),
}

struct Scan<'a> {
    warnings: &'a mut Warnings,
    section: Section,
    schedule: Schedule,
    now: f64,
    /// TSTEP counts hours.
    is_lab: bool,
    /// WLIST.
    lists: BTreeMap<String, Vec<String>>,
    not_evaluated: BTreeSet<String>,
    /// Wells that nobody has made, and the first keyword that names each.
    unknown: BTreeMap<String, String>,
    /// Changes and layers so far.
    count: usize,
    /// Numbers of wells by their names in upper case.
    numbers: HashMap<String, usize>,
}

/// Reads decks, one after the other.
pub(super) fn read(
    files: &dyn DeckFiles,
    paths: &[&Path],
    start: Option<f64>,
    warnings: &mut Warnings,
) -> Result<Schedule, ParseError> {
    let Some(first) = paths.first() else {
        return Ok(Schedule::default());
    };
    let start = start.or_else(|| crate::calendar::moment(START));
    let mut scan = Scan {
        warnings,
        section: Section::Read,
        schedule: Schedule::default(),
        now: start.unwrap_or_default(),
        is_lab: false,
        lists: BTreeMap::new(),
        not_evaluated: BTreeSet::new(),
        unknown: BTreeMap::new(),
        count: 0,
        numbers: HashMap::new(),
    };
    for path in paths {
        scan.section = Section::Read;
        Walk::through(files, path, &mut scan)?;
    }
    for (name, keyword) in &scan.unknown {
        let message = format!("{keyword} names the well {name}, which WELSPECS does not");
        scan.warnings.push(first, crate::error::At::File, message);
    }
    let mut schedule = scan.schedule;
    schedule.end = scan.now;
    schedule.not_evaluated = scan.not_evaluated.into_iter().collect();
    Ok(schedule)
}

impl Visitor for Scan<'_> {
    fn keyword(
        &mut self,
        walk: &mut Walk<'_>,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<Flow, ParseError> {
        let name = keyword.name.as_str();
        match name {
            "RUNSPEC" | "SCHEDULE" => self.section = Section::Read,
            "GRID" | "EDIT" | "PROPS" | "REGIONS" | "SOLUTION" | "SUMMARY" | "OPTIMIZE"
                if keyword.alone =>
            {
                self.section = Section::Passed(source.path().to_owned());
            }
            "INCLUDE" | "EXTERNAL_FILE" => return self.include(walk, source, cursor, keyword),
            "LAB" => self.is_lab = true,
            "START" => {
                let date = placed(
                    source,
                    name,
                    cursor.record().and_then(|r| records::date(&r)),
                )?;
                self.now = date;
            }
            _ if matches!(self.section, Section::Passed(_)) => pass(source, cursor, name)?,
            "TSTEP" => {
                let sum = placed(
                    source,
                    name,
                    cursor.record().and_then(|r| records::steps(&r)),
                )?;
                self.now += if self.is_lab { sum / 24.0 } else { sum };
            }
            _ if LISTS.contains(&name) => self.list(source, cursor, name)?,
            _ => {
                if NOT_EVALUATED.contains(&name) {
                    self.not_evaluated.insert(name.to_owned());
                }
                match name.starts_with("ACTION") {
                    // What follows would hold under a condition.
                    true => pass_block(cursor, "ENDACTIO"),
                    false => pass(source, cursor, name)?,
                }
            }
        }
        Ok(Flow::On)
    }
}

impl Scan<'_> {
    /// What SCHEDULE includes is read, and what others include where they may not be the only ones.
    fn include(
        &mut self,
        walk: &mut Walk<'_>,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<Flow, ParseError> {
        if self.section == Section::Passed(source.path().to_owned()) {
            named_file(source, cursor, keyword)?;
            return Ok(Flow::On);
        }
        match walk.include(self, source, cursor, keyword) {
            Err(error) if error.kind == ErrorKind::NotFound => {
                let message = format!("wells that stand there are missing: {}", error.message);
                self.warnings
                    .push(source.path(), source.at(keyword.at), message);
                Ok(Flow::On)
            }
            read => read,
        }
    }

    fn list(
        &mut self,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        name: &str,
    ) -> Result<(), ParseError> {
        if !self.schedule.files.iter().any(|file| file == source.path()) {
            self.schedule.files.push(source.path().to_owned());
        }
        while cursor.skip_blank() && !begins_another(cursor) {
            let items = placed(source, name, cursor.record())?;
            if items.is_empty() {
                break;
            }
            placed(source, name, self.record(name, &items))?;
        }
        Ok(())
    }

    fn record(&mut self, name: &str, items: &[Item]) -> Result<(), Mistake> {
        if name == "DATES" {
            self.now = records::date(items)?;
            return Ok(());
        }
        let Some(well) = text(items, 0) else {
            return Ok(());
        };
        let what = match name {
            "WLIST" => {
                self.well_list(&well, items);
                return Ok(());
            }
            "WELSPECS" => records::head(items, 2)?,
            "WELSPECL" => records::head(items, 3)?,
            "COMPDAT" => records::connect(items, 1)?,
            "COMPDATL" => records::connect(items, 2)?,
            "WCONPROD" | "WCONHIST" => records::producer(name, items),
            "WELTARG" => match records::target(items) {
                Some(what) => what,
                None => {
                    let keyword = "WELTARG of other quantities than rates and pressures";
                    self.not_evaluated.insert(keyword.to_owned());
                    return Ok(());
                }
            },
            "WELOPEN" if records::is_by_number(items) => {
                let keyword = "WELOPEN by numbers of completions";
                self.not_evaluated.insert(keyword.to_owned());
                return Ok(());
            }
            "WELOPEN" => records::open(items)?,
            _ => records::injector(name, items),
        };
        let is_new = matches!(what, What::Head { .. }) && !well.contains(['*', '?']);
        let numbers = match is_new {
            true => vec![self.number(&well)],
            false => self.meant(&well),
        };
        if numbers.is_empty() {
            self.unknown.entry(well).or_insert_with(|| name.to_owned());
        }
        let layers = match &what {
            What::Connect { layers, .. } => (layers[1] - layers[0]) as usize + 1,
            _ => 1,
        };
        self.count = self.count.saturating_add(layers * numbers.len());
        if self.count > MOST_CHANGES {
            let at = items.first().map_or(0, |item| item.at);
            let message = format!("wells change more than {MOST_CHANGES} times");
            return Err(Mistake::new(ErrorKind::TooLarge, at, message));
        }
        for well in numbers {
            let what = what.clone();
            self.schedule
                .changes
                .push((self.now, Change { well, what }));
        }
        Ok(())
    }

    /// The number of a well, which is made where it is new.
    fn number(&mut self, well: &str) -> usize {
        let names = &mut self.schedule.names;
        *self.numbers.entry(well.to_uppercase()).or_insert_with(|| {
            names.push(well.to_owned());
            names.len() - 1
        })
    }

    /// Numbers of the wells that a name, one with `*`, or that of a list means.
    fn meant(&self, pattern: &str) -> Vec<usize> {
        let names = self.schedule.names.iter().enumerate();
        if let Some(list) = pattern.strip_prefix('*').filter(|list| !list.is_empty()) {
            let is_listed = |name: &str| {
                let lists = self.lists.iter().filter(|(n, _)| is_meant(list, n));
                let mut wells = lists.flat_map(|(_, wells)| wells);
                wells.any(|well| well.eq_ignore_ascii_case(name))
            };
            return names
                .filter(|(_, n)| is_listed(n))
                .map(|(n, _)| n)
                .collect();
        }
        if !pattern.contains(['*', '?']) {
            let known = self.numbers.get(&pattern.to_uppercase());
            return known.copied().into_iter().collect();
        }
        let names = names.filter(|(_, name)| is_meant(pattern, name));
        names.map(|(number, _)| number).collect()
    }

    /// WLIST: `*NAME`, what to do, and wells.
    fn well_list(&mut self, list: &str, items: &[Item]) {
        let key = list.trim_start_matches('*').to_ascii_uppercase();
        let wells: Vec<String> = (2..items.len())
            .filter_map(|at| text(items, at))
            .flat_map(|pattern| self.meant(&pattern))
            .filter_map(|number| self.schedule.names.get(number).cloned())
            .collect();
        let what = text(items, 1).unwrap_or_default().to_ascii_uppercase();
        if what == "MOV" || what == "DEL" {
            let from = self.lists.iter_mut();
            let from = from.filter(|(name, _)| what == "MOV" || **name == key);
            from.for_each(|(_, known)| known.retain(|well| !wells.contains(well)));
        }
        match what.as_str() {
            "NEW" => drop(self.lists.insert(key, wells)),
            "ADD" | "MOV" => self.lists.entry(key).or_default().extend(wells),
            _ => {}
        }
    }
}

fn placed<T>(source: &Source, name: &str, result: Result<T, Mistake>) -> Result<T, ParseError> {
    result.map_err(|mistake| source.mistake(name, mistake))
}

fn pass(source: &Source, cursor: &mut Cursor, name: &str) -> Result<(), ParseError> {
    placed(source, name, skip_records(cursor, name).map(drop))
}

/// Moves behind the line that begins with a keyword, or to the end of the file.
fn pass_block(cursor: &mut Cursor, end: &str) {
    while cursor.skip_blank() {
        let found = keyword(cursor.text, cursor.at);
        cursor.at = line_end(cursor.text, cursor.at);
        if found.is_some_and(|found| found.name == end) {
            return;
        }
    }
}

/// True where a keyword of this section stands alone in place of another record of a list, whose end is missing.
fn begins_another(cursor: &Cursor) -> bool {
    keyword(cursor.text, cursor.at).is_some_and(|found| {
        let name = found.name.as_str();
        found.alone && (LISTS.contains(&name) || matches!(name, "TSTEP" | "END" | "INCLUDE"))
    })
}

/// True where a text begins with a keyword that only SCHEDULE has.
pub(super) fn begins(start: &[u8]) -> bool {
    let start = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start);
    let mut cursor = Cursor::new(start, 0);
    let only_here = [
        "SCHEDULE", "TSTEP", "RPTSCHED", "WELSEGS", "GRUPTREE", "GCONPROD", "TUNING",
    ];
    cursor.skip_blank()
        && keyword(start, cursor.at).is_some_and(|found| {
            let name = found.name.as_str();
            found.alone && (LISTS.contains(&name) || only_here.contains(&name))
        })
}

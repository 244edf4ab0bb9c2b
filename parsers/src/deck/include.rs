//! INCLUDE and PATHS: how one file leads to the next.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::lexer::{Cursor, Keyword, Token, line_end};
use super::scan::{Flow, Scan};
use super::source::Source;
use crate::error::ParseError;

/// Deepest nesting and largest number of included files.
const DEEPEST: usize = 64;
const MOST_FILES: usize = 2000;

impl Scan<'_> {
    pub(super) fn paths(&mut self, source: &Source, cursor: &mut Cursor) -> Result<(), ParseError> {
        loop {
            let items = cursor
                .record()
                .map_err(|mistake| source.mistake("PATHS", mistake))?;
            if items.is_empty() {
                return Ok(());
            }
            let text = |index: usize| {
                items
                    .get(index)?
                    .text
                    .map(|text| String::from_utf8_lossy(text).into_owned())
            };
            if let (Some(alias), Some(path)) = (text(0), text(1)) {
                self.places.aliases.insert(alias, path);
            }
        }
    }

    pub(super) fn include(
        &mut self,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<Flow, ParseError> {
        let (at, written) = included_path(cursor).ok_or_else(|| {
            source.error(
                keyword.at,
                "INCLUDE",
                "expected the path of a file, in quotes",
            )
        })?;
        let path = self
            .places
            .find(&written, source.path())
            .map_err(|places| {
                let places: Vec<_> = places
                    .iter()
                    .map(|place| place.display().to_string())
                    .collect();
                let message = format!(
                    "'{written}' is not found; looked for {}",
                    places.join(" and ")
                );
                source.error(at, "INCLUDE", message)
            })?;
        if self.open.contains(&canonical(&path)) {
            let message = format!(
                "'{written}' is being read already: the files include each other in a loop"
            );
            return Err(source.error(at, "INCLUDE", message));
        }
        if self.open.len() >= DEEPEST || self.opened >= MOST_FILES {
            let message = format!("more than {DEEPEST} nested or {MOST_FILES} included files");
            return Err(source.error(at, "INCLUDE", message));
        }
        let mut chain = vec![(source.path().to_owned(), source.line(keyword.at))];
        chain.extend_from_slice(&source.included_from);
        self.file(&path, chain)
    }
}

pub(super) fn canonical(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

/// The path behind INCLUDE, in quotes or bare up to a blank, and moves behind its record.
fn included_path(cursor: &mut Cursor) -> Option<(usize, String)> {
    cursor.skip_blank();
    let at = cursor.at;
    let quoted = matches!(cursor.text.get(at), Some(b'\'' | b'"'));
    let path = if quoted {
        match cursor.token() {
            Ok(Some((_, Token::Text(path)))) => path,
            _ => return None,
        }
    } else {
        let behind = cursor.text.get(at..)?;
        let length = behind
            .iter()
            .position(|&byte| byte <= b' ')
            .unwrap_or(behind.len());
        let path = &behind[..length];
        let ended = path.strip_suffix(b"/");
        cursor.at = at + ended.unwrap_or(path).len();
        ended.unwrap_or(path)
    };
    // Sloppy decks leave the closing slash out; nothing else can follow, so that is harmless.
    let mut behind = cursor.clone();
    if let Ok(Some((_, Token::Slash))) = behind.token() {
        cursor.at = line_end(cursor.text, behind.at);
    }
    let path = String::from_utf8_lossy(path.trim_ascii()).into_owned();
    (!path.is_empty()).then_some((at, path))
}

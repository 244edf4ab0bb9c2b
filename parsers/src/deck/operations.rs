//! Keywords that change arrays by a rule: they are not evaluated, and the user is told so.

use std::collections::BTreeSet;
use std::rc::Rc;

use super::lexer::{Cursor, Keyword};
use super::scan::Scan;
use super::skip::operation;
use super::source::Source;
use crate::error::ParseError;

/// An operation that is not evaluated: where first met, how often, which arrays it changes.
pub(super) struct Operation {
    source: Rc<Source>,
    at: usize,
    count: usize,
    targets: BTreeSet<String>,
}

impl Scan<'_> {
    pub(super) fn operation(
        &mut self,
        source: &Rc<Source>,
        cursor: &mut Cursor,
        keyword: &Keyword,
    ) -> Result<(), ParseError> {
        let targets = operation(cursor, &keyword.name)
            .map_err(|mistake| source.mistake(&keyword.name, mistake))?;
        self.note_operation(source, keyword, targets);
        Ok(())
    }

    pub(super) fn note_operation(
        &mut self,
        source: &Rc<Source>,
        keyword: &Keyword,
        targets: Vec<String>,
    ) {
        let noted = self
            .operations
            .entry(keyword.name.clone())
            .or_insert_with(|| Operation {
                source: Rc::clone(source),
                at: keyword.at,
                count: 0,
                targets: BTreeSet::new(),
            });
        noted.count += 1;
        noted.targets.extend(targets);
    }

    /// One warning for each operation keyword, at its first place.
    pub(super) fn report_operations(&mut self) {
        for (name, noted) in std::mem::take(&mut self.operations) {
            let times = if noted.count > 1 {
                format!(" (here first, {} times in all)", noted.count)
            } else {
                String::new()
            };
            let targets = noted
                .targets
                .into_iter()
                .take(20)
                .collect::<Vec<_>>()
                .join(", ");
            let targets = if targets.is_empty() {
                targets
            } else {
                format!("; it concerns {targets}")
            };
            self.warn(
                &noted.source,
                noted.at,
                &format!("{name} is not evaluated{times}{targets}"),
            );
        }
    }
}

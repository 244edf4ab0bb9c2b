//! The tags of an XML file, without what stands between them: as much as a header of VTK needs.

use std::io::{BufRead, BufReader, Read};

use super::source::Source;
use crate::error::{At, ErrorKind, ParseError};

/// Longer tags, and more of them, are no header.
const LONGEST: u64 = 1 << 16;
const MOST: usize = 1 << 14;

/// `<name key="value">`, `</name>` or `<name/>`.
#[derive(Debug)]
pub(super) struct Tag {
    pub(super) name: String,
    attributes: Vec<(String, String)>,
    /// True of `</name>`.
    pub(super) is_end: bool,
    /// Byte offsets of the tag, and behind it.
    pub(super) start: u64,
    pub(super) end: u64,
}

impl Tag {
    /// The value of an attribute, empty where there is none.
    pub(super) fn text(&self, key: &str) -> &str {
        let found = self.attributes.iter().find(|(k, _)| k == key);
        found.map_or("", |(_, value)| value)
    }
}

/// All tags up to the one called `last`, or to the end of the file.
pub(super) fn tags(source: &Source, last: &str) -> Result<Vec<Tag>, ParseError> {
    let mut reader = BufReader::with_capacity(1 << 16, source.reader(0));
    let (mut at, mut tags) = (0, Vec::new());
    loop {
        let io = |cause| ParseError::io(source.path(), "cannot read", cause);
        at += reader.skip_until(b'<').map_err(io)? as u64;
        let start = at - at.min(1);
        let (mut text, mut quote) = (Vec::new(), None);
        loop {
            let before = text.len();
            let read = reader.by_ref().take(LONGEST).read_until(b'>', &mut text);
            let read = read.map_err(io)? as u64;
            at += read;
            if read == 0 {
                return Ok(tags);
            }
            if text.starts_with(b"!--") {
                if text.ends_with(b"-->") {
                    break;
                }
                // Comments may be of any length.
                text.drain(3..text.len().saturating_sub(4).max(3));
                continue;
            }
            quote = text[before..].iter().fold(quote, quoted);
            if text.ends_with(b">") && quote.is_none() {
                break;
            }
            if text.len() as u64 > LONGEST {
                let message = "the file is damaged: a tag has no end";
                return Err(source.error(ErrorKind::Malformed, At::Byte(start), "", message));
            }
        }
        if matches!(text.first(), Some(b'!' | b'?')) {
            continue;
        }
        let tag = tag(&String::from_utf8_lossy(&text), start, at);
        let is_last = tag.name == last;
        tags.push(tag);
        if is_last || tags.len() >= MOST {
            return Ok(tags);
        }
    }
}

/// The quote that is open behind a byte.
fn quoted(open: Option<u8>, byte: &u8) -> Option<u8> {
    match (open, byte) {
        (None, b'"' | b'\'') => Some(*byte),
        (Some(open), byte) if open == *byte => None,
        _ => open,
    }
}

fn tag(text: &str, start: u64, end: u64) -> Tag {
    let text = text.trim_end_matches('>').trim_end_matches('/');
    let is_end = text.starts_with('/');
    let text = text.trim_start_matches('/').trim_start();
    let (name, mut rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    let mut attributes = Vec::new();
    while let Some((key, behind)) = rest.split_once('=') {
        let behind = behind.trim_start();
        let Some(quote) = behind.chars().next().filter(|c| matches!(c, '"' | '\'')) else {
            break;
        };
        let Some((value, behind)) = behind[1..].split_once(quote) else {
            break;
        };
        attributes.push((key.trim().to_owned(), plain(value)));
        rest = behind;
    }
    Tag {
        name: name.to_owned(),
        attributes,
        is_end,
        start,
        end,
    }
}

/// Text with its references resolved.
fn plain(value: &str) -> String {
    let named = [
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&quot;", "\""),
        ("&apos;", "'"),
    ];
    let text = named.iter().fold(value.to_owned(), |text, (name, sign)| {
        text.replace(name, sign)
    });
    text.replace("&amp;", "&")
}

/// `text` with the signs replaced that mean something in XML.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bytes::FileBytes;

    #[test]
    fn tags_and_what_is_between_them() {
        let text = "<?xml version='1.0'?>\n<!-- <no> tag --><A x=\"1 > 0\" y = 'a &amp;lt; b'>text<B/></A><L>_<C>";
        let source = Source::from(FileBytes::from(("A", text)));
        let tags = tags(&source, "L").unwrap();
        let names: Vec<_> = tags
            .iter()
            .map(|tag| (tag.name.as_str(), tag.is_end))
            .collect();
        assert_eq!(
            names,
            [("A", false), ("B", false), ("A", true), ("L", false)]
        );
        assert_eq!(
            (tags[0].text("x"), tags[0].text("y")),
            ("1 > 0", "a &lt; b")
        );
        let between = &text[tags[0].end as usize..tags[1].start as usize];
        assert_eq!(between, "text");
        assert_eq!(plain(&escaped("<a & \"b\">")), "<a & \"b\">");
    }
}

//! The index of a ROFF file: tags and their items, and the values of an item.
//!
//! Words end with a zero in binary files and at a blank in text; what stands between two `#` is a comment. Numbers
//! are of the byte order in which the item `byteswaptest` is 1.

use super::RoffFile;
use crate::bytes::FileBytes;
use crate::error::{ErrorKind, ParseError};
use crate::records::Form;

/// Type of the values of an item.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// True or false.
    Bool,
    /// Bytes without sign.
    Byte,
    /// Strings.
    Char,
    /// 4-byte integers.
    Int,
    /// 4-byte reals.
    Float,
    /// 8-byte reals.
    Double,
}

impl Kind {
    fn parse(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"bool" => Self::Bool,
            b"byte" => Self::Byte,
            b"char" => Self::Char,
            b"int" => Self::Int,
            b"float" => Self::Float,
            b"double" => Self::Double,
            _ => return None,
        })
    }

    /// Bytes of a value in a binary file; strings take as many as they have letters and one more.
    fn size(self) -> usize {
        match self {
            Self::Bool | Self::Byte | Self::Char => 1,
            Self::Int | Self::Float => 4,
            Self::Double => 8,
        }
    }
}

/// A named group of items.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tag {
    /// Name.
    pub name: String,
    /// Items in the order of the file.
    pub items: Vec<Item>,
    /// Byte offset.
    pub offset: u64,
}

impl Tag {
    /// The first item called `name`.
    pub fn find(&self, name: &str) -> Option<&Item> {
        self.items.iter().find(|item| item.name == name)
    }
}

/// A value, or an array of them, not decoded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Item {
    /// Name.
    pub name: String,
    /// Type of the values.
    pub kind: Kind,
    /// Number of values.
    pub count: u64,
    /// Byte offset.
    pub offset: u64,
    /// Byte offsets of the first value, and behind the last one.
    data: [usize; 2],
}

/// What the index finds: the form, whether numbers are little-endian, and the tags.
pub(super) fn index(file: &FileBytes) -> Result<(Form, bool, Vec<Tag>), ParseError> {
    let bytes = file.bytes();
    let form = if bytes.starts_with(b"roff-bin") {
        Form::Binary
    } else if bytes.trim_ascii_start().starts_with(b"roff-asc") {
        Form::Formatted
    } else {
        let kind = ErrorKind::NotThisFormat;
        let message = "is no ROFF file: it starts with neither roff-bin nor roff-asc";
        let at = crate::error::At::File;
        return Err(ParseError::of(kind, file.path(), at, "", message));
    };
    let mut cursor = Cursor {
        bytes,
        at: 0,
        form,
        is_little: true,
    };
    let tags = cursor.tags().map_err(|fault| {
        let at = form.place(bytes, fault.at as u64);
        ParseError::of(fault.kind, file.path(), at, &fault.keyword, fault.message)
    })?;
    Ok((form, cursor.is_little, tags))
}

struct Fault {
    kind: ErrorKind,
    at: usize,
    keyword: String,
    message: String,
}

struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    form: Form,
    is_little: bool,
}

impl<'a> Cursor<'a> {
    fn tags(&mut self) -> Result<Vec<Tag>, Fault> {
        let mut tags = Vec::new();
        self.word();
        while let Some((offset, word)) = self.word() {
            if word != b"tag" {
                let shown = String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned();
                let message = format!("expected a tag, found {shown:?}; the file is damaged");
                return Err(self.fault(ErrorKind::Malformed, offset, "", message));
            }
            let Some((_, name)) = self.word() else {
                let message = "the file ends within a tag";
                return Err(self.fault(ErrorKind::Truncated, offset, "", message));
            };
            let name = shown(name);
            let items = self.items(&name)?;
            let is_end = name == "eof";
            tags.push(Tag {
                name,
                items,
                offset: offset as u64,
            });
            if is_end {
                break;
            }
        }
        Ok(tags)
    }

    fn items(&mut self, tag: &str) -> Result<Vec<Item>, Fault> {
        let mut items = Vec::new();
        loop {
            let cut = |at: usize| Fault {
                kind: ErrorKind::Truncated,
                at,
                keyword: tag.to_owned(),
                message: "the file ends within it".into(),
            };
            let (offset, word) = self.word().ok_or_else(|| cut(self.at))?;
            if word == b"endtag" {
                return Ok(items);
            }
            let is_array = word == b"array";
            let word = match is_array {
                true => self.word().ok_or_else(|| cut(offset))?.1,
                false => word,
            };
            let Some(kind) = Kind::parse(word) else {
                let shown = String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned();
                let message = format!("{shown:?} is no type of an item; the file is damaged");
                return Err(self.fault(ErrorKind::Malformed, offset, tag, message));
            };
            let name = self.word().ok_or_else(|| cut(offset))?.1;
            let name = shown(name);
            let count = match is_array {
                true => self.count().ok_or_else(|| {
                    let message = format!("{name} has no count of values; the file is damaged");
                    self.fault(ErrorKind::Malformed, offset, tag, message)
                })?,
                false => 1,
            };
            let start = self.at;
            if name == "byteswaptest" && self.form == Form::Binary {
                self.is_little = self.bytes.get(start..start + 4) != Some(&[0, 0, 0, 1]);
            }
            let end = self.skip(kind, count).ok_or_else(|| Fault {
                message: format!("the file ends before the {count} values of {name}"),
                ..cut(offset)
            })?;
            items.push(Item {
                name,
                kind,
                count: count as u64,
                offset: offset as u64,
                data: [start, end],
            });
        }
    }

    fn fault(&self, kind: ErrorKind, at: usize, tag: &str, message: impl Into<String>) -> Fault {
        Fault {
            kind,
            at,
            keyword: tag.to_owned(),
            message: message.into(),
        }
    }

    /// The next word that is no comment, and its offset.
    fn word(&mut self) -> Option<(usize, &'a [u8])> {
        loop {
            let (start, word) = match self.form {
                Form::Binary => {
                    let start = self.at;
                    let rest = self.bytes.get(start..)?;
                    let length = rest.iter().position(|b| *b == 0)?;
                    self.at = start + length + 1;
                    (start, &rest[..length])
                }
                Form::Formatted => self.text_word()?,
            };
            if !word.starts_with(b"#") {
                return Some((start, word));
            }
        }
    }

    /// A word of text; of a string in quotes what is between them.
    fn text_word(&mut self) -> Option<(usize, &'a [u8])> {
        let blank = self.bytes.get(self.at..)?;
        let start = self.at + blank.iter().position(|b| *b > b' ')?;
        let rest = &self.bytes[start..];
        // A comment and a string end with what they start with.
        let (from, length, behind) = match rest[0] {
            mark @ (b'#' | b'"') => {
                let length = rest[1..].iter().position(|b| *b == mark)?;
                let from = usize::from(mark == b'"');
                (from, length + 1 - from, length + 2)
            }
            _ => {
                let length = rest.iter().position(|b| *b <= b' ');
                let length = length.unwrap_or(rest.len());
                (0, length, length)
            }
        };
        self.at = start + behind;
        Some((start, &rest[from..from + length]))
    }

    /// The number of values of an array.
    fn count(&mut self) -> Option<usize> {
        let count = match self.form {
            Form::Binary => {
                let bytes = self.bytes.get(self.at..self.at + 4)?;
                self.at += 4;
                int(bytes, self.is_little)?
            }
            Form::Formatted => std::str::from_utf8(self.text_word()?.1)
                .ok()?
                .parse()
                .ok()?,
        };
        usize::try_from(count).ok()
    }

    /// Moves behind so many values; `None` where the file ends before them.
    fn skip(&mut self, kind: Kind, count: usize) -> Option<usize> {
        // Each takes a byte at least.
        if count > self.bytes.len() - self.at {
            return None;
        }
        if self.form == Form::Binary && kind != Kind::Char {
            self.at = self.at.checked_add(count.checked_mul(kind.size())?)?;
            return (self.at <= self.bytes.len()).then_some(self.at);
        }
        for _ in 0..count {
            match self.form {
                Form::Binary => {
                    let rest = self.bytes.get(self.at..)?;
                    self.at += rest.iter().position(|b| *b == 0)? + 1;
                }
                Form::Formatted => drop(self.text_word()?),
            }
        }
        Some(self.at)
    }
}

/// A number as text, in the precision of its type.
fn text_number(kind: Kind, word: &[u8]) -> Option<f64> {
    let number = std::str::from_utf8(word).ok()?.parse::<f64>();
    match (kind, number) {
        (Kind::Float, Ok(number)) => Some(f64::from(number as f32)),
        (_, Ok(number)) => Some(number),
        // As xtgeo writes them.
        (Kind::Bool, Err(_)) if word.eq_ignore_ascii_case(b"true") => Some(1.0),
        (Kind::Bool, Err(_)) if word.eq_ignore_ascii_case(b"false") => Some(0.0),
        _ => None,
    }
}

/// A word as names and messages have it: without what would break a line, as in damaged files.
fn shown(word: &[u8]) -> String {
    String::from_utf8_lossy(word).replace(char::is_control, "?")
}

fn int(bytes: &[u8], is_little: bool) -> Option<i32> {
    let bytes = bytes.try_into().ok()?;
    Some(match is_little {
        true => i32::from_le_bytes(bytes),
        false => i32::from_be_bytes(bytes),
    })
}

impl RoffFile {
    /// Values of an item of numbers; true is 1 and false 0.
    ///
    /// # Errors
    /// When it holds strings, or is damaged.
    pub fn f64s(&self, item: &Item) -> Result<Vec<f64>, ParseError> {
        if item.kind == Kind::Char {
            return Err(self.error(ErrorKind::WrongType, item, "holds no numbers"));
        }
        let bytes = self.data(item)?;
        let values: Vec<f64> = match self.form {
            Form::Binary => {
                let value = |bytes: &[u8]| self.number_of(item.kind, bytes).unwrap_or(f64::NAN);
                bytes.chunks_exact(item.kind.size()).map(value).collect()
            }
            Form::Formatted => {
                let words = bytes.split(|b| *b <= b' ').filter(|w| !w.is_empty());
                let value = |word: &[u8]| {
                    let number = text_number(item.kind, word);
                    number.ok_or_else(|| {
                        let shown = String::from_utf8_lossy(&word[..word.len().min(40)]);
                        let message = format!("{shown:?} is not a number");
                        self.error(ErrorKind::BadValue, item, message)
                    })
                };
                words.map(value).collect::<Result<_, _>>()?
            }
        };
        match values.len() as u64 == item.count {
            true => Ok(values),
            false => Err(self.error(
                ErrorKind::Malformed,
                item,
                format!("has {} numbers and says {}", values.len(), item.count),
            )),
        }
    }

    fn number_of(&self, kind: Kind, bytes: &[u8]) -> Option<f64> {
        Some(match (kind, self.is_little) {
            (Kind::Bool, _) => f64::from(u8::from(bytes.first() != Some(&0))),
            (Kind::Byte | Kind::Char, _) => f64::from(*bytes.first()?),
            (Kind::Int, is_little) => f64::from(int(bytes, is_little)?),
            (Kind::Float, true) => f64::from(f32::from_le_bytes(bytes.try_into().ok()?)),
            (Kind::Float, false) => f64::from(f32::from_be_bytes(bytes.try_into().ok()?)),
            (Kind::Double, true) => f64::from_le_bytes(bytes.try_into().ok()?),
            (Kind::Double, false) => f64::from_be_bytes(bytes.try_into().ok()?),
        })
    }

    /// Strings of an item.
    ///
    /// # Errors
    /// When it holds none, or is damaged.
    pub fn strings(&self, item: &Item) -> Result<Vec<String>, ParseError> {
        if item.kind != Kind::Char {
            return Err(self.error(ErrorKind::WrongType, item, "holds no strings"));
        }
        let mut cursor = Cursor {
            bytes: self.data(item)?,
            at: 0,
            form: self.form,
            is_little: self.is_little,
        };
        let mut strings = Vec::new();
        for _ in 0..item.count {
            let word = match self.form {
                Form::Binary => {
                    let rest = cursor.bytes.get(cursor.at..).unwrap_or_default();
                    let word = rest.split(|b| *b == 0).next().unwrap_or_default();
                    cursor.at += word.len() + 1;
                    word
                }
                Form::Formatted => cursor.text_word().map(|w| w.1).unwrap_or_default(),
            };
            strings.push(String::from_utf8_lossy(word).into_owned());
        }
        Ok(strings)
    }

    fn data(&self, item: &Item) -> Result<&[u8], ParseError> {
        let [start, end] = item.data;
        let bytes = self.file.bytes().get(start..end);
        bytes.ok_or_else(|| {
            let message = "the file ends before its values";
            self.error(ErrorKind::Truncated, item, message)
        })
    }
}

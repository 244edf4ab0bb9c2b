//! The parts of a package: a zip archive whose `[Content_Types].xml` says what each is.

use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::Path;

use roxmltree::Document;
use zip::ZipArchive;
use zip::result::ZipError;

use super::xml::{self, Part};
use crate::bytes::FileBytes;
use crate::error::{At, ErrorKind, ParseError};

const CONTENT: &str = "[Content_Types].xml";

/// Most bytes of a part, and of all parts that are read: objects have their arrays elsewhere.
const MOST_OF_PART: u64 = 16 << 20;
const MOST_OF_ALL: u64 = 1 << 30;

/// True for a zip archive that says what its parts are.
pub fn is_package(path: &Path) -> bool {
    let is = || -> io::Result<bool> {
        if !std::fs::metadata(path)?.is_file() {
            return Ok(false);
        }
        let mut file = File::open(path)?;
        let mut start = [0; 4];
        file.read_exact(&mut start)?;
        if start != *b"PK\x03\x04" {
            return Ok(false);
        }
        let archive = ZipArchive::new(file)?;
        Ok(archive.index_for_name(CONTENT).is_some())
    };
    is().unwrap_or(false)
}

/// A part and what it is.
pub(super) struct Object {
    /// Path in the package, without the slash at its start.
    pub(super) name: String,
    /// Type without `obj_`, such as `IjkGridRepresentation`.
    pub(super) kind: String,
    /// Version of RESQML, such as `2.0`.
    pub(super) version: String,
}

pub(super) struct Parts<'a> {
    path: &'a Path,
    archive: ZipArchive<Cursor<&'a [u8]>>,
    /// Bytes that may still be read.
    left: u64,
}

impl<'a> Parts<'a> {
    pub(super) fn open(file: &'a FileBytes) -> Result<Self, ParseError> {
        let archive = ZipArchive::new(Cursor::new(file.bytes())).map_err(|error| {
            let (kind, message) = match file.bytes().starts_with(b"PK\x03\x04") {
                true => (
                    ErrorKind::Malformed,
                    format!("is no whole RESQML package: it is cut or damaged ({error})"),
                ),
                false => (
                    ErrorKind::NotThisFormat,
                    "is no RESQML package, which is a zip archive".to_owned(),
                ),
            };
            ParseError::of(kind, file.path(), At::File, "", message)
        })?;
        Ok(Self {
            path: file.path(),
            archive,
            left: MOST_OF_ALL,
        })
    }

    /// The text of a part.
    pub(super) fn text(&mut self, name: &str) -> Result<String, ParseError> {
        let part = Part {
            path: self.path,
            name,
        };
        let found = self.archive.by_name(name).map_err(|error| match error {
            ZipError::FileNotFound => {
                part.error(ErrorKind::MissingKeyword, "the package has no such part")
            }
            error => part.error(ErrorKind::Malformed, error.to_string()),
        })?;
        let most = MOST_OF_PART.min(self.left);
        let mut bytes = Vec::new();
        let read = found.take(most + 1).read_to_end(&mut bytes);
        read.map_err(|error| part.error(ErrorKind::Malformed, format!("is damaged: {error}")))?;
        let count = bytes.len() as u64;
        if count > most {
            let message = format!("unpacks to more than {most} bytes, which no object has");
            return Err(part.error(ErrorKind::TooLarge, message));
        }
        self.left -= count;
        let text = String::from_utf8(bytes);
        let text = text.map_err(|_| part.error(ErrorKind::Malformed, "is not in UTF-8"))?;
        // A byte order mark is no part of the document.
        Ok(match text.strip_prefix('\u{feff}') {
            Some(rest) => rest.to_owned(),
            None => text,
        })
    }

    /// The objects in the order in which the package names them.
    pub(super) fn objects(&mut self) -> Result<Vec<Object>, ParseError> {
        let text = self.text(CONTENT)?;
        let document = document(self.path, CONTENT, &text)?;
        let parts = document.root_element().children();
        let parts = parts.filter(|node| xml::is(*node, "Override"));
        let object = parts.filter_map(|node| {
            let name = node.attribute("PartName")?.trim_start_matches('/');
            let content = node.attribute("ContentType")?;
            let item = |key: &str| {
                let mut items = content.split(';').map(str::trim);
                items.find_map(|item| item.strip_prefix(key)?.strip_prefix('='))
            };
            let kind = item("type")?;
            Some(Object {
                name: name.to_owned(),
                kind: kind.strip_prefix("obj_").unwrap_or(kind).to_owned(),
                version: item("version").unwrap_or_default().to_owned(),
            })
        });
        Ok(object.collect())
    }

    /// The files outside of the package that a part refers to.
    pub(super) fn external(&mut self, name: &str) -> Result<Vec<String>, ParseError> {
        let (folder, file) = name.rsplit_once('/').unwrap_or(("", name));
        let folder = match folder {
            "" => String::new(),
            folder => format!("{folder}/"),
        };
        let relations = format!("{folder}_rels/{file}.rels");
        let text = self.text(&relations)?;
        let document = document(self.path, &relations, &text)?;
        let nodes = document.root_element().children();
        let external = nodes.filter(|node| node.attribute("TargetMode") == Some("External"));
        let targets = external.filter_map(|node| node.attribute("Target"));
        Ok(targets.map(str::to_owned).collect())
    }
}

/// The elements of a part.
pub(super) fn document<'i>(
    path: &Path,
    name: &str,
    text: &'i str,
) -> Result<Document<'i>, ParseError> {
    Document::parse(text).map_err(|error| {
        let message = format!("is no well-formed XML: {error}");
        Part { path, name }.error(ErrorKind::Malformed, message)
    })
}

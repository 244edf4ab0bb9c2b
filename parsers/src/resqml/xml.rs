//! XML objects of a package: elements by name, whatever their namespaces.

use std::path::Path;
use std::str::FromStr;

use roxmltree::Node;

use crate::error::{At, ErrorKind, ParseError};

/// Namespace of the attribute `type`.
const XSI: &str = "http://www.w3.org/2001/XMLSchema-instance";

/// Where elements stand, for errors: the package and the part in it.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    pub(super) path: &'a Path,
    pub(super) name: &'a str,
}

impl Part<'_> {
    pub(super) fn error(self, kind: ErrorKind, message: impl Into<String>) -> ParseError {
        ParseError::of(kind, self.path, At::File, self.name, message)
    }

    /// The child of `node` called `name`.
    pub(super) fn need<'a, 'i>(
        self,
        node: Node<'a, 'i>,
        name: &str,
    ) -> Result<Node<'a, 'i>, ParseError> {
        child(node, name).ok_or_else(|| {
            let message = format!("{} has no {name}", node.tag_name().name());
            self.error(ErrorKind::MissingKeyword, message)
        })
    }

    /// The number in the child of `node` called `name`.
    pub(super) fn number<T: FromStr>(
        self,
        node: Node<'_, '_>,
        name: &str,
    ) -> Result<T, ParseError> {
        let text = text(self.need(node, name)?);
        text.parse().map_err(|_| {
            let message = format!("{name} is {text:?}, which is no number that can stand there");
            self.error(ErrorKind::BadValue, message)
        })
    }

    /// As [`Self::number`]; `None` where there is no such child.
    pub(super) fn number_if<T: FromStr>(
        self,
        node: Node<'_, '_>,
        name: &str,
    ) -> Result<Option<T>, ParseError> {
        child(node, name)
            .map(|_| self.number(node, name))
            .transpose()
    }

    /// Whether the child of `node` called `name` is true.
    pub(super) fn flag(self, node: Node<'_, '_>, name: &str) -> Result<bool, ParseError> {
        match text(self.need(node, name)?) {
            "true" | "1" => Ok(true),
            "false" | "0" => Ok(false),
            text => {
                let message = format!("{name} is {text:?}, not true or false");
                Err(self.error(ErrorKind::BadValue, message))
            }
        }
    }
}

/// The first child of `node` called `name`.
pub(super) fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| is(*child, name))
}

/// True for an element called `name`.
pub(super) fn is(node: Node<'_, '_>, name: &str) -> bool {
    node.is_element() && node.tag_name().name() == name
}

/// The text of an element, without blanks around it.
pub(super) fn text<'a>(node: Node<'a, '_>) -> &'a str {
    node.text().unwrap_or_default().trim()
}

/// The text of the child of `node` called `name`; empty where there is none.
pub(super) fn text_of<'a>(node: Node<'a, '_>, name: &str) -> &'a str {
    child(node, name).map(text).unwrap_or_default()
}

/// What an element is, such as `Point3dHdf5Array`.
pub(super) fn type_of<'a>(node: Node<'a, '_>) -> &'a str {
    let name = node.attribute((XSI, "type")).unwrap_or_default();
    let name = name.rsplit(':').next().unwrap_or_default();
    name.strip_prefix("obj_").unwrap_or(name)
}

/// The object that the child of `node` called `name` refers to, in lower case; empty where there is none.
pub(super) fn reference(node: Node<'_, '_>, name: &str) -> String {
    child(node, name).map_or_else(String::new, |node| {
        text_of(node, "UUID").to_ascii_lowercase()
    })
}

/// The title of an object.
pub(super) fn title(root: Node<'_, '_>) -> String {
    child(root, "Citation").map_or_else(String::new, |node| text_of(node, "Title").to_owned())
}

/// The name of an object, in lower case.
pub(super) fn uuid(root: Node<'_, '_>) -> String {
    root.attribute("uuid")
        .unwrap_or_default()
        .to_ascii_lowercase()
}

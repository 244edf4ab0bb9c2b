//! Readers on files in memory: what they give, of which kinds their errors are, and that no bytes make them panic.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic, reason = "tests")]

mod any;
mod fixtures;
mod hostile;
mod kinds;
mod memory;
mod mutations;
mod properties;
mod sentences;

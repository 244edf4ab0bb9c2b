//! The viewer's real interface without a display, driven as users do, on the adapter that there is.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

mod cases;
mod coloring;
#[path = "../common/mod.rs"]
mod common;
mod comparing;
mod driven;
mod filtering;
mod keeping;
mod looking;
mod opening;
mod selecting;
mod showing;
mod speed;
mod tour;
mod wells;

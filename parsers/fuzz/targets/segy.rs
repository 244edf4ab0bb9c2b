#![no_main]
#![allow(
    missing_docs,
    dead_code,
    reason = "a fuzz target uses one property of all"
)]

#[path = "../../tests/bytes/properties.rs"]
mod properties;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| properties::holds(properties::segy, bytes.to_vec()));

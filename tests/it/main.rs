//! Tests of the library and of the command, one module for each subject.
//!
//! They are one binary, because linking the device and the window takes longer than compiling a test. What needs a
//! display or a window of its own is a binary of its own, and so is what only reads source text.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

#[path = "../common/mod.rs"]
mod common;

mod analytic;
mod bad_input;
mod bench;
mod colors;
mod compare;
mod cone_accuracy;
mod cones;
mod cpu_light;
mod dispatch;
mod doctor;
mod dual_porosity;
mod executors;
mod export;
mod extinction;
mod facts;
mod films;
mod filters;
mod first_pictures;
mod framing;
mod hybrid;
mod layout;
mod libc;
mod light_methods;
mod light_updates;
mod lighting;
mod limits;
mod local_grids;
mod metrics;
mod occluders;
mod occlusion;
mod odd_cells;
mod oracle;
mod outliers;
mod overlap;
mod pairs;
mod parameters;
mod paths;
mod picking;
mod pictures;
mod point_location;
mod radial;
mod reported;
mod reservoirs;
mod resqml;
mod roff;
mod shadows;
mod simbox;
mod srg;
mod statistics;
mod storage;
mod supersampling;
mod surfaces;
mod surround;
mod synthetic;
mod units;
mod vectors;
mod volumes;
mod wells;

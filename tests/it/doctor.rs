//! `strataray doctor` against the device that is opened.

use std::process::Command;

use serde_json::Value;
use strataray::render;

use crate::common;

fn doctor(arguments: &[&str], drivers: Option<&str>) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_strataray"));
    command.arg("doctor").args(arguments);
    if let Some(drivers) = drivers {
        command.envs([("VK_ICD_FILENAMES", drivers), ("VK_DRIVER_FILES", drivers)]);
    }
    let output = command.output().unwrap();
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn the_default_adapter_is_the_one_that_makes_images() {
    let Some(gpu) = common::gpu() else { return };
    let facts: Value = serde_json::from_str(&doctor(&["--json"], None)).unwrap();
    let adapters = facts["adapters"].as_array().unwrap();
    let usable = adapters.iter().find(|a| a["usable"] == true).unwrap();
    assert_eq!(usable["name"], gpu.info.name.as_str());
    assert_eq!(usable["backend"], gpu.info.backend.to_str());
    assert!(usable["max_array_bytes"].as_u64().unwrap() >= 128 << 20);
    let taken = render::executor(None).unwrap().info();
    match facts["default"].as_str() {
        Some("cpu") => assert!(gpu.is_software() && taken.executor == "cpu"),
        name => assert!(taken.adapter.starts_with(name.unwrap())),
    }
}

#[test]
fn without_a_driver_it_says_what_to_install() {
    let told = doctor(&[], Some("/nonexistent"));
    assert!(told.contains("mesa-vulkan-drivers"), "{told}");
}

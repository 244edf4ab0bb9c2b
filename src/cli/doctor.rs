//! `strataray doctor`: what this machine has to make images with, and what is missing.

use serde_json::{Value, json};
use strataray::render::{AdapterFacts, adapters};

#[derive(clap::Args)]
#[command(after_help = "Examples:
  strataray doctor
  strataray doctor --json")]
pub struct Arguments {
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// What there is on this machine.
struct Machine {
    /// The best one first.
    adapters: Vec<AdapterFacts>,
    /// Threads of the processor.
    threads: usize,
    /// The display that a window would open on; always there but on Linux and its like.
    display: Option<String>,
}

impl Machine {
    /// The adapter that is used where none is asked for; `None` where the processor is.
    fn default_adapter(&self) -> Option<&AdapterFacts> {
        let best = self.adapters.first()?;
        (best.lacking.is_none() && best.kind != "software").then_some(best)
    }
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let machine = Machine {
        adapters: adapters(),
        threads: std::thread::available_parallelism().map_or(1, usize::from),
        display: display(),
    };
    match arguments.json {
        true => say_line!("{}", serde_json::to_string_pretty(&facts(&machine))?),
        false => say!("{}", text(&machine)),
    }
    Ok(())
}

#[cfg(any(windows, target_os = "macos"))]
fn display() -> Option<String> {
    Some("desktop".into())
}

#[cfg(not(any(windows, target_os = "macos")))]
fn display() -> Option<String> {
    let named = |kind: &str, variable: &str| {
        let value = std::env::var(variable).ok().filter(|v| !v.is_empty())?;
        Some(format!("{kind} {value}"))
    };
    named("Wayland", "WAYLAND_DISPLAY").or_else(|| named("X11", "DISPLAY"))
}

/// What to do about what is missing, a sentence each.
fn advice(machine: &Machine) -> Vec<&'static str> {
    let mut advice = Vec::new();
    if machine.default_adapter().is_none() {
        advice.push(
            "There is no GPU that can be used, so images are made on the processor. If there is one, install its Vulkan driver: the one of its maker, or on Debian and Ubuntu the package mesa-vulkan-drivers.",
        );
    }
    if machine.adapters.is_empty() {
        advice.push(
            "There is no graphics driver at all, so the window cannot draw; install the package mesa-vulkan-drivers, which also has one in software, or use the other commands.",
        );
    }
    if machine.display.is_none() {
        advice.push(
            "There is no display, so the window cannot open; `strataray render` and the other commands work without one.",
        );
    }
    advice
}

fn text(machine: &Machine) -> String {
    let mut lines = vec![format!("strataray {}", env!("CARGO_PKG_VERSION"))];
    let by_default = machine.default_adapter().map(std::ptr::from_ref);
    for adapter in &machine.adapters {
        let state = match &adapter.lacking {
            Some(reason) => format!("cannot be used: {reason}"),
            None if by_default.is_some_and(|d| std::ptr::eq(d, adapter)) => {
                "used by default".into()
            }
            None => format!("used with --adapter \"{}\"", adapter.name),
        };
        lines.push(format!(
            "adapter   {}: {}, {}{}",
            adapter.name,
            adapter.kind,
            adapter.backend,
            match adapter.driver.as_str() {
                "" => String::new(),
                driver => format!(", driver {driver}"),
            }
        ));
        let [image, volume] = adapter.most_texels;
        lines.push(format!(
            "          arrays to {} MB, images to {image} pixels, volumes to {volume} voxels along an edge",
            adapter.most_bytes >> 20
        ));
        lines.push(format!("          {state}"));
    }
    if machine.adapters.is_empty() {
        lines.push("adapter   none".into());
    }
    let state = match by_default {
        None => "used by default",
        Some(_) => "used with --adapter cpu",
    };
    lines.push(format!("processor {} threads, {state}", machine.threads));
    let display = machine.display.as_deref().unwrap_or("none");
    lines.push(format!("display   {display}"));
    lines.push(String::new());
    match advice(machine) {
        advice if advice.is_empty() => lines.push("All that is needed is there.".into()),
        advice => lines.extend(advice.into_iter().map(str::to_owned)),
    }
    lines.join("\n") + "\n"
}

fn facts(machine: &Machine) -> Value {
    let adapter = |a: &AdapterFacts| {
        json!({
            "name": a.name,
            "kind": a.kind,
            "backend": a.backend,
            "driver": a.driver,
            "max_array_bytes": a.most_bytes,
            "max_image_size": a.most_texels[0],
            "max_volume_size": a.most_texels[1],
            "usable": a.lacking.is_none(),
            "problem": a.lacking,
        })
    };
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "adapters": machine.adapters.iter().map(adapter).collect::<Vec<_>>(),
        "default": machine.default_adapter().map_or("cpu", |a| a.name.as_str()),
        "threads": machine.threads,
        "display": machine.display,
        "advice": advice(machine),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(name: &str, kind: &'static str, lacking: Option<&str>) -> AdapterFacts {
        AdapterFacts {
            name: name.into(),
            kind,
            backend: "vulkan",
            driver: "Mesa 22".into(),
            most_bytes: 1 << 30,
            most_texels: [16_384, 2048],
            lacking: lacking.map(str::to_owned),
        }
    }

    #[test]
    fn the_first_adapter_that_can_be_used_is_the_default() {
        let machine = Machine {
            adapters: vec![
                adapter("Card", "discrete GPU", None),
                adapter("llvmpipe", "software", None),
                adapter("Old", "other", Some("it is old")),
            ],
            threads: 2,
            display: Some("X11 :0".into()),
        };
        let told = text(&machine);
        assert_eq!(told.matches("used by default").count(), 1);
        let default = told.find("used by default");
        assert!(told.find("Card") < default && default < told.find("llvmpipe"));
        assert!(told.contains("cannot be used: it is old") && told.contains("is needed is there"));
        assert_eq!(facts(&machine)["adapters"][2]["usable"], false);
        assert_eq!(facts(&machine)["default"], "Card");
        assert!(told.contains("2 threads, used with --adapter cpu"));
    }

    #[test]
    fn what_is_missing_is_told_with_what_to_do() {
        let mut machine = Machine {
            adapters: vec![],
            threads: 2,
            display: None,
        };
        assert_eq!(advice(&machine).len(), 3);
        assert!(text(&machine).contains("mesa-vulkan-drivers"));
        machine.adapters = vec![adapter("llvmpipe", "software", None)];
        assert_eq!(advice(&machine).len(), 2);
        assert!(text(&machine).contains("2 threads, used by default"));
        assert_eq!(facts(&machine)["default"], "cpu");
    }
}

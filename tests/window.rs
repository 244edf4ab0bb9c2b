//! The real window on a display of its own (Xvfb): events come from the X server, pixels from its screen.
#![cfg(target_os = "linux")]
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

mod common;

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    self, ClientMessageEvent, ConfigureWindowAux, ConnectionExt as _, ImageFormat, InputFocus,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

const SIZE: [u16; 2] = [1280, 800];
/// Longest wait for anything on a machine that does other things too.
const PATIENCE: Duration = Duration::from_secs(90);

/// A process that ends with its owner.
struct Ends(Child);

impl Drop for Ends {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A display that nobody sees; `None` with a sentence where there is no Xvfb.
struct Display {
    name: String,
    x: RustConnection,
    root: u32,
    _server: Ends,
}

impl Display {
    fn start() -> Option<Self> {
        let screen = format!("{}x{}x24", SIZE[0], SIZE[1]);
        let server = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-nolisten",
                "tcp",
                "-screen",
                "0",
                &screen,
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut server = match server {
            Ok(server) => Ends(server),
            Err(error) if std::env::var_os("REQUIRE_GPU").is_some() => panic!("Xvfb: {error}"),
            Err(error) => {
                eprintln!("SKIPPED: Xvfb does not start: {error}");
                return None;
            }
        };
        let mut number = String::new();
        BufReader::new(server.0.stdout.take().unwrap())
            .read_line(&mut number)
            .unwrap();
        let name = format!(":{}", number.trim());
        let (x, screen) = x11rb::connect(Some(&name)).unwrap();
        let root = x.setup().roots[screen].root;
        Some(Self {
            name,
            x,
            root,
            _server: server,
        })
    }

    /// What is on the screen: blue, green, red, nothing a pixel.
    fn pixels(&self) -> Vec<[u8; 4]> {
        let all = ImageFormat::Z_PIXMAP;
        let image = self
            .x
            .get_image(all, self.root, 0, 0, SIZE[0], SIZE[1], u32::MAX);
        let data = image.unwrap().reply().unwrap().data;
        data.as_chunks::<4>().0.to_vec()
    }

    fn fake(&self, kind: u8, detail: u8, x: i16, y: i16) {
        self.x
            .xtest_fake_input(kind, detail, 0, self.root, x, y, 0)
            .unwrap()
            .check()
            .unwrap();
    }

    fn moves(&self, x: i16, y: i16) {
        self.fake(xproto::MOTION_NOTIFY_EVENT, 0, x, y);
    }

    fn button(&self, is_down: bool) {
        let kind = if is_down {
            xproto::BUTTON_PRESS_EVENT
        } else {
            xproto::BUTTON_RELEASE_EVENT
        };
        self.fake(kind, 1, 0, 0);
    }

    /// Presses keys one after another and lets them go.
    fn keys(&self, symbols: &[u32]) {
        let setup = self.x.setup();
        let (low, count) = (setup.min_keycode, setup.max_keycode - setup.min_keycode + 1);
        let map = self
            .x
            .get_keyboard_mapping(low, count)
            .unwrap()
            .reply()
            .unwrap();
        let width = usize::from(map.keysyms_per_keycode);
        let code = |symbol: &u32| {
            let at = map
                .keysyms
                .chunks(width)
                .position(|k| k.contains(symbol))
                .unwrap();
            low + at as u8
        };
        let codes: Vec<u8> = symbols.iter().map(code).collect();
        for code in &codes {
            self.fake(xproto::KEY_PRESS_EVENT, *code, 0, 0);
        }
        for code in codes.iter().rev() {
            self.fake(xproto::KEY_RELEASE_EVENT, *code, 0, 0);
        }
    }

    /// The window of the viewer, once it is there.
    fn window(&self) -> u32 {
        let start = Instant::now();
        loop {
            let tree = self.x.query_tree(self.root).unwrap().reply().unwrap();
            let is_large = |w: &u32| {
                let shape = self.x.get_geometry(*w).unwrap().reply();
                shape.is_ok_and(|s| s.width > 400)
            };
            if let Some(window) = tree.children.into_iter().find(is_large) {
                return window;
            }
            assert!(start.elapsed() < PATIENCE, "no window came");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Waits until the screen shows something, and nothing has changed for a second.
    fn settled(&self, what: &str, holds: impl Fn(&[[u8; 4]]) -> bool) -> Vec<[u8; 4]> {
        let start = Instant::now();
        let (mut before, mut since) = (self.pixels(), Instant::now());
        loop {
            std::thread::sleep(Duration::from_millis(100));
            let now = self.pixels();
            if now != before {
                (before, since) = (now, Instant::now());
            } else if since.elapsed() > Duration::from_secs(1) && holds(&before) {
                return before;
            }
            assert!(start.elapsed() < PATIENCE, "waited for {what}");
        }
    }
}

/// Pixels in the middle of the window that are neither white nor gray: the model's colors.
fn colored(pixels: &[[u8; 4]]) -> usize {
    let rows = pixels.chunks(usize::from(SIZE[0])).skip(150).take(450);
    let middle = rows.flat_map(|row| &row[300..900]);
    let is_colored = |p: &&[u8; 4]| p[0].abs_diff(p[1]) > 8 || p[1].abs_diff(p[2]) > 8;
    middle.filter(is_colored).count()
}

fn viewer(display: &Display, case: &Path, config: &Path) -> Ends {
    let child = Command::new(env!("CARGO_BIN_EXE_strataray"))
        .arg(case)
        .env("DISPLAY", &display.name)
        .env_remove("WAYLAND_DISPLAY")
        .env("STRATARAY_CONFIG", config)
        .spawn();
    Ends(child.unwrap())
}

/// Seconds of CPU time that a process has taken.
fn cpu(process: &Ends) -> f64 {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", process.0.id())).unwrap();
    let fields: Vec<&str> = stat
        .rsplit(')')
        .next()
        .unwrap()
        .split_whitespace()
        .collect();
    let ticks = |n: usize| fields[n].parse::<f64>().unwrap();
    // User and system time, of a hundred ticks a second on every Linux.
    (ticks(11) + ticks(12)) / 100.0
}

/// Seconds of CPU time that a process takes meanwhile.
fn used(process: &Ends, meanwhile: Duration) -> f64 {
    let before = cpu(process);
    std::thread::sleep(meanwhile);
    cpu(process) - before
}

const CONTROL: u32 = 0xffe3;
const ALT: u32 = 0xffe9;

#[test]
fn the_window_shows_a_case_and_follows_the_hand() {
    let Some(display) = Display::start() else {
        return;
    };
    let config = tempfile::tempdir().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let case = common::copy_of_sample(folder.path());
    let mut process = viewer(&display, &case, config.path());
    let window = display.window();
    let first = display.settled("the first picture", |p| colored(p) > 5_000);
    display
        .x
        .set_input_focus(InputFocus::PARENT, window, 0u32)
        .unwrap()
        .check()
        .unwrap();
    // Once the picture is final, the window takes no CPU time.
    let start = Instant::now();
    while used(&process, Duration::from_secs(1)) > 0.0 {
        assert!(start.elapsed() < PATIENCE, "it does not come to rest");
    }
    let idle = used(&process, Duration::from_secs(3));
    assert!(idle < 0.05, "{idle} s of 3");
    // A drag turns the model.
    display.moves(600, 400);
    display.button(true);
    for n in 1..=10 {
        display.moves(600 + 15 * n, 400 + 3 * n);
        std::thread::sleep(Duration::from_millis(30));
    }
    display.button(false);
    display.moves(640, 20);
    let turned = display.settled("a turned picture", |p| *p != first && colored(p) > 5_000);
    // Keys: the last change is taken back; the theme is another one, and that is remembered.
    display.keys(&[CONTROL, u32::from(b'z')]);
    display.settled("the first picture again", |p| {
        *p != turned && colored(p) > 5_000
    });
    display.keys(&[CONTROL, u32::from(b'd')]);
    let light = display.settled("light panels", |p| p[150 * 1280 + 20][0] > 200);
    let settings = config.path().join("strataray/settings.json");
    let settings = std::fs::read_to_string(settings).unwrap();
    assert!(settings.contains("\"dark\": false"), "{settings}");
    // The files go, the window stays.
    for file in std::fs::read_dir(folder.path()).unwrap() {
        std::fs::remove_file(file.unwrap().path()).unwrap();
    }
    display.keys(&[CONTROL, ALT, u32::from(b't')]);
    display.settled("the view from above", |p| *p != light && colored(p) > 5_000);
    // As small as it gets, and back.
    for size in [[1, 1], [200, 700], [u32::from(SIZE[0]), u32::from(SIZE[1])]] {
        let shape = ConfigureWindowAux::new().width(size[0]).height(size[1]);
        display
            .x
            .configure_window(window, &shape)
            .unwrap()
            .check()
            .unwrap();
        std::thread::sleep(Duration::from_millis(300));
    }
    display.settled("the picture in full size", |p| colored(p) > 5_000);
    // Closed while it draws.
    display.keys(&[u32::from(b's')]);
    close(&display, window);
    let start = Instant::now();
    let status = loop {
        if let Some(status) = process.0.try_wait().unwrap() {
            break status;
        }
        assert!(start.elapsed() < PATIENCE, "it does not end");
        std::thread::sleep(Duration::from_millis(20));
    };
    assert!(status.success(), "{status}");
}

#[test]
fn without_a_display_one_sentence_says_so() {
    let output = Command::new(env!("CARGO_BIN_EXE_strataray"))
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(
        !output.status.success() && error.contains("no display"),
        "{error}"
    );
    assert_eq!(error.trim().lines().count(), 1, "{error}");
}

/// Asks the window to close, as a window manager does.
fn close(display: &Display, window: u32) {
    let atom = |name: &str| {
        let atom = display.x.intern_atom(false, name.as_bytes()).unwrap();
        atom.reply().unwrap().atom
    };
    let data = [atom("WM_DELETE_WINDOW"), 0, 0, 0, 0];
    let message = ClientMessageEvent::new(32, window, atom("WM_PROTOCOLS"), data);
    let sent = display
        .x
        .send_event(false, window, xproto::EventMask::NO_EVENT, message);
    sent.unwrap().check().unwrap();
}

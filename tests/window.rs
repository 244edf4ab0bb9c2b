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
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    self, AtomEnum, ClientMessageEvent, ConfigureWindowAux, ConnectionExt as _, CreateWindowAux,
    ImageFormat, InputFocus, PropMode, SelectionNotifyEvent, WindowClass,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

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

    fn atom(&self, name: &str) -> u32 {
        let atom = self.x.intern_atom(false, name.as_bytes()).unwrap();
        atom.reply().unwrap().atom
    }

    /// Gives a window the keys.
    fn focus(&self, window: u32) {
        let asked = self.x.set_input_focus(InputFocus::PARENT, window, 0u32);
        asked.unwrap().check().unwrap();
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

impl Display {
    /// Waits until much of the screen is another than before; a cursor may blink in it.
    fn changed(&self, what: &str, before: &[[u8; 4]]) {
        let start = Instant::now();
        let differs = |now: &[[u8; 4]]| now.iter().zip(before).filter(|(a, b)| a != b).count();
        while differs(&self.pixels()) < 10_000 {
            assert!(start.elapsed() < PATIENCE, "waited for {what}");
            std::thread::sleep(Duration::from_millis(100));
        }
        // The field takes the keys one frame later.
        std::thread::sleep(Duration::from_millis(500));
    }
}

/// Pixels in the middle of the window that are neither white nor gray: the model's colors.
fn colored(pixels: &[[u8; 4]]) -> usize {
    let rows = pixels.chunks(usize::from(SIZE[0])).skip(150).take(450);
    let middle = rows.flat_map(|row| &row[300..900]);
    let is_colored = |p: &&[u8; 4]| p[0].abs_diff(p[1]) > 8 || p[1].abs_diff(p[2]) > 8;
    middle.filter(is_colored).count()
}

/// The best adapter's name.
fn adapter() -> String {
    let adapters = strataray::render::adapters();
    adapters
        .into_iter()
        .next()
        .map_or_else(|| "cpu".into(), |a| a.name)
}

fn viewer(display: &Display, case: &Path, config: &Path) -> Ends {
    let child = Command::new(env!("CARGO_BIN_EXE_strataray"))
        .arg(case)
        .env("DISPLAY", &display.name)
        .env_remove("WAYLAND_DISPLAY")
        // Without a session bus there is no dialog of a desktop.
        .env_remove("DBUS_SESSION_BUS_ADDRESS")
        .env("XDG_RUNTIME_DIR", config)
        .env("STRATARAY_CONFIG", config)
        // By shaders, where the tests of the window's contents have the executor that is taken by itself.
        .env("STRATARAY_ADAPTER", adapter())
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
const SHIFT: u32 = 0xffe1;
const RETURN: u32 = 0xff0d;

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
    display.focus(window);
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

/// Another program on the display: it reads the clipboard and puts text on it.
struct Other<'a> {
    display: &'a Display,
    window: u32,
}

impl<'a> Other<'a> {
    fn new(display: &'a Display) -> Self {
        let x = &display.x;
        let window = x.generate_id().unwrap();
        let shape = CreateWindowAux::new();
        let class = WindowClass::INPUT_OUTPUT;
        let made = x.create_window(0, window, display.root, 0, 0, 1, 1, 0, class, 0, &shape);
        made.unwrap().check().unwrap();
        Self { display, window }
    }

    /// The next event, if there is one within a while.
    fn event(&self) -> Option<Event> {
        for _ in 0..20 {
            if let Some(event) = self.display.x.poll_for_event().unwrap() {
                return Some(event);
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        None
    }

    /// The text on the clipboard; `None` where nobody has any.
    fn reads(&self) -> Option<String> {
        let Display { x, .. } = self.display;
        let [clipboard, utf8, here] =
            ["CLIPBOARD", "UTF8_STRING", "STRATARAY_TEST"].map(|n| self.display.atom(n));
        x.convert_selection(self.window, clipboard, utf8, here, 0u32)
            .unwrap()
            .check()
            .unwrap();
        while let Some(event) = self.event() {
            if let Event::SelectionNotify(answer) = event {
                (answer.property != 0).then_some(())?;
                let all = u32::MAX / 4;
                let property = x.get_property(true, self.window, here, AtomEnum::ANY, 0, all);
                return String::from_utf8(property.unwrap().reply().unwrap().value).ok();
            }
        }
        None
    }

    /// Waits until the clipboard has what is looked for.
    fn waits(&self, what: &str, holds: impl Fn(&str) -> bool) -> String {
        let start = Instant::now();
        loop {
            if let Some(text) = self.reads().filter(|t| holds(t)) {
                return text;
            }
            assert!(start.elapsed() < PATIENCE, "the clipboard never has {what}");
        }
    }

    /// Takes the clipboard.
    fn owns(&self) {
        let clipboard = self.display.atom("CLIPBOARD");
        let taken = self
            .display
            .x
            .set_selection_owner(self.window, clipboard, 0u32);
        taken.unwrap().check().unwrap();
    }

    /// Gives a text to who asks for what is on the clipboard, until `done`.
    fn gives(&self, text: &str, done: impl Fn() -> bool) {
        let Display { x, .. } = self.display;
        let [utf8, targets] = ["UTF8_STRING", "TARGETS"].map(|n| self.display.atom(n));
        let start = Instant::now();
        while !done() {
            assert!(start.elapsed() < PATIENCE, "nobody pastes");
            let Some(Event::SelectionRequest(asked)) = self.event() else {
                continue;
            };
            let (to, at) = (asked.requestor, asked.property);
            let replace = PropMode::REPLACE;
            let given = match asked.target == targets {
                true => x.change_property32(replace, to, at, AtomEnum::ATOM, &[targets, utf8]),
                false => x.change_property8(replace, to, at, utf8, text.as_bytes()),
            };
            given.unwrap().check().unwrap();
            let answer = SelectionNotifyEvent {
                response_type: xproto::SELECTION_NOTIFY_EVENT,
                sequence: 0,
                time: asked.time,
                requestor: to,
                selection: asked.selection,
                target: asked.target,
                property: at,
            };
            let sent = x.send_event(false, to, xproto::EventMask::NO_EVENT, answer);
            sent.unwrap().check().unwrap();
        }
    }
}

#[test]
fn text_goes_to_other_programs_and_comes_from_them() {
    let Some(display) = Display::start() else {
        return;
    };
    let config = tempfile::tempdir().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let case = common::copy_of_sample(folder.path());
    let mut process = viewer(&display, &case, config.path());
    let window = display.window();
    let first = display.settled("the first picture", |p| colored(p) > 5_000);
    display.focus(window);
    // The command line goes out, and runs as it stands, in another folder.
    let other = Other::new(&display);
    display.keys(&[CONTROL, SHIFT, u32::from(b'c')]);
    let line = other.waits("the command", |text| text.contains(" render "));
    let elsewhere = tempfile::tempdir().unwrap();
    let taken = elsewhere.path().join("scene.json");
    std::fs::write(&taken, "mine").unwrap();
    let run = Command::new("sh")
        .args(["-c", &line])
        .current_dir(elsewhere.path())
        .output();
    let run = run.unwrap();
    assert!(run.status.success(), "{line}\n{run:?}");
    assert_eq!(std::fs::read_to_string(&taken).unwrap(), "mine");
    let made = std::fs::read_dir(elsewhere.path()).unwrap().flatten();
    let made: Vec<_> = made.map(|e| e.path()).filter(|p| *p != taken).collect();
    assert_eq!(made.len(), 1, "{made:?}");
    let (width, height) = image::image_dimensions(&made[0]).unwrap();
    let wanted = format!("\"size\":[{width},{height}]");
    assert!(line.contains(&wanted) && width > 400, "{wanted}: {line}");
    // A path comes in: pasted into the sheet that asks for one, it is where the scene is saved.
    let file = folder.path().join("pasted scene.json");
    display.keys(&[CONTROL, u32::from(b's')]);
    display.changed("the sheet for a path", &first);
    other.owns();
    for keys in [
        &[CONTROL, u32::from(b'a')][..],
        &[CONTROL, u32::from(b'v')],
        &[RETURN],
    ] {
        display.keys(keys);
    }
    other.gives(&file.display().to_string(), || file.is_file());
    let saved = std::fs::read_to_string(&file).unwrap();
    assert!(saved.contains("\"property\""), "{saved}");
    close(&display, window);
    process.0.wait().unwrap();
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
    let data = [display.atom("WM_DELETE_WINDOW"), 0, 0, 0, 0];
    let message = ClientMessageEvent::new(32, window, display.atom("WM_PROTOCOLS"), data);
    let sent = display
        .x
        .send_event(false, window, xproto::EventMask::NO_EVENT, message);
    sent.unwrap().check().unwrap();
}

//! Keyboard shortcuts: one table for what they do and for the sheet that lists them.

use eframe::egui::{self, Context, Key, KeyboardShortcut, Modifiers};

/// A change of the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraMove {
    /// One of the standard views.
    From(usize),
    /// The model, from the same direction.
    FrameAll,
    /// The cells that are selected, or else those that are drawn, from the same direction.
    FrameSelection,
    /// Perspective or parallel.
    Projection,
    /// Turns to the right and up by steps, around the middle of the picture.
    Turn(i8, i8),
    /// Closer, or away.
    Zoom(bool),
}

/// What a shortcut does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Opens a case.
    Open,
    /// Adds files to the case: properties, names of faults, an INIT or restart of another name.
    AddFiles,
    /// Reads the case again.
    Reload,
    /// Saves the scene.
    SaveScene,
    /// Loads a scene.
    LoadScene,
    /// Saves the picture.
    Screenshot,
    /// Copies the command line that makes the picture.
    CopyLine,
    /// Takes the last change back.
    Undo,
    /// Makes it again.
    Redo,
    /// Plays or pauses.
    Play,
    /// Time steps forward or back.
    Step(isize),
    /// To the first step, or the last.
    End(bool),
    /// To the next case that is open, or the one before, seen in the same way.
    Case(isize),
    /// Statistics over the open cases that have the grid of the one in front.
    Ensemble,
    /// Changes the camera.
    Camera(CameraMove),
    /// The next preset of the mouse's buttons.
    Mouse,
    /// To the next slice along the axis in use, or the one before.
    Slice(isize),
    /// To the next axis of slices, or the one before.
    SliceAxis(isize),
    /// Mouse, theme, size of letters.
    Settings,
    /// Curves over time.
    Curves,
    /// Cells as solid bodies, or rays through the volume.
    Mode,
    /// True places of the cells, or those by I, J and K.
    Space,
    /// The next strategy.
    NextStrategy,
    /// Lighting off, or soft.
    Light,
    /// Dark or light.
    Theme,
    /// Closes the tab.
    Close,
    /// Opens the tab that was closed last.
    Reopen,
    /// Saves a film.
    Film,
    /// Saves the values of the selected cells.
    SaveTable,
    /// Saves the summary vectors that are shown.
    SaveVectors,
    /// Writes the drawn cells, or their surfaces, for other programs.
    ExportCells,
    /// A second picture, or none.
    Compare,
    /// Selects no cell.
    Deselect,
    /// From the cell selected last to the one behind it on the ray of the click, or in front of it.
    AlongRay(isize),
    /// The picture alone, or with panels.
    Panels,
    /// What was not loaded.
    Notes,
    /// The sheet of shortcuts.
    Help,
}

const CTRL: Modifiers = Modifiers::COMMAND;
const CTRL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);
const CTRL_ALT: Modifiers = Modifiers::COMMAND.plus(Modifiers::ALT);
const SHIFT: Modifiers = Modifiers::SHIFT;
const NONE: Modifiers = Modifiers::NONE;

const fn turn(right: i8, up: i8) -> Command {
    Command::Camera(CameraMove::Turn(right, up))
}

const fn from(view: usize) -> Command {
    Command::Camera(CameraMove::From(view))
}

/// Every shortcut, with what it says in the sheet.
pub const SHORTCUTS: [(Modifiers, Key, Command, &str); 65] = [
    (CTRL, Key::O, Command::Open, "Open a case"),
    (
        CTRL_SHIFT,
        Key::O,
        Command::AddFiles,
        "Add files to the case",
    ),
    (NONE, Key::F5, Command::Reload, "Reload the case"),
    (CTRL, Key::S, Command::SaveScene, "Save the scene"),
    (CTRL, Key::L, Command::LoadScene, "Load a scene"),
    (NONE, Key::F12, Command::Screenshot, "Save an image"),
    (CTRL_SHIFT, Key::C, Command::CopyLine, "Copy as command"),
    (CTRL_SHIFT, Key::Z, Command::Redo, "Redo"),
    (CTRL, Key::Z, Command::Undo, "Undo"),
    (CTRL, Key::Y, Command::Redo, "Redo"),
    (NONE, Key::Space, Command::Play, "Play or pause"),
    // Keys with Shift first: without it they would fit too.
    (SHIFT, Key::ArrowRight, turn(1, 0), "Rotate right"),
    (SHIFT, Key::ArrowLeft, turn(-1, 0), "Rotate left"),
    (SHIFT, Key::ArrowUp, turn(0, 1), "Rotate up"),
    (SHIFT, Key::ArrowDown, turn(0, -1), "Rotate down"),
    (NONE, Key::ArrowRight, Command::Step(1), "Step forward"),
    (NONE, Key::ArrowLeft, Command::Step(-1), "Step back"),
    (NONE, Key::Home, Command::End(false), "First step"),
    (NONE, Key::End, Command::End(true), "Last step"),
    (
        CTRL,
        Key::PageDown,
        Command::Case(1),
        "Next open case, seen in the same way",
    ),
    (
        CTRL,
        Key::PageUp,
        Command::Case(-1),
        "Previous open case, seen in the same way",
    ),
    (
        CTRL_SHIFT,
        Key::E,
        Command::Ensemble,
        "Statistics over the open cases of this grid",
    ),
    (NONE, Key::PageDown, Command::Slice(1), "Next slice"),
    (NONE, Key::PageUp, Command::Slice(-1), "Previous slice"),
    (
        SHIFT,
        Key::PageDown,
        Command::SliceAxis(1),
        "Slices along the next axis",
    ),
    (
        SHIFT,
        Key::PageUp,
        Command::SliceAxis(-1),
        "Slices along the previous axis",
    ),
    (CTRL_ALT, Key::N, from(0), "Look north"),
    (CTRL_ALT, Key::S, from(1), "Look south"),
    (CTRL_ALT, Key::E, from(2), "Look east"),
    (CTRL_ALT, Key::W, from(3), "Look west"),
    (CTRL_ALT, Key::T, from(4), "View from above"),
    (CTRL_ALT, Key::I, from(5), "Isometric view"),
    (CTRL_ALT, Key::B, from(6), "View from below"),
    (NONE, Key::Num1, from(0), "Look north"),
    (NONE, Key::Num3, from(3), "Look west"),
    (NONE, Key::Num7, from(4), "View from above"),
    (NONE, Key::Num9, from(5), "Isometric view"),
    (
        NONE,
        Key::Num5,
        Command::Camera(CameraMove::Projection),
        "Perspective or parallel",
    ),
    (
        NONE,
        Key::F,
        Command::Camera(CameraMove::FrameAll),
        "Frame all",
    ),
    (
        NONE,
        Key::Z,
        Command::Camera(CameraMove::FrameSelection),
        "Frame the selection, or all drawn cells",
    ),
    (
        NONE,
        Key::Plus,
        Command::Camera(CameraMove::Zoom(true)),
        "Zoom in",
    ),
    (
        NONE,
        Key::Equals,
        Command::Camera(CameraMove::Zoom(true)),
        "Zoom in",
    ),
    (
        NONE,
        Key::Minus,
        Command::Camera(CameraMove::Zoom(false)),
        "Zoom out",
    ),
    (CTRL, Key::M, Command::Mouse, "Next mouse preset"),
    (CTRL, Key::Comma, Command::Settings, "Settings"),
    (
        CTRL,
        Key::G,
        Command::Curves,
        "Curves of the selected cells, wells and summary vectors",
    ),
    (
        CTRL_SHIFT,
        Key::G,
        Command::SaveVectors,
        "Save the summary vectors shown",
    ),
    (NONE, Key::V, Command::Mode, "Cells or volume"),
    (NONE, Key::I, Command::Space, "Map, or IJK (simbox)"),
    (NONE, Key::S, Command::NextStrategy, "Next strategy"),
    (NONE, Key::Q, Command::Light, "Occlusion on or off"),
    (CTRL, Key::D, Command::Theme, "Dark or light theme"),
    (CTRL, Key::W, Command::Close, "Close the case"),
    (
        CTRL_SHIFT,
        Key::T,
        Command::Reopen,
        "Reopen the closed case",
    ),
    (CTRL, Key::F12, Command::Film, "Save an animation"),
    (
        CTRL_SHIFT,
        Key::S,
        Command::SaveTable,
        "Save the values of the selected cells",
    ),
    (CTRL, Key::E, Command::ExportCells, "Export the drawn cells"),
    (NONE, Key::C, Command::Compare, "Compare two pictures"),
    (
        NONE,
        Key::Escape,
        Command::Deselect,
        "Close the dialog, or deselect all cells",
    ),
    (
        NONE,
        Key::Comma,
        Command::AlongRay(-1),
        "Select the cell in front, along the line of sight",
    ),
    (
        NONE,
        Key::Period,
        Command::AlongRay(1),
        "Select the cell behind, along the line of sight",
    ),
    (CTRL, Key::B, Command::Panels, "Show or hide the panels"),
    (CTRL, Key::N, Command::Notes, "Notes on what was not loaded"),
    (NONE, Key::F1, Command::Help, "Keyboard shortcuts"),
    (
        Modifiers::SHIFT,
        Key::Questionmark,
        Command::Help,
        "Keyboard shortcuts",
    ),
];

/// What was pressed in this frame; nothing while text is being typed, and no arrows, letters or space
/// while a control has the focus, whose keys they are.
pub fn pressed(ctx: &Context) -> Vec<Command> {
    if ctx.text_edit_focused() {
        return Vec::new();
    }
    let is_focused = ctx.memory(|m| m.focused().is_some());
    // Escape closes a menu or list that is open, by itself.
    let is_open = egui::Popup::is_any_open(ctx);
    let taken = |(modifiers, key, command, _): &(Modifiers, Key, Command, &str)| {
        let is_function = (Key::F1..=Key::F35).contains(key);
        if is_focused && !modifiers.command && !is_function || is_open && *key == Key::Escape {
            return None;
        }
        let shortcut = KeyboardShortcut::new(*modifiers, *key);
        ctx.input_mut(|i| i.consume_shortcut(&shortcut))
            .then_some(*command)
    };
    // A shortcut is also taken with more modifiers than it has, so those with most come first.
    let mut shortcuts: Vec<_> = SHORTCUTS.iter().collect();
    let count = |m: &Modifiers| {
        [m.command, m.shift, m.alt]
            .map(usize::from)
            .iter()
            .sum::<usize>()
    };
    shortcuts.sort_by_key(|s| std::cmp::Reverse(count(&s.0)));
    shortcuts.into_iter().filter_map(taken).collect()
}

/// How a shortcut is written.
pub fn text(ctx: &Context, modifiers: Modifiers, key: Key) -> String {
    ctx.format_shortcut(&KeyboardShortcut::new(modifiers, key))
}

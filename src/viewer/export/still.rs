//! A picture for a file as the window shows it: alone or compared, with what is written and marked on it.

use std::path::Path;
use std::sync::Arc;

use super::{Compared, ExportSpec, Fallible};
use crate::case::Case;
use crate::image::metrics::{Comparison, ciede2000_map};
use crate::image::{Image, Rgb8};
use crate::picture::compared::{
    beside, cropped, differing, draw_legend, halves, wipe, write_own, write_title,
};
use crate::picture::{Annotations, Format, Shot, difference_colors, write_exr, write_png};
use crate::render::{self, Executor, Renderer};
use crate::scene::Scene;
use crate::view::View;
use crate::viewer::render_session::{DIFFERENCE_SCALE, difference_title};
use crate::viewer::state::CompareLayout;

/// Makes one picture.
pub fn still(spec: &ExportSpec, path: &Path, progress: &dyn Fn(f64) -> bool) -> Fallible<()> {
    let format = Format::from_path(path)?;
    let mut renderer = StillRenderer::new()?;
    if format == Format::Exr {
        if spec.compared.is_some() {
            return Err(format!(
                "{}: two images side by side are saved as .png",
                path.display()
            )
            .into());
        }
        let case = spec.case.in_space(spec.scene.space);
        let shot = Shot::of(&spec.scene, &case, true)?;
        let image = renderer.image(&case, &shot.view, progress)?;
        write_exr(path, &image)?;
        return Ok(());
    }
    let picture = match &spec.compared {
        Some(compared) => renderer.both(spec, compared, progress)?,
        None => {
            renderer
                .picture(spec, &spec.case, &spec.scene, progress)?
                .rgb
        }
    };
    write_png(path, picture.size, &picture.pixels)?;
    Ok(())
}

/// The device, and the grid that it has.
struct StillRenderer {
    executor: Arc<dyn Executor>,
    renderer: Option<Box<dyn Renderer>>,
}

/// A picture as it is seen, and its view.
struct Finished {
    rgb: Rgb8,
    view: View,
}

impl StillRenderer {
    fn new() -> Fallible<Self> {
        Ok(Self {
            executor: render::executor(None)?,
            renderer: None,
        })
    }

    /// The image of a view.
    fn image(
        &mut self,
        case: &Case,
        view: &View,
        progress: &dyn Fn(f64) -> bool,
    ) -> Fallible<Image> {
        let kept = self.renderer.take();
        let renderer = match kept.filter(|kept| Arc::ptr_eq(kept.grid(), &case.grid)) {
            Some(kept) => self.renderer.insert(kept),
            None => self.renderer.insert(self.executor.renderer(&case.grid)?),
        };
        Ok(renderer.render(view, progress)?.image)
    }

    /// A scene with what is written and marked on it.
    fn picture(
        &mut self,
        spec: &ExportSpec,
        case: &Arc<Case>,
        scene: &Scene,
        progress: &dyn Fn(f64) -> bool,
    ) -> Fallible<Finished> {
        let case = &case.in_space(scene.space);
        let shot = Shot {
            marked: spec.marked.clone(),
            ..Shot::of(scene, case, spec.plain)?
        };
        let image = self.image(case, &shot.view, progress)?;
        Ok(Finished {
            rgb: shot.finished(&image, case),
            view: shot.view,
        })
    }

    /// Two pictures as the window shows them.
    fn both(
        &mut self,
        spec: &ExportSpec,
        compared: &Compared,
        progress: &dyn Fn(f64) -> bool,
    ) -> Fallible<Rgb8> {
        let size = spec.scene.size;
        let sizes = match compared.layout {
            CompareLayout::Beside => halves(size),
            _ => [size; 2],
        };
        let is_colors = compared.layout == CompareLayout::ColorDifference;
        let spec = &ExportSpec {
            plain: spec.plain || is_colors,
            marked: if is_colors {
                Vec::new()
            } else {
                spec.marked.clone()
            },
            ..spec.clone()
        };
        let cases = [&spec.case, &compared.case];
        let mut made = Vec::new();
        for (n, scene) in [&spec.scene, &compared.scene].into_iter().enumerate() {
            let scene = Scene {
                size: sizes[n],
                ..scene.clone()
            };
            let half = |part: f64| progress(0.5 * (part + n as f64));
            made.push(self.picture(spec, cases[n], &scene, &half)?);
        }
        let [a, b] = made.try_into().map_err(|_| "two images were not made")?;
        if is_colors {
            return color_difference(&a.rgb, &b.rgb);
        }
        let texts = match spec.plain {
            true => [String::new(), String::new()],
            false => differing([(cases[0], &a.view), (cases[1], &b.view)]),
        };
        Ok(match compared.layout {
            CompareLayout::Wipe(at) => wiped(cases[0], [a, b], &texts, at, spec.plain),
            _ => {
                let pictures = [(a, &texts[0]), (b, &texts[1])].map(|(mut p, text)| {
                    let size = p.rgb.size;
                    own(&mut p.rgb, &p.view, size, 0, text);
                    p.rgb
                });
                beside([&pictures[0], &pictures[1]])
            }
        })
    }
}

fn own(rgb: &mut Rgb8, view: &View, size: [u32; 2], column: u32, text: &str) {
    if !text.is_empty() {
        write_own(rgb, view, size, column, text);
    }
}

/// The second picture over the first one, right of a part of the width. Where both show other properties, the
/// first one has its legend in what is seen of it.
fn wiped(case: &Case, [a, b]: [Finished; 2], texts: &[String; 2], at: f64, plain: bool) -> Rgb8 {
    let size = a.rgb.size;
    let column = (at.clamp(0.0, 1.0) * f64::from(size[0])).round() as u32;
    let mut left = cropped(&a.rgb, column);
    let annotations = Annotations::of(case, &a.view);
    if !plain && annotations.show_legend && a.view.shown.property != b.view.shown.property {
        draw_legend(&mut left, &a.view, &annotations, size);
    }
    own(&mut left, &a.view, size, 0, &texts[0]);
    let mut right = b.rgb;
    own(&mut right, &b.view, size, column, &texts[1]);
    wipe([&left, &right], at)
}

/// The map of CIEDE2000 with its figures.
fn color_difference(a: &Rgb8, b: &Rgb8) -> Fallible<Rgb8> {
    let figures = Comparison::of(a, b)?;
    let differences = ciede2000_map(&a.pixels, &b.pixels).unwrap_or_default();
    let mut map = difference_colors(&differences, a.size, DIFFERENCE_SCALE);
    write_title(&mut map, &difference_title(&figures));
    Ok(map)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::picture::film::FilmFormat;
    use crate::scene::StepSpec;
    use crate::viewer::export::ExportKind;

    const SIZE: [u32; 2] = [480, 240];

    fn spec() -> ExportSpec {
        let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/scissor/SCISSOR.EGRID");
        ExportSpec {
            case: Arc::new(crate::case::load::open(&sample).unwrap()),
            scene: Scene {
                size: SIZE,
                ..Scene::default()
            },
            kind: ExportKind::Still,
            format: FilmFormat::Gif,
            plain: true,
            compared: None,
            marked: Vec::new(),
        }
    }

    fn at_first_step(spec: &ExportSpec, layout: CompareLayout) -> Compared {
        Compared {
            case: spec.case.clone(),
            scene: Scene {
                step: StepSpec::Index(0),
                ..spec.scene.clone()
            },
            layout,
        }
    }

    fn saved(spec: &ExportSpec, folder: &Path) -> Vec<[u8; 3]> {
        let file = folder.join("saved.png");
        still(spec, &file, &|_| true).unwrap();
        let picture = image::open(&file).unwrap().into_rgb8();
        assert_eq!([picture.width(), picture.height()], SIZE);
        picture.pixels().map(|p| p.0).collect()
    }

    /// Pixels that differ in the left and in the right half.
    fn apart(a: &[[u8; 3]], b: &[[u8; 3]]) -> [usize; 2] {
        let mut counts = [0; 2];
        for (n, _) in a.iter().zip(b).enumerate().filter(|(_, (a, b))| a != b) {
            counts[usize::from(n % SIZE[0] as usize >= SIZE[0] as usize / 2)] += 1;
        }
        counts
    }

    #[test]
    fn what_is_on_screen_is_saved() {
        if render::executor(None).is_err() {
            assert!(std::env::var_os("REQUIRE_GPU").is_none());
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        let alone = spec();
        let one = saved(&alone, folder.path());
        let with = |layout| ExportSpec {
            compared: Some(at_first_step(&alone, layout)),
            ..alone.clone()
        };
        // Left of a wipe the picture is what it was, right of it the other one.
        let wiped = apart(&one, &saved(&with(CompareLayout::Wipe(0.5)), folder.path()));
        assert!(wiped[0] <= SIZE[1] as usize && wiped[1] > 500, "{wiped:?}");
        // Beside each other both are smaller.
        let both = saved(&with(CompareLayout::Beside), folder.path());
        let columns = apart(&one, &both);
        assert!(columns[0] > 500 && columns[1] > 500, "{columns:?}");
        // What each has of its own is written on it, unless it is to be plain.
        let named = ExportSpec {
            plain: false,
            scene: Scene {
                show: crate::scene::Show {
                    legend: false,
                    r#box: false,
                    ..crate::scene::Show::default()
                },
                ..alone.scene.clone()
            },
            ..alone.clone()
        };
        let named = ExportSpec {
            compared: Some(at_first_step(&named, CompareLayout::Beside)),
            ..named
        };
        let words = apart(&both, &saved(&named, folder.path()));
        assert!(words[0] > 20 && words[1] > 20, "{words:?}");
        // Colors of the two, and a picture for values in linear light, which only one has.
        let colors = saved(&with(CompareLayout::ColorDifference), folder.path());
        assert!(colors.iter().filter(|p| **p == [0, 0, 4]).count() > 1000);
        let exr = folder.path().join("both.exr");
        let error = still(&with(CompareLayout::Beside), &exr, &|_| true).unwrap_err();
        assert!(error.to_string().contains(".png"), "{error}");
    }

    #[test]
    fn marks_of_selected_cells_are_saved() {
        if render::executor(None).is_err() {
            assert!(std::env::var_os("REQUIRE_GPU").is_none());
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        let plain = spec();
        let marked = ExportSpec {
            marked: vec![[20, 15, 1], [999, 1, 1]],
            ..spec()
        };
        let [plain, marked] = [&plain, &marked].map(|spec| saved(spec, folder.path()));
        let count = apart(&plain, &marked).iter().sum::<usize>();
        assert!((20..4000).contains(&count), "{count}");
    }
}

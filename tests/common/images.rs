//! Images of a view by each strategy and by the reference.

use strataray::case::Case;
use strataray::image::Image;
use strataray::reference;
use strataray::render::Renderer;
use strataray::render::gpu::GpuRenderer;
use strataray::scene::StrategyKind;
use strataray::view::View;

/// The strategies, and the reference as none of them.
pub fn all() -> impl Iterator<Item = Option<StrategyKind>> {
    StrategyKind::ALL.into_iter().map(Some).chain([None])
}

/// The picture by a strategy, which loses no ray, or by the reference where there is none.
pub fn picture(
    renderer: &mut GpuRenderer,
    case: &Case,
    view: &View,
    by: Option<StrategyKind>,
) -> Image {
    let Some(strategy) = by else {
        return reference::render(&case.grid, view, &|_| true).unwrap();
    };
    let frame = renderer.render(&view.by(strategy), &|_| true).unwrap();
    assert_eq!(frame.stats.lost_rays, 0);
    frame.image
}

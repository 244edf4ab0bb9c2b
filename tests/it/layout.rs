//! Host mirrors against `shaders/shared/layout.wgsl`: names, offsets, spans, constants.

use std::collections::{BTreeMap, BTreeSet};
use std::mem::{offset_of, size_of};

use strataray::model::topology;
use strataray::render::gpu::shader;
use strataray::render::plan::columns::COLUMN_MARGINS;
use strataray::render::plan::layout::{
    self, BlurInfo, BricksInfo, Emitter, Found, Frame, GridInfo, LightingInfo, PaintInfo, Slab,
    Tile, VolumeInfo,
};
use strataray::view::{lighting, surfaces};
use wgpu::naga::front::wgsl;
use wgpu::naga::{Expression, Literal, Module, TypeInner};

/// Both sides' text, to find what the other lacks.
const HOST: &str = include_str!("../../src/render/plan/layout.rs");

fn module() -> Module {
    wgsl::parse_str(&shader::compose("layout").unwrap()).unwrap()
}

/// Member names with offsets, and the span, of a WGSL struct.
fn members(module: &Module, name: &str) -> (Vec<(String, usize)>, usize) {
    let found = module
        .types
        .iter()
        .find(|(_, t)| t.name.as_deref() == Some(name));
    let Some((_, ty)) = found else {
        panic!("{name} is not in layout.wgsl")
    };
    let TypeInner::Struct { members, span } = &ty.inner else {
        panic!("{name} is no struct")
    };
    let list = members
        .iter()
        .map(|m| (m.name.clone().unwrap(), m.offset as usize));
    (list.collect(), *span as usize)
}

macro_rules! agrees {
    ($module:expr, $type:ident, $($field:ident),*) => {{
        let host = vec![$((stringify!($field).to_owned(), offset_of!($type, $field))),*];
        let (wgsl, span) = members($module, stringify!($type));
        assert_eq!(wgsl, host, stringify!($type));
        // A uniform's span is rounded up; the host may end earlier by trailing padding only.
        assert_eq!(span, size_of::<$type>(), stringify!($type));
        stringify!($type)
    }};
}

/// Compares the structs of a frame, and gives their names.
fn structs_of_frames(m: &Module) -> Vec<&'static str> {
    vec![
        agrees!(
            m,
            Frame,
            eye,
            step,
            forward,
            early_termination,
            right,
            value_low,
            up,
            value_scale,
            grid_from_world_x,
            width,
            grid_from_world_y,
            height,
            grid_from_world_z,
            interpolation,
            box_low,
            clip_count,
            box_high,
            opaque_cuts,
            view_x,
            farthest,
            view_y,
            world_handedness,
            view_z,
            grid_handedness,
            origin_right,
            is_parallel,
            origin_up,
            rays_across,
            headlight,
            headlight_scale,
            ghost,
            clip_planes
        ),
        agrees!(
            m,
            Tile,
            origin,
            size,
            resume,
            work_limit,
            layers,
            part_width,
            part_origin,
            reserved
        ),
        agrees!(
            m, PaintInfo, palette, faint, faults, layer, first_row, rows, look, facing, edge_on,
            reserved
        ),
        agrees!(
            m,
            GridInfo,
            ni,
            nj,
            nk,
            bins_x,
            bins_y,
            ghosts,
            bin_origin,
            bin_size,
            depth_low,
            depth_scale,
            column_lists,
            bins,
            bin_columns,
            visible
        ),
    ]
}

fn structs_of_volumes(m: &Module) -> Vec<&'static str> {
    vec![
        agrees!(
            m,
            VolumeInfo,
            box_low,
            value_low,
            box_extent,
            value_scale,
            size,
            interpolation
        ),
        agrees!(m, Slab, first, row, size, level),
        agrees!(
            m,
            BricksInfo,
            count,
            levels,
            position_low,
            position_scale,
            empty,
            even,
            thin,
            averages,
            reserved0,
            reserved1
        ),
        agrees!(
            m, Found, column, layer, reserved0, reserved1, parameters, value
        ),
    ]
}

fn structs_of_light(m: &Module) -> Vec<&'static str> {
    vec![
        agrees!(
            m,
            BlurInfo,
            axis,
            source_count,
            made_count,
            deviation,
            box_low,
            position_low,
            spacing,
            position_scale,
            sigma,
            ghost,
            clip_count,
            counts,
            clip_planes
        ),
        agrees!(
            m,
            LightingInfo,
            box_low,
            sigma,
            scale,
            strength,
            size,
            ambient,
            light_size,
            volumes,
            emitters,
            levels,
            position_low,
            position_scale,
            rays,
            seed,
            step,
            gradient_scale,
            work,
            rays_gap,
            around,
            around_attenuation
        ),
        agrees!(
            m, Emitter, at, kind, axis, cos_outer, color, cos_inner, first, ones, threes, sevens,
            tangent, cosine, length, volume
        ),
    ]
}

#[test]
fn structs_agree_and_none_is_missing() {
    let text = shader::compose("layout").unwrap();
    let m = &module();
    let compared = [structs_of_frames, structs_of_volumes, structs_of_light];
    let compared: BTreeSet<&str> = compared.iter().flat_map(|of| of(m)).collect();
    let structs = |text: &str| -> BTreeSet<String> {
        let module = wgsl::parse_str(text).unwrap();
        let structs = module.types.iter();
        let structs = structs.filter(|(_, t)| matches!(t.inner, TypeInner::Struct { .. }));
        structs.map(|(_, t)| t.name.clone().unwrap()).collect()
    };
    let missing = |text: &str| {
        let found = structs(text).into_iter();
        found
            .filter(|name| !compared.contains(name.as_str()))
            .collect::<Vec<_>>()
    };
    assert_eq!(missing(&text), Vec::<String>::new());
    // The twin: a struct that the host does not know.
    let more = format!("{text}\nstruct Sheet {{ depth: f32 }}");
    assert_eq!(missing(&more), ["Sheet"]);
}

/// A constant.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Number {
    U32(u32),
    F32(f32),
}

/// What shaders tell each other and the host never asks: how SRG passes a brick.
const AMONG_SHADERS: [&str; 4] = ["PASS_PLAIN", "PASS_EMPTY", "PASS_EVEN", "PASS_THIN"];

/// The host's constants by the names that shaders give them.
fn twins() -> BTreeMap<String, Number> {
    let whole = [
        ("INTERPOLATION_CELL", layout::INTERPOLATION_CELL),
        ("INTERPOLATION_VERTEX", layout::INTERPOLATION_VERTEX),
        ("LUT_SIZE", layout::LUT_SIZE),
        ("LUT_ROW", layout::LUT_ROW),
        ("EMITTER_TEXELS", layout::EMITTER_TEXELS),
        ("NOT_FOUND", layout::NOT_FOUND),
        ("LIST_GAPPED", layout::LIST_GAPPED),
        ("COLUMN_FLAG", layout::COLUMN_FLAG),
        ("LIST_OFFSET", layout::LIST_OFFSET),
        ("BIN_IS_ODD", layout::BIN_IS_ODD),
        ("MAX_CLIP_PLANES", layout::MAX_CLIP_PLANES as u32),
        ("BLOCK", layout::BLOCK),
        ("BLOCK_WORDS", layout::BLOCK_WORDS),
        ("BRICK", layout::BRICK),
        ("RUN", layout::RUN),
        ("SHEET_LAYERS", layout::SHEET_LAYERS),
        ("PAINT_WORK", layout::PAINT_WORK),
        ("FAULT_COLORS", layout::FAULT_COLORS as u32),
        ("RAY_STATE", layout::RAY_STATE),
        ("LIBC_STATE", layout::LIBC_STATE),
        ("WORK_VALUES", layout::WORK_VALUES),
        ("WORK_GAUSSIAN", layout::WORK_GAUSSIAN),
        ("WORK_MEAN", layout::WORK_MEAN),
        ("COUNTERS", layout::COUNTERS),
        ("COUNT_SAMPLES", layout::COUNT_SAMPLES),
        ("COUNT_ITERATIONS", layout::COUNT_ITERATIONS),
        ("COUNT_STEPS", layout::COUNT_STEPS),
        ("COUNT_FALLBACKS", layout::COUNT_FALLBACKS),
        ("COUNT_FINISHED", layout::COUNT_FINISHED),
        ("COUNT_WORK", layout::COUNT_WORK),
        ("COUNT_PEELS", layout::COUNT_PEELS),
        ("COUNT_RECOVERED", layout::COUNT_RECOVERED),
        ("COUNT_LOST", layout::COUNT_LOST),
        ("COUNT_PAUSED", layout::COUNT_PAUSED),
        ("COUNT_ENTRIES", layout::COUNT_ENTRIES),
        ("COUNT_SECTIONS", layout::COUNT_SECTIONS),
        ("COUNT_CROSSINGS", layout::COUNT_CROSSINGS),
        ("COUNT_LOST_SAMPLES", layout::COUNT_LOST_SAMPLES),
        ("COUNT_CUBE", layout::COUNT_CUBE),
        ("EMITTER_DIRECTIONAL", layout::EMITTER_DIRECTIONAL),
        ("EMITTER_POINT", layout::EMITTER_POINT),
        ("EMITTER_SPOT", layout::EMITTER_SPOT),
        ("LOOK_COLORED", layout::LOOK_COLORED),
        ("LOOK_FAINT", layout::LOOK_FAINT),
        ("LOOK_TUBE", layout::LOOK_TUBE),
        ("PACKED_SHIFT", layout::PACKED_SHIFT),
        ("PACKED_COVERAGE", layout::PACKED_COVERAGE),
        ("PACKED_VALUES", layout::PACKED_VALUES),
        ("PACKED_GHOST", layout::PACKED_GHOST),
        ("LIGHT_OFF", layout::LIGHT_OFF),
        ("LIGHT_IMAGE", layout::LIGHT_IMAGE),
        ("LIGHT_VOLUME", layout::LIGHT_VOLUME),
        ("LIGHT_RAYS", layout::LIGHT_RAYS),
        ("METHOD_CONES", layout::METHOD_CONES),
        ("METHOD_SURROUND", layout::METHOD_SURROUND),
        ("METHOD_SPAO_MIPMAP", layout::METHOD_SPAO_MIPMAP),
        ("METHOD_VCT", layout::METHOD_VCT),
        ("METHOD_SAT", layout::METHOD_SAT),
        ("SUM_PARTS", layout::SUM_PARTS),
        ("VCT_MEANS", layout::VCT_MEANS),
        ("VCT_DEVIATIONS", layout::VCT_DEVIATIONS),
    ];
    let real = [
        ("GRADIENT_FADE_LOW", lighting::GRADIENT_FADE[0]),
        ("GRADIENT_FADE_HIGH", lighting::GRADIENT_FADE[1]),
        ("SPECULAR", lighting::SPECULAR),
        ("SHININESS", lighting::SHININESS),
        ("SHEET_OPACITY", surfaces::SHEET_OPACITY),
        ("HEADLIGHT_AMBIENT", surfaces::HEADLIGHT_AMBIENT),
        ("EDGE_WIDTH", surfaces::EDGE_WIDTH),
        ("EDGE_DARKNESS", surfaces::EDGE_DARKNESS),
        ("EDGE_FADE_LOW", surfaces::EDGE_FADE[0]),
        ("EDGE_FADE_HIGH", surfaces::EDGE_FADE[1]),
        ("COINCIDENT", topology::COINCIDENT),
        ("DEEPEST", f64::from(strataray::render::plan::sat::DEEPEST)),
    ];
    let whole = whole.map(|(name, n)| (name.to_owned(), Number::U32(n)));
    let real = real.map(|(name, n)| (name.to_owned(), Number::F32(n as f32)));
    whole.into_iter().chain(real).collect()
}

/// The constants of a shader's text.
fn constants(text: &str) -> BTreeMap<String, Number> {
    let module = wgsl::parse_str(text).unwrap();
    let constants = module.constants.iter().map(|(_, constant)| {
        let name = constant.name.clone().unwrap();
        let number = match module.global_expressions[constant.init] {
            Expression::Literal(Literal::U32(value)) => Number::U32(value),
            Expression::Literal(Literal::F32(value)) => Number::F32(value),
            ref other => panic!("{name} is {other:?}"),
        };
        (name, number)
    });
    constants.collect()
}

/// Names of the constants that differ, or that one side lacks.
fn apart<'a>(
    shaders: &'a BTreeMap<String, Number>,
    host: &'a BTreeMap<String, Number>,
) -> BTreeSet<&'a str> {
    let names = shaders.keys().chain(host.keys());
    names
        .filter(|name| shaders.get(*name) != host.get(*name))
        .map(String::as_str)
        .collect()
}

#[test]
fn constants_agree_and_none_is_missing() {
    let text = shader::compose("layout").unwrap();
    let (shaders, mut host) = (constants(&text), twins());
    assert_eq!(apart(&shaders, &host), BTreeSet::from(AMONG_SHADERS));
    // Every constant of the host's module is one of the shaders' too.
    let declared = HOST.lines().filter_map(|l| l.strip_prefix("pub const "));
    let declared: Vec<&str> = declared.filter_map(|l| l.split(':').next()).collect();
    assert!(declared.len() > 30, "{declared:?}");
    for name in declared {
        assert!(host.contains_key(name), "{name}");
    }
    // The twins: another number, and one that the other side lacks.
    let other = text.replace("const BRICK: u32 = 8u", "const BRICK: u32 = 9u");
    let more = format!("{text}\nconst BRICKS: u32 = 8u;");
    for (text, name) in [(other, "BRICK"), (more, "BRICKS")] {
        let shaders = constants(&text);
        let mut apart = apart(&shaders, &host);
        assert!(apart.remove(name) && apart == BTreeSet::from(AMONG_SHADERS));
    }
    host.insert("GONE".into(), Number::U32(1));
    assert!(apart(&shaders, &host).contains("GONE"));
}

#[test]
fn margins_of_columns_agree() {
    let text = shader::compose("grid").unwrap();
    let has = |margins: &[f64]| {
        let list: Vec<String> = margins.iter().map(|m| format!("{m:?}")).collect();
        let count = margins.len();
        text.contains(&format!(
            "const COLUMN_MARGINS = array<f32, {count}>({});",
            list.join(", ")
        ))
    };
    assert!(has(&COLUMN_MARGINS));
    assert!(!has(&COLUMN_MARGINS[1..]));
}

#[test]
fn every_shader_is_valid() {
    for name in shader::ENTRIES {
        let text = shader::compose(name).unwrap();
        let module = wgsl::parse_str(&text)
            .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&text)));
        wgpu::naga::valid::Validator::new(
            wgpu::naga::valid::ValidationFlags::all(),
            // Packing half floats is WGSL's own; all that adapters must have.
            wgpu::naga::valid::Capabilities::default()
                | wgpu::naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32,
        )
        .validate(&module)
        .unwrap_or_else(|e| panic!("{name}: {e:?}"));
    }
    assert!(shader::compose("no_such_shader").is_err());
}

//! Layouts of bind groups, read from the shaders themselves.

use super::shader::compose;
use crate::render::RenderError;

/// Bind groups that all strategies share: 0 frame, 1 grid, 2 transfer function.
pub(super) const SHARED_GROUPS: usize = 3;

/// Storage buffers that a shader stage may use, which are as many as WebGPU grants by default: counters and ray states,
/// four of the grid, a strategy's own.
const STORAGE_BUFFERS: u32 = 8;
/// Buffers of parameters that a shader stage may use: frame, tile, grid, light, two of a shader's own.
const UNIFORM_BUFFERS: u32 = 6;

/// Layouts of the shared bind groups, read from the shaders that declare them.
///
/// So a bind group of the grid or the frame is made once and fits every pipeline.
pub struct SharedLayouts {
    groups: Vec<wgpu::BindGroupLayout>,
    parameters: Parameters,
}

/// How shaders read their parameters, which they declare as uniforms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameters {
    /// As declared: GPUs have caches for them.
    Uniform,
    /// As storage: llvmpipe compiles a compute shader anew at each dispatch, into memory that it keeps, where
    /// a uniform decides a branch or bounds a loop. At 250 x 250 pixels that took a third of a frame.
    Storage,
}

impl Parameters {
    /// The way of a name, `uniform` or `storage`.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "uniform" => Some(Self::Uniform),
            "storage" => Some(Self::Storage),
            _ => None,
        }
    }

    /// Storage buffers that a shader stage needs.
    pub fn storage_buffers(self) -> u32 {
        match self {
            Self::Uniform => STORAGE_BUFFERS,
            Self::Storage => STORAGE_BUFFERS + UNIFORM_BUFFERS,
        }
    }

    pub(super) fn declared(self, text: String) -> String {
        match self {
            Self::Uniform => text,
            Self::Storage => text.replace("var<uniform>", "var<storage, read>"),
        }
    }
}

impl SharedLayouts {
    /// Reads the layouts of the modules that declare the shared groups.
    ///
    /// # Errors
    /// When one of them is not valid, with the compiler's words.
    pub fn new(device: &wgpu::Device, parameters: Parameters) -> Result<Self, RenderError> {
        let module = parse("groups", &parameters.declared(compose("groups")?))?;
        let groups = 0..SHARED_GROUPS as u32;
        Ok(Self {
            groups: groups.map(|g| layout(device, &module, g)).collect(),
            parameters,
        })
    }

    /// How shaders read their parameters.
    pub fn parameters(&self) -> Parameters {
        self.parameters
    }

    /// The layout of a shared group.
    pub fn group(&self, group: usize) -> &wgpu::BindGroupLayout {
        &self.groups[group]
    }
}

pub(super) fn parse(name: &str, text: &str) -> Result<wgpu::naga::Module, RenderError> {
    wgpu::naga::front::wgsl::parse_str(text).map_err(|e| RenderError::Shader {
        name: name.to_owned(),
        message: e.emit_to_string(text),
    })
}

/// Group and binding of the global variables that have one.
pub(super) fn bindings(
    module: &wgpu::naga::Module,
) -> impl Iterator<Item = (u32, wgpu::BindGroupLayoutEntry)> {
    module.global_variables.iter().filter_map(|(_, variable)| {
        let binding = variable.binding.as_ref()?;
        let (ty, writes) = binding_type(variable, &module.types[variable.ty].inner)?;
        let entry = wgpu::BindGroupLayoutEntry {
            binding: binding.binding,
            // Vertex shaders that write need a feature of their own.
            visibility: match writes {
                true => wgpu::ShaderStages::FRAGMENT | wgpu::ShaderStages::COMPUTE,
                false => wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE,
            },
            ty,
            count: None,
        };
        Some((binding.group, entry))
    })
}

/// What kind of resource a variable is, and whether shaders write it.
fn binding_type(
    variable: &wgpu::naga::GlobalVariable,
    inner: &wgpu::naga::TypeInner,
) -> Option<(wgpu::BindingType, bool)> {
    use wgpu::naga::{AddressSpace, ImageClass, ImageDimension, StorageAccess, TypeInner};
    let buffer = |ty| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let dimension = |dim: ImageDimension| match dim {
        ImageDimension::D1 => wgpu::TextureViewDimension::D1,
        ImageDimension::D2 => wgpu::TextureViewDimension::D2,
        ImageDimension::D3 => wgpu::TextureViewDimension::D3,
        ImageDimension::Cube => wgpu::TextureViewDimension::Cube,
    };
    Some(match (variable.space, inner) {
        (AddressSpace::Uniform, _) => (buffer(wgpu::BufferBindingType::Uniform), false),
        (AddressSpace::Storage { access }, _) => {
            let writes = access.contains(StorageAccess::STORE);
            (
                buffer(wgpu::BufferBindingType::Storage { read_only: !writes }),
                writes,
            )
        }
        (_, TypeInner::Sampler { .. }) => (
            wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            false,
        ),
        (_, TypeInner::Image { dim, class, .. }) => match class {
            ImageClass::Storage { format, access } => (
                wgpu::BindingType::StorageTexture {
                    access: match (
                        access.contains(StorageAccess::LOAD),
                        access.contains(StorageAccess::STORE),
                    ) {
                        (true, true) => wgpu::StorageTextureAccess::ReadWrite,
                        (true, false) => wgpu::StorageTextureAccess::ReadOnly,
                        _ => wgpu::StorageTextureAccess::WriteOnly,
                    },
                    format: texture_format(*format)?,
                    view_dimension: dimension(*dim),
                },
                true,
            ),
            ImageClass::Sampled { kind, multi } => (
                wgpu::BindingType::Texture {
                    sample_type: match kind {
                        wgpu::naga::ScalarKind::Uint => wgpu::TextureSampleType::Uint,
                        wgpu::naga::ScalarKind::Sint => wgpu::TextureSampleType::Sint,
                        // Tables are read texel by texel; adapters need not filter what is as exact as that.
                        _ => wgpu::TextureSampleType::Float {
                            filterable: *dim == ImageDimension::D3,
                        },
                    },
                    view_dimension: dimension(*dim),
                    multisampled: *multi,
                },
                false,
            ),
            _ => return None,
        },
        _ => return None,
    })
}

/// The formats that this program writes from shaders.
fn texture_format(format: wgpu::naga::StorageFormat) -> Option<wgpu::TextureFormat> {
    use wgpu::naga::StorageFormat;
    Some(match format {
        StorageFormat::Rgba32Float => wgpu::TextureFormat::Rgba32Float,
        StorageFormat::Rgba16Float => wgpu::TextureFormat::Rgba16Float,
        StorageFormat::R32Float => wgpu::TextureFormat::R32Float,
        StorageFormat::R32Uint => wgpu::TextureFormat::R32Uint,
        _ => return None,
    })
}

pub(super) fn layout(
    device: &wgpu::Device,
    module: &wgpu::naga::Module,
    group: u32,
) -> wgpu::BindGroupLayout {
    let mut entries: Vec<_> = bindings(module)
        .filter_map(|(g, entry)| (g == group).then_some(entry))
        .collect();
    entries.sort_by_key(|e| e.binding);
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &entries,
    })
}

//! Pipelines, with bind group layouts read from the shaders themselves.

use std::panic::resume_unwind;
use std::sync::Arc;

use super::bind_groups::{SHARED_GROUPS, bindings, layout, parse};
use super::device::{Gpu, LateError};
use super::shader::compose;
use crate::render::RenderError;

/// A shader's module with the layout of its pipeline.
struct Compiled {
    module: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    own: wgpu::BindGroupLayout,
    entries: Vec<wgpu::naga::EntryPoint>,
}

impl Compiled {
    /// Invocations of a workgroup of an entry: each has its own.
    fn workgroup(&self, name: &str, entry: &str) -> Result<[u32; 3], RenderError> {
        let found = self.entries.iter().find(|e| e.name == entry);
        found
            .map(|e| e.workgroup_size)
            .ok_or_else(|| RenderError::Shader {
                name: name.to_owned(),
                message: format!("has no entry {entry}"),
            })
    }
}

/// A shader, compiled once.
fn compiled(gpu: &Gpu, name: &str) -> Result<Arc<Compiled>, RenderError> {
    let compile = || compile(gpu, name);
    gpu.compiled.get_or_make(name.to_owned(), compile)
}

fn compile(gpu: &Gpu, name: &str) -> Result<Compiled, RenderError> {
    let text = gpu.layouts.parameters().declared(compose(name)?);
    let module = parse(name, &text)?;
    let used = |group: usize| bindings(&module).any(|(g, _)| g as usize == group);
    let own = layout(&gpu.device, &module, SHARED_GROUPS as u32);
    let mut groups: Vec<Option<&wgpu::BindGroupLayout>> = (0..SHARED_GROUPS)
        .map(|g| used(g).then(|| gpu.layouts.group(g)))
        .collect();
    groups.push(used(SHARED_GROUPS).then_some(&own));
    while matches!(groups.last(), Some(None)) {
        groups.pop();
    }
    let layout = gpu
        .device
        .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(name),
            bind_group_layouts: &groups,
            ..Default::default()
        });
    let entries = module.entry_points;
    let module = gpu
        .device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
    Ok(Compiled {
        module,
        layout,
        own,
        entries,
    })
}

/// Runs `make` and turns what the driver refuses into an error that names the shader.
fn checked<T>(
    gpu: &Gpu,
    name: &str,
    make: impl FnOnce() -> Result<T, RenderError>,
) -> Result<T, RenderError> {
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let made = make()?;
    match pollster::block_on(scope.pop()) {
        Some(error) => Err(RenderError::Shader {
            name: name.to_owned(),
            message: error.to_string(),
        }),
        None => Ok(made),
    }
}

/// The value of an `override` constant that is true or false.
pub fn flag(is_set: bool) -> f64 {
    f64::from(u8::from(is_set))
}

/// A compute pipeline from an entry of a shader, with its workgroup size as the shader states it.
pub struct Pipeline {
    /// The pipeline.
    pub pipeline: wgpu::ComputePipeline,
    /// Layout of bind group 3, the shader's own.
    pub own: wgpu::BindGroupLayout,
    /// Invocations of a workgroup along x, y and z.
    pub workgroup: [u32; 3],
    /// Shader and entry.
    name: String,
    /// Workgroups along an axis that the device takes at once, and where a dispatch of more is told.
    most_groups: u32,
    late_error: Arc<LateError>,
}

impl Pipeline {
    /// An entry of shader `name` with values for its `override` constants, compiled where it is not there yet.
    ///
    /// # Errors
    /// When it is not valid, with the compiler's words.
    pub fn variant(
        gpu: &Gpu,
        name: &str,
        entry: &str,
        constants: &[(&str, f64)],
    ) -> Result<Arc<Self>, RenderError> {
        let key = format!("{name} {entry} {constants:?}");
        let compile = || Self::compile(gpu, name, entry, constants);
        gpu.compiled.get_or_make(key, compile)
    }

    /// As [`Self::variant`], several entries with their constants side by side.
    pub fn variants<const N: usize>(
        gpu: &Gpu,
        name: &str,
        wanted: [(&str, &[(&str, f64)]); N],
    ) -> [Result<Arc<Self>, RenderError>; N] {
        // The shader itself is not to be compiled by each of them; each tells what is wrong with it.
        let _ = checked(gpu, name, || compiled(gpu, name));
        std::thread::scope(|scope| {
            let threads = wanted.map(|(entry, constants)| {
                scope.spawn(move || Self::variant(gpu, name, entry, constants))
            });
            let outcome = |thread: std::thread::ScopedJoinHandle<'_, _>| {
                thread.join().unwrap_or_else(|panic| resume_unwind(panic))
            };
            threads.map(outcome)
        })
    }

    fn compile(
        gpu: &Gpu,
        name: &str,
        entry: &str,
        constants: &[(&str, f64)],
    ) -> Result<Self, RenderError> {
        checked(gpu, name, || {
            let compiled = compiled(gpu, name)?;
            let workgroup = compiled.workgroup(name, entry)?;
            let descriptor = wgpu::ComputePipelineDescriptor {
                label: Some(name),
                layout: Some(&compiled.layout),
                module: &compiled.module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants,
                    ..Default::default()
                },
                cache: None,
            };
            Ok(Self {
                pipeline: gpu.device.create_compute_pipeline(&descriptor),
                own: compiled.own.clone(),
                workgroup,
                name: format!("{name}, {entry}"),
                most_groups: gpu.device.limits().max_compute_workgroups_per_dimension,
                late_error: gpu.late_error.clone(),
            })
        })
    }

    /// Records a pass that covers `size` invocations, with bind groups by their number.
    pub fn dispatch(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        groups: &[(u32, &wgpu::BindGroup)],
        size: [u32; 3],
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        for (number, group) in groups {
            pass.set_bind_group(*number, *group, &[]);
        }
        self.record(&mut pass, size);
    }

    /// Records what covers `size` invocations in a pass whose bind groups are set. Where the device takes
    /// fewer workgroups nothing is recorded, and [`Gpu::check`] fails.
    pub fn record(&self, pass: &mut wgpu::ComputePass<'_>, size: [u32; 3]) {
        let groups = self.groups_for(size);
        if groups.iter().any(|&n| n > self.most_groups) {
            self.late_error.keep(RenderError::TooManyGroups {
                shader: self.name.clone(),
                groups,
                limit: self.most_groups,
            });
            return;
        }
        let [x, y, z] = groups;
        pass.set_pipeline(&self.pipeline);
        pass.dispatch_workgroups(x, y, z);
    }

    /// Workgroups that cover `size` invocations.
    pub fn groups_for(&self, size: [u32; 3]) -> [u32; 3] {
        std::array::from_fn(|axis| size[axis].div_ceil(self.workgroup[axis]))
    }
}

/// A render pipeline from the `vertex` and `fragment` entries of a shader: triangles without vertex
/// buffers, nearest first by the fragment's own depth.
pub struct RasterPipeline {
    /// The pipeline.
    pub pipeline: wgpu::RenderPipeline,
    /// Layout of bind group 3, the shader's own.
    pub own: wgpu::BindGroupLayout,
}

impl RasterPipeline {
    /// Shader `name` for color targets of these formats and a 32-bit depth buffer, with values for its `override`
    /// constants, compiled where it is not there yet.
    ///
    /// # Errors
    /// When it is not valid, with the compiler's words.
    pub fn variant(
        gpu: &Gpu,
        name: &str,
        targets: &[wgpu::TextureFormat],
        constants: &[(&str, f64)],
    ) -> Result<Arc<Self>, RenderError> {
        let key = format!("{name} {targets:?} {constants:?}");
        let compile = || Self::compile(gpu, name, targets, constants);
        gpu.compiled.get_or_make(key, compile)
    }

    fn compile(
        gpu: &Gpu,
        name: &str,
        targets: &[wgpu::TextureFormat],
        constants: &[(&str, f64)],
    ) -> Result<Self, RenderError> {
        let options = || wgpu::PipelineCompilationOptions {
            constants,
            ..Default::default()
        };
        checked(gpu, name, || {
            let compiled = compiled(gpu, name)?;
            let targets: Vec<_> = targets
                .iter()
                .map(|&format| {
                    Some(wgpu::ColorTargetState {
                        format,
                        blend: None,
                        write_mask: wgpu::ColorWrites::ALL,
                    })
                })
                .collect();
            let pipeline = gpu
                .device
                .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                    label: Some(name),
                    layout: Some(&compiled.layout),
                    vertex: wgpu::VertexState {
                        module: &compiled.module,
                        entry_point: Some("vertex"),
                        compilation_options: options(),
                        buffers: &[],
                    },
                    primitive: wgpu::PrimitiveState::default(),
                    depth_stencil: Some(wgpu::DepthStencilState {
                        format: wgpu::TextureFormat::Depth32Float,
                        depth_write_enabled: Some(true),
                        depth_compare: Some(wgpu::CompareFunction::Less),
                        stencil: wgpu::StencilState::default(),
                        bias: wgpu::DepthBiasState::default(),
                    }),
                    multisample: wgpu::MultisampleState::default(),
                    fragment: Some(wgpu::FragmentState {
                        module: &compiled.module,
                        entry_point: Some("fragment"),
                        compilation_options: options(),
                        targets: &targets,
                    }),
                    multiview_mask: None,
                    cache: None,
                });
            Ok(Self {
                pipeline,
                own: compiled.own.clone(),
            })
        })
    }
}

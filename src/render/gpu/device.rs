//! The adapter, the device and what it must be able to do.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use super::bind_groups::{Parameters, SharedLayouts};
use crate::render::{AdapterFacts, RenderError};

/// The first error of what was recorded or submitted, until someone asks.
#[derive(Debug, Default)]
pub(super) struct LateError(Mutex<Option<RenderError>>);

impl LateError {
    /// Keeps an error, unless there is one already.
    pub fn keep(&self, error: RenderError) {
        self.slot().get_or_insert(error);
    }

    fn take(&self) -> Option<RenderError> {
        self.slot().take()
    }

    fn slot(&self) -> MutexGuard<'_, Option<RenderError>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The variable that says how shaders read their parameters, `uniform` or `storage`, whatever suits the adapter:
/// so the way of GPUs can be tried on software.
pub const PARAMETERS: &str = "STRATARAY_PARAMETERS";

/// A device with its queue. Errors that the driver reports late are kept until [`Gpu::check`].
pub struct Gpu {
    /// The logical device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// What the driver says of the adapter.
    pub info: wgpu::AdapterInfo,
    /// Nanoseconds per timestamp tick, where the adapter has timestamps.
    pub timestamp_period_ns: Option<f32>,
    /// Layouts of the bind groups that all strategies share.
    pub layouts: SharedLayouts,
    pub(super) late_error: Arc<LateError>,
    /// Why the device is gone.
    lost: Arc<OnceLock<String>>,
}

impl Gpu {
    /// Opens the best adapter (discrete, integrated, virtual, software) that can be used, or the best one whose name
    /// contains `wanted`, whatever the letter case.
    ///
    /// # Errors
    /// When there is no (such) adapter, it lacks a limit, or [`PARAMETERS`] has an unknown value.
    pub fn new(wanted: Option<&str>) -> Result<Self, RenderError> {
        let adapter = best_adapter(wanted)?;
        let parameters = parameters_for(&adapter.get_info())?;
        Self::open(&adapter, parameters)
    }

    /// Opens the best adapter that is no program on the CPU; `None` where there is none that can be used.
    ///
    /// # Errors
    /// When the driver refuses, or [`PARAMETERS`] has an unknown value.
    pub fn hardware() -> Result<Option<Self>, RenderError> {
        let Some(best) = ranked().into_iter().next() else {
            return Ok(None);
        };
        let info = best.get_info();
        let parameters = parameters_for(&info)?;
        let is_usable = !is_software(&info) && lacking(&best, parameters).is_none();
        is_usable.then(|| Self::open(&best, parameters)).transpose()
    }

    /// As [`Gpu::new`], with parameters read in a given way.
    ///
    /// # Errors
    /// When there is no (such) adapter, or it lacks a limit.
    pub fn with_parameters(
        wanted: Option<&str>,
        parameters: Parameters,
    ) -> Result<Self, RenderError> {
        Self::open(&best_adapter(wanted)?, parameters)
    }

    fn open(adapter: &wgpu::Adapter, parameters: Parameters) -> Result<Self, RenderError> {
        let info = adapter.get_info();
        let unsuitable = |reason: String| RenderError::Unsuitable {
            adapter: info.name.clone(),
            reason,
        };
        let offered = adapter.limits();
        let needed = storage_buffers(parameters);
        if let Some(reason) = lacking(adapter, parameters) {
            return Err(unsuitable(reason));
        }
        let limits = wgpu::Limits {
            max_storage_buffers_per_shader_stage: needed,
            // Depth lists and values of large models are single arrays: take what there is.
            max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
            max_buffer_size: offered.max_buffer_size,
            // Pictures as large as the adapter can make.
            max_texture_dimension_2d: offered.max_texture_dimension_2d,
            // Resampled grids too.
            max_texture_dimension_3d: offered.max_texture_dimension_3d,
            ..wgpu::Limits::default()
        };
        let features = adapter.features() & wgpu::Features::TIMESTAMP_QUERY;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("strataray"),
            required_features: features,
            required_limits: limits,
            ..Default::default()
        }))
        .map_err(|e| unsuitable(e.to_string()))?;
        let late_error = Arc::new(LateError::default());
        let keep = late_error.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            let words = error.to_string();
            let words: Vec<&str> = words.split_whitespace().collect();
            keep.keep(RenderError::Device(words.join(" ")));
        }));
        let lost = Arc::new(OnceLock::new());
        let keep_lost = lost.clone();
        device.set_device_lost_callback(move |_, why| {
            let why = why.trim();
            let why = if why.is_empty() {
                String::new()
            } else {
                format!(" ({why})")
            };
            // The first reason is the one.
            let _ = keep_lost.set(why);
        });
        let timestamp_period_ns = (!features.is_empty()).then(|| queue.get_timestamp_period());
        Ok(Self {
            layouts: SharedLayouts::new(&device, parameters)?,
            device,
            queue,
            info,
            timestamp_period_ns,
            late_error,
            lost,
        })
    }

    /// True where the "GPU" is a program on the CPU.
    pub fn is_software(&self) -> bool {
        is_software(&self.info)
    }

    /// Name and kind of the adapter in one line.
    pub fn describe(&self) -> String {
        let software = if self.is_software() { ", software" } else { "" };
        format!("{} ({}{software})", self.info.name, self.info.backend)
    }

    /// Fails with the first error that the driver has reported since the last call.
    ///
    /// # Errors
    /// When there was one.
    pub fn check(&self) -> Result<(), RenderError> {
        if let Some(why) = self.lost.get() {
            return Err(RenderError::Lost(why.clone()));
        }
        self.late_error.take().map_or(Ok(()), Err)
    }

    /// Waits for all submitted work.
    ///
    /// # Errors
    /// When the device was lost or reported an error.
    pub fn wait(&self) -> Result<(), RenderError> {
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|e| RenderError::Device(e.to_string()))?;
        self.check()
    }

    /// A read-only storage buffer with `content`; never empty, as bindings may not be.
    ///
    /// # Errors
    /// When it exceeds what one binding holds.
    pub fn storage<T: bytemuck::NoUninit>(
        &self,
        what: &'static str,
        content: &[T],
    ) -> Result<wgpu::Buffer, RenderError> {
        let bytes: &[u8] = bytemuck::cast_slice(content);
        let needed = bytes.len() as u64;
        let limits = self.device.limits();
        let limit = limits
            .max_storage_buffer_binding_size
            .min(limits.max_buffer_size);
        if needed > limit {
            return Err(RenderError::TooLarge {
                what,
                needed,
                limit,
            });
        }
        let contents = if bytes.is_empty() { &[0; 16] } else { bytes };
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
        Ok(self.filled(what, contents, usage))
    }

    /// A buffer of parameters: what shaders declare as a uniform.
    pub fn uniform<T: bytemuck::NoUninit>(&self, label: &str, content: &T) -> wgpu::Buffer {
        let usage = wgpu::BufferUsages::UNIFORM
            | wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::COPY_DST;
        self.filled(label, bytemuck::bytes_of(content), usage)
    }

    /// A buffer with content. It goes through the queue: a buffer that is mapped when it is made panics
    /// where the device is lost.
    fn filled(&self, label: &str, content: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let whole = content
            .len()
            .next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT as usize);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: whole as u64,
            usage,
            mapped_at_creation: false,
        });
        if whole == content.len() {
            self.queue.write_buffer(&buffer, 0, content);
        } else {
            let mut padded = content.to_vec();
            padded.resize(whole, 0);
            self.queue.write_buffer(&buffer, 0, &padded);
        }
        buffer
    }

    /// A zeroed buffer that shaders write and the host can copy from.
    pub fn scratch(&self, label: &str, size: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_SRC
                | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    /// A sampler that interpolates within a level.
    pub fn linear_sampler(&self) -> wgpu::Sampler {
        self.device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Nearest,
            ..Default::default()
        })
    }

    /// A texture of two dimensions and one level.
    pub fn flat_texture(
        &self,
        label: &str,
        [width, height]: [u32; 2],
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    }

    /// A bind group from resources in binding order.
    pub fn bind(
        &self,
        layout: &wgpu::BindGroupLayout,
        resources: &[wgpu::BindingResource<'_>],
    ) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry {
                binding,
                resource: resource.clone(),
            })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout,
            entries: &entries,
        })
    }

    /// Copies the first `bytes` bytes of a buffer back.
    ///
    /// # Errors
    /// When the device was lost or reported an error.
    pub fn read(&self, source: &wgpu::Buffer, bytes: u64) -> Result<Vec<u8>, RenderError> {
        let staging = self.staging(bytes);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(source, 0, &staging, 0, bytes);
        self.queue.submit([encoder.finish()]);
        self.map(&staging)
    }

    /// A buffer that work can be copied to and the host can read.
    pub fn staging(&self, bytes: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("staging"),
            size: bytes,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    }

    /// Waits for the work and gives back what a staging buffer holds.
    ///
    /// # Errors
    /// When the device was lost or reported an error.
    pub fn map(&self, staging: &wgpu::Buffer) -> Result<Vec<u8>, RenderError> {
        staging.map_async(wgpu::MapMode::Read, .., |_| ());
        self.wait()?;
        let view = staging
            .get_mapped_range(..)
            .map_err(|e| RenderError::Device(e.to_string()))?;
        let content = view.to_vec();
        drop(view);
        staging.unmap();
        Ok(content)
    }
}

/// Storage buffers that a shader stage needs: eight arrays of the grid, two transfer tables, emitters and their
/// sections, counters, ray states, a strategy's own; where they are storage, parameters.
fn storage_buffers(parameters: Parameters) -> u32 {
    match parameters {
        Parameters::Uniform => 17,
        Parameters::Storage => 23,
    }
}

/// What an adapter lacks, and what to do; `None` where it has what is needed.
fn lacking(adapter: &wgpu::Adapter, parameters: Parameters) -> Option<String> {
    let offered = adapter.limits().max_storage_buffers_per_shader_stage;
    let needed = storage_buffers(parameters);
    (offered < needed).then(|| {
        format!(
            "it offers {offered} storage buffers per shader stage and {needed} are needed; install a Vulkan driver (on Debian the package mesa-vulkan-drivers)"
        )
    })
}

/// All adapters, the best one first.
pub fn adapters() -> Vec<AdapterFacts> {
    let facts = |adapter: &wgpu::Adapter| {
        let (info, limits) = (adapter.get_info(), adapter.limits());
        let parameters = parameters_for(&info);
        let buffer = limits.max_buffer_size;
        AdapterFacts {
            kind: match info.device_type {
                wgpu::DeviceType::DiscreteGpu => "discrete GPU",
                wgpu::DeviceType::IntegratedGpu => "integrated GPU",
                wgpu::DeviceType::VirtualGpu => "virtual GPU",
                wgpu::DeviceType::Cpu => "software",
                wgpu::DeviceType::Other => "other",
            },
            backend: info.backend.to_str(),
            driver: format!("{} {}", info.driver, info.driver_info)
                .trim()
                .to_owned(),
            most_bytes: limits.max_storage_buffer_binding_size.min(buffer),
            most_texels: [
                limits.max_texture_dimension_2d,
                limits.max_texture_dimension_3d,
            ],
            lacking: match parameters {
                Ok(parameters) => lacking(adapter, parameters),
                Err(error) => Some(error.to_string()),
            },
            name: info.name,
        }
    };
    ranked().iter().map(facts).collect()
}

/// All adapters: those that can be used first, and the best ones of these.
fn ranked() -> Vec<wgpu::Adapter> {
    let instance =
        wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    adapters.sort_by_cached_key(|adapter| {
        let info = adapter.get_info();
        let is_lacking = parameters_for(&info).is_ok_and(|p| lacking(adapter, p).is_some());
        (is_lacking, rank(info.device_type))
    });
    adapters
}

/// The adapter that [`Gpu::new`] opens.
fn best_adapter(wanted: Option<&str>) -> Result<wgpu::Adapter, RenderError> {
    let mut adapters = ranked();
    let names: Vec<String> = adapters.iter().map(|a| a.get_info().name).collect();
    let matches =
        |name: &str| wanted.is_none_or(|w| name.to_lowercase().contains(&w.to_lowercase()));
    match (names.iter().position(|n| matches(n)), wanted) {
        (Some(at), _) => Ok(adapters.swap_remove(at)),
        (None, Some(wanted)) if !names.is_empty() => Err(RenderError::NoSuchAdapter {
            wanted: wanted.to_owned(),
            known: names.join(", "),
        }),
        _ => Err(RenderError::NoAdapter),
    }
}

/// How shaders read their parameters: as [`PARAMETERS`] says, or as suits the adapter.
fn parameters_for(info: &wgpu::AdapterInfo) -> Result<Parameters, RenderError> {
    let Some(name) = std::env::var_os(PARAMETERS) else {
        return Ok(match is_software(info) {
            true => Parameters::Storage,
            false => Parameters::Uniform,
        });
    };
    let name = name.to_string_lossy();
    Parameters::named(&name).ok_or_else(|| RenderError::Unsuitable {
        adapter: info.name.clone(),
        reason: format!("{PARAMETERS} is {name}, but can only be uniform or storage"),
    })
}

fn is_software(info: &wgpu::AdapterInfo) -> bool {
    info.device_type == wgpu::DeviceType::Cpu
}

fn rank(kind: wgpu::DeviceType) -> u8 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Cpu => 3,
        wgpu::DeviceType::Other => 4,
    }
}

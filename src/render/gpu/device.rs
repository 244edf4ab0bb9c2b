//! The adapter, the device and what it must be able to do.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use super::bind_groups::{Parameters, SharedLayouts};
use super::kept::Kept;
use crate::render::plan::layout::LUT_ROW;
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
    pub(super) compiled: Kept,
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
        let limits = generous(&adapter);
        let parameters = parameters_for(&adapter.get_info(), &limits)?;
        Self::open(&adapter, parameters, &limits)
    }

    /// As [`Gpu::new`], with a device that grants no more than these limits.
    ///
    /// # Errors
    /// When there is no (such) adapter, it does not offer the limits, they are too low, or [`PARAMETERS`] has an
    /// unknown value.
    pub fn with_limits(wanted: Option<&str>, limits: &wgpu::Limits) -> Result<Self, RenderError> {
        let adapter = best_adapter(wanted)?;
        let parameters = parameters_for(&adapter.get_info(), limits)?;
        Self::open(&adapter, parameters, limits)
    }

    /// Opens the best adapter that is no program on the CPU; `None` where there is none that can be used.
    ///
    /// # Errors
    /// When the driver refuses, or [`PARAMETERS`] has an unknown value.
    pub fn hardware() -> Result<Option<Self>, RenderError> {
        let Some(best) = ranked().into_iter().next() else {
            return Ok(None);
        };
        let (info, limits) = (best.get_info(), generous(&best));
        let parameters = parameters_for(&info, &limits)?;
        let is_usable = !is_software(&info) && lacking(&limits, parameters).is_none();
        let open = || Self::open(&best, parameters, &limits);
        is_usable.then(open).transpose()
    }

    /// As [`Gpu::new`], with parameters read in a given way.
    ///
    /// # Errors
    /// When there is no (such) adapter, or it lacks a limit.
    pub fn with_parameters(
        wanted: Option<&str>,
        parameters: Parameters,
    ) -> Result<Self, RenderError> {
        let adapter = best_adapter(wanted)?;
        let limits = generous(&adapter);
        Self::open(&adapter, parameters, &limits)
    }

    fn open(
        adapter: &wgpu::Adapter,
        parameters: Parameters,
        limits: &wgpu::Limits,
    ) -> Result<Self, RenderError> {
        let info = adapter.get_info();
        let unsuitable = |reason: String| RenderError::Unsuitable {
            adapter: info.name.clone(),
            reason,
        };
        if let Some(reason) = lacking(limits, parameters) {
            return Err(unsuitable(reason));
        }
        let features = adapter.features() & wgpu::Features::TIMESTAMP_QUERY;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("strataray"),
            required_features: features,
            required_limits: wgpu::Limits {
                max_storage_buffers_per_shader_stage: parameters.storage_buffers(),
                ..limits.clone()
            },
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
            compiled: Kept::default(),
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

    /// Bytes that one storage buffer can have.
    pub fn most_bytes(&self) -> u64 {
        let limits = self.device.limits();
        limits
            .max_storage_buffer_binding_size
            .min(limits.max_buffer_size)
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
        let limit = self.most_bytes();
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

    /// A table as a texture of a format of 16 bytes a texel, in rows of [`LUT_ROW`].
    ///
    /// # Errors
    /// When it has more rows than a texture can have.
    pub fn table<T: bytemuck::Pod>(
        &self,
        what: &'static str,
        format: wgpu::TextureFormat,
        texels: &[[T; 4]],
    ) -> Result<wgpu::TextureView, RenderError> {
        const { assert!(size_of::<T>() == 4) };
        let rows = texels.len().div_ceil(LUT_ROW as usize).max(1) as u32;
        let limit = self.device.limits().max_texture_dimension_2d;
        if rows > limit {
            return Err(RenderError::TooLarge {
                what,
                needed: 16 * texels.len() as u64,
                limit: 16 * u64::from(LUT_ROW) * u64::from(limit),
            });
        }
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
        let texture = self.flat_texture(what, [LUT_ROW, rows], format, usage);
        let mut padded = texels.to_vec();
        padded.resize((LUT_ROW * rows) as usize, bytemuck::Zeroable::zeroed());
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(16 * LUT_ROW),
            rows_per_image: None,
        };
        let bytes = bytemuck::cast_slice(&padded);
        self.queue
            .write_texture(texture.as_image_copy(), bytes, layout, texture.size());
        Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
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

/// What a device can grant: WebGPU's default limits, and more where size matters or parameters are storage.
fn generous(adapter: &wgpu::Adapter) -> wgpu::Limits {
    let offered = adapter.limits();
    wgpu::Limits {
        max_storage_buffers_per_shader_stage: offered.max_storage_buffers_per_shader_stage,
        // Depth lists and values of large models are single arrays: take what there is.
        max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
        max_buffer_size: offered.max_buffer_size,
        // Pictures as large as the adapter can make.
        max_texture_dimension_2d: offered.max_texture_dimension_2d,
        // Resampled grids too.
        max_texture_dimension_3d: offered.max_texture_dimension_3d,
        ..wgpu::Limits::default()
    }
}

/// What limits lack, and what to do; `None` where they are enough.
fn lacking(limits: &wgpu::Limits, parameters: Parameters) -> Option<String> {
    let offered = limits.max_storage_buffers_per_shader_stage;
    let needed = parameters.storage_buffers();
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
        let parameters = parameters_for(&info, &limits);
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
                Ok(parameters) => lacking(&limits, parameters),
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
        let (info, limits) = (adapter.get_info(), adapter.limits());
        let is_lacking =
            parameters_for(&info, &limits).is_ok_and(|p| lacking(&limits, p).is_some());
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
fn parameters_for(
    info: &wgpu::AdapterInfo,
    limits: &wgpu::Limits,
) -> Result<Parameters, RenderError> {
    let Some(name) = std::env::var_os(PARAMETERS) else {
        let can_store = lacking(limits, Parameters::Storage).is_none();
        return Ok(match is_software(info) && can_store {
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

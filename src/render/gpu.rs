//! The graphics device: chooses the adapter, and keeps the faults since then.

use std::sync::{Arc, Mutex, PoisonError};

use super::driver_messages;
use super::error::GpuError;
use super::quality::SAMPLES;
use super::target::DEPTH_FORMAT;

/// If this environment variable is `software`, a software adapter is taken before any hardware.
pub const ADAPTER_VARIABLE: &str = "GELATIN_ADAPTER";

/// Which kind of adapter is tried first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preference {
    /// The fastest; software only if there is nothing else.
    Hardware,
    /// Software, so that pictures do not depend on the machine's hardware.
    Software,
}

impl Preference {
    /// The environment's preference, see [`ADAPTER_VARIABLE`]; hardware by default.
    pub fn from_environment() -> Self {
        match std::env::var(ADAPTER_VARIABLE) {
            Ok(value) if value.eq_ignore_ascii_case("software") => Self::Software,
            _ => Self::Hardware,
        }
    }
}

/// An open graphics device.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// Source of adapters and surfaces.
    pub instance: wgpu::Instance,
    /// The adapter in use.
    pub adapter: wgpu::Adapter,
    /// Makes buffers, textures and pipelines.
    pub device: wgpu::Device,
    /// Takes commands.
    pub queue: wgpu::Queue,
    fault: Arc<Mutex<Option<GpuError>>>,
}

impl Gpu {
    /// Makes an instance, the source of adapters and surfaces. OpenGL is left out: its shading language cannot read a depth
    /// texture by texel, as our shadows do.
    pub fn instance(descriptor: wgpu::InstanceDescriptor) -> wgpu::Instance {
        wgpu::Instance::new(wgpu::InstanceDescriptor { backends: wgpu::Backends::PRIMARY, ..descriptor })
    }

    /// A device for pictures without a window.
    pub fn headless() -> Result<Self, GpuError> {
        Self::headless_with(Preference::from_environment())
    }

    /// Opens a device for pictures without a window, with the given preference of adapters.
    pub fn headless_with(preference: Preference) -> Result<Self, GpuError> {
        Self::open(Self::instance(wgpu::InstanceDescriptor::new_without_display_handle()), None, preference)
    }

    /// Opens the best device of an instance, able to show `surface` if one is given.
    pub fn open(
        instance: wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
        preference: Preference,
    ) -> Result<Self, GpuError> {
        let adapter = driver_messages::with_filtered_messages(|| {
            pollster::block_on(choose_adapter(&instance, surface, preference))
        })?;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("gelatin"),
            required_limits: limits(&adapter.limits()),
            ..Default::default()
        }))
        .map_err(|error| GpuError::NoDevice { adapter: adapter.get_info().name, reason: error.to_string() })?;
        let fault = Arc::new(Mutex::new(None));
        record_faults(&device, &fault);
        Ok(Self { instance, adapter, device, queue, fault })
    }

    /// The adapter's name, kind and interface: "llvmpipe (LLVM 15), Cpu, Vulkan".
    pub fn description(&self) -> String {
        describe(&self.adapter)
    }

    /// Whether a processor does the drawing: antialiasing is expensive then.
    pub fn is_software(&self) -> bool {
        self.adapter.get_info().device_type == wgpu::DeviceType::Cpu
    }

    /// Reports a fault since the device was opened. A lost device stays lost; a refused command is reported once.
    pub fn check(&self) -> Result<(), GpuError> {
        let mut fault = self.fault.lock().unwrap_or_else(PoisonError::into_inner);
        match fault.clone() {
            None => Ok(()),
            Some(lost @ GpuError::Lost { .. }) => Err(lost),
            Some(refused) => {
                *fault = None;
                Err(refused)
            }
        }
    }
}

/// Keeps the first fault. Without a handler, wgpu would panic on errors.
fn record_faults(device: &wgpu::Device, fault: &Arc<Mutex<Option<GpuError>>>) {
    let keep = |fault: &Mutex<Option<GpuError>>, error: GpuError| {
        log::error!("{error}");
        let mut slot = fault.lock().unwrap_or_else(PoisonError::into_inner);
        if !matches!(*slot, Some(GpuError::Lost { .. })) {
            *slot = Some(error);
        }
    };
    let refused = Arc::clone(fault);
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        let reason = error.to_string();
        let error = match error {
            wgpu::Error::OutOfMemory { .. } => GpuError::Lost { reason },
            wgpu::Error::Validation { .. } | wgpu::Error::Internal { .. } => GpuError::Refused { reason },
        };
        keep(&refused, error);
    }));
    let lost = Arc::clone(fault);
    device.set_device_lost_callback(move |reason, message| {
        keep(&lost, GpuError::Lost { reason: format!("{reason:?} {message}").trim().to_owned() });
    });
}

async fn choose_adapter(
    instance: &wgpu::Instance,
    surface: Option<&wgpu::Surface<'_>>,
    preference: Preference,
) -> Result<wgpu::Adapter, GpuError> {
    let found = instance.enumerate_adapters(wgpu::Backends::PRIMARY).await;
    if found.is_empty() {
        return Err(GpuError::NoAdapter);
    }
    let names = found.iter().map(describe).collect::<Vec<_>>().join("; ");
    found
        .into_iter()
        .filter(|adapter| suitable(adapter, surface))
        .min_by_key(|adapter| rank(&adapter.get_info(), preference))
        .ok_or(GpuError::Unsuitable { found: names, surface: if surface.is_some() { ", and this window" } else { "" } })
}

fn suitable(adapter: &wgpu::Adapter, surface: Option<&wgpu::Surface<'_>>) -> bool {
    let computes = adapter.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS);
    let antialiases = [wgpu::TextureFormat::Rgba8UnormSrgb, DEPTH_FORMAT]
        .iter()
        .all(|&format| adapter.get_texture_format_features(format).flags.sample_count_supported(SAMPLES));
    let enough = limits(&adapter.limits()).check_limits(&adapter.limits());
    computes && antialiases && enough && surface.is_none_or(|surface| adapter.is_surface_supported(surface))
}

/// Ranks an adapter; lower is better.
fn rank(info: &wgpu::AdapterInfo, preference: Preference) -> u8 {
    let software = info.device_type == wgpu::DeviceType::Cpu;
    match (info.device_type, preference) {
        (_, Preference::Software) => u8::from(!software),
        (wgpu::DeviceType::DiscreteGpu, _) => 0,
        (wgpu::DeviceType::IntegratedGpu, _) => 1,
        (wgpu::DeviceType::VirtualGpu, _) => 2,
        (wgpu::DeviceType::Other, _) => 3,
        (wgpu::DeviceType::Cpu, _) => 4,
    }
}

/// The limits asked of a device: low ones, but pictures and buffers as large as it offers.
fn limits(offered: &wgpu::Limits) -> wgpu::Limits {
    wgpu::Limits {
        max_texture_dimension_1d: offered.max_texture_dimension_1d,
        max_texture_dimension_2d: offered.max_texture_dimension_2d,
        max_buffer_size: offered.max_buffer_size,
        max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
        ..wgpu::Limits::downlevel_defaults()
    }
}

fn describe(adapter: &wgpu::Adapter) -> String {
    let info = adapter.get_info();
    format!("{}, {:?}, {:?}", info.name, info.device_type, info.backend)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_adapter_says_what_to_install() {
        let sentence = GpuError::NoAdapter.to_string();
        assert!(sentence.contains("install") && sentence.contains("mesa-vulkan-drivers"), "{sentence}");
    }
}
